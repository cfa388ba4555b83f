"""A primary beam of one's own: a Gaussian."""

import numpy as np

from uvshear.interferometer.primary_beam import PrimaryBeam

SPEED_OF_LIGHT = 299792458.0


class GaussianBeam(PrimaryBeam):
    """Gaussian power beam."""

    def voltage(self, x):
        """Voltage beam at a distance from the axis, in full widths at half maximum of the power beam."""
        return np.exp(-2 * np.log(2) * x**2)


def gaussian(diameters, pointing):
    """Return the beam of dishes of these diameters [m], 70 degrees times wavelength over diameter wide."""
    return GaussianBeam(np.radians(70) * SPEED_OF_LIGHT / diameters, pointing)
