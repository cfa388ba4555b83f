"""What tells how good an observation and a measurement are: PSF, cost of a weighting, residual image, slopes."""
