"""Physical constants, units and conventions, in SI and radians."""

import math
from typing import Final

SPEED_OF_LIGHT: Final = 299_792_458.0
"""[m/s], exact."""

ARCSEC: Final = math.pi / 180 / 3600
"""One arcsecond [rad]."""

ARCMIN: Final = 60 * ARCSEC
"""One arcminute [rad]."""

MICROJANSKY: Final = 1e-6
"""[Jy]."""

REFERENCE_FREQUENCY: Final = 1.4e9
"""Frequency to which catalogue fluxes refer unless they say otherwise [Hz]."""

SPECTRAL_INDEX: Final = -0.7
"""Synchrotron spectral index assumed unless the catalogue says otherwise (Rivi & Miller 2018, eq. 1)."""

RADIO_FREQUENCIES = (1e5, 1e14)
"""Lowest and highest frequency that is believed [Hz]; radio telescopes observe from 1e7 to 2e12 Hz."""
