"""From galaxies to visibilities.

``direct`` is the exact sum over sources, against which everything faster is tested. ``rendering`` draws galaxies as
pixels, and ``response`` says how samples see sources of different spectra and directions. ``losses`` are what averaging
and primary beams take away.
"""

from uvshear.predict.direct import predict_visibilities

__all__ = ["predict_visibilities"]
