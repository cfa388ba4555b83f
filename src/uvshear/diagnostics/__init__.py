"""Diagnostics of observations and measurements: PSF, weighting loss, residual image, natural SNR, slopes of shapes."""
