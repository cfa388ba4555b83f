"""Galaxies to visibilities: the direct sum, the oracle of everything faster."""

from uvshear.predict.direct import predict_visibilities

__all__ = ["predict_visibilities"]
