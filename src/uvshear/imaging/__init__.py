"""From visibilities to images and back: pixels, tiles of the sky, cutouts of images as facets, and the gridder."""

from uvshear.imaging.dirty_image import dirty_image
from uvshear.imaging.grid import ImageGrid

__all__ = ["ImageGrid", "dirty_image"]
