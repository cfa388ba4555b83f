"""Between visibilities and images: pixels, tiles, and the gridder with its signs."""

from uvshear.imaging.grid import ImageGrid
from uvshear.imaging.gridder import dirty_image

__all__ = ["ImageGrid", "dirty_image"]
