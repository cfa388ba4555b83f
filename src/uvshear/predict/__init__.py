"""From galaxies to visibilities.

``direct`` is the exact sum over sources, against which everything faster is tested. ``by_grid`` computes the same from
images (``tile_images``) of those galaxies for which this is exact enough (``drawable``), and ``within_error`` takes
what is fastest. ``rendering`` draws galaxies on pixels, and ``response`` describes the dependence of the samples on the
spectra and directions of sources. ``losses`` has the attenuation by averaging and primary beams.
"""

from uvshear.predict.direct import predict_visibilities

__all__ = ["predict_visibilities"]
