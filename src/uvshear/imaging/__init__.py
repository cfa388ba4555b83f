"""From visibilities to images and back: pixels, tiles of the sky, facets that are cut out of images, and the
gridder."""

from uvshear.imaging.dirty_image import dirty_image
from uvshear.imaging.grid import ImageGrid

__all__ = ["ImageGrid", "dirty_image"]
