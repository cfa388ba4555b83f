"""Weak-lensing galaxy shapes and shear, measured directly from interferometric visibilities."""

__version__ = "0.1.0"
