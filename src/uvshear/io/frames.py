"""Equatorial frames in which a catalogue may state its positions, and their precession to ICRS."""

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from astropy import units
from astropy.coordinates import FK4, FK5, ICRS, FK4NoETerms, SkyCoord

from uvshear.errors import InputError
from uvshear.typing import Array, Float

SYSTEM_KEYS = ("radesys", "radecsys", "coordsys")
EQUINOX_KEY = "equinox"
"""Keys of a table's metadata, in lower case. RADESYS and EQUINOX are those of FITS, RADECSYS is its older form."""

_BESSELIAN_BEFORE: Final = 1984.0
"""Equinoxes before this are Besselian, of FK4, where no system is stated (FITS standard 4.0, section 8.3)."""

_YEARS: Final = (1800.0, 2100.0)

_FRAMES: Final = {
    "FK5": FK5,
    "FK4": FK4,
    "FK4-NO-E": FK4NoETerms,
    "FK4_NO_E": FK4NoETerms,
}


@dataclass(frozen=True)
class EquatorialFrame:
    """A system with its equinox, such as FK4 and B1950.

    Parameters
    ----------
    system
        ``ICRS``, ``FK5``, ``FK4`` or ``FK4-NO-E``.
    equinox
        Equinox in years, Besselian for FK4 and Julian for FK5; it has no meaning for ICRS.
    """

    system: str = "ICRS"
    equinox: float = 2000.0

    @property
    def is_icrs(self) -> bool:
        """Whether positions are taken as they are; FK5 at J2000 agrees with ICRS to 0.03 arcsec."""
        return self.system == "ICRS" or (self.system == "FK5" and self.equinox == 2000.0)

    @property
    def name(self) -> str:
        """The system and its equinox."""
        letter = "J" if self.system == "FK5" else "B"
        return "ICRS" if self.system == "ICRS" else f"{self.system} {letter}{self.equinox:g}"

    def to_icrs(
        self, ra: Float[Array, " source"], dec: Float[Array, " source"]
    ) -> tuple[Float[Array, " source"], Float[Array, " source"]]:
        """Precess positions [rad] to ICRS."""
        if self.is_icrs:
            return ra, dec
        letter = "J" if self.system == "FK5" else "B"
        frame = _FRAMES[self.system](equinox=f"{letter}{self.equinox}")
        there = SkyCoord(ra * units.rad, dec * units.rad, frame=frame).transform_to(ICRS())
        return np.asarray(there.ra.rad), np.asarray(there.dec.rad)

    @classmethod
    def stated(cls, system: object, equinox: object) -> "EquatorialFrame":
        """Return the frame of a system and an equinox, as files state them or leave them out.

        Raises
        ------
        InputError
            It is no equatorial frame, or no equinox; the message is the reason.
        """
        name = re.sub(r"^EQ_", "", _text(system).upper())
        letter, year = _year(equinox)
        if match := re.fullmatch(r"([JB])(\d{4}(?:\.\d*)?)", name):
            # CASA calls frames by their equinox.
            name, letter, year = "", match[1], float(match[2])
        if not name:
            if math.isnan(year):
                return cls()
            is_besselian = letter == "B" or (not letter and year < _BESSELIAN_BEFORE)
            return cls("FK4" if is_besselian else "FK5", year)
        if name == "ICRS":
            return cls()
        if name not in _FRAMES:
            raise InputError(
                f"its positions are in the system '{_text(system)}'; ICRS, FK5 or FK4 is needed"
            )
        usual = 2000.0 if name == "FK5" else 1950.0
        return cls(name, usual if math.isnan(year) else year)


def frame_of_metadata(metadata: Mapping[str, Any]) -> EquatorialFrame:
    """Return the frame that the metadata of a table state, by keys in lower case; ICRS if none."""
    system = next((metadata[key] for key in SYSTEM_KEYS if key in metadata), None)
    return EquatorialFrame.stated(system, metadata.get(EQUINOX_KEY))


def _text(value: object) -> str:
    # FITS cards without a value have an object of their own.
    text = str(value).strip() if isinstance(value, str | int | float | np.number) else ""
    return "" if text.lower() in {"none", "nan", "unknown"} else text


def _year(equinox: object) -> tuple[str, float]:
    """Letter and year of an equinox such as 2000.0, 'J2000' or 'B1950'; NaN if there is none."""
    text = _text(equinox)
    if not text:
        return "", math.nan
    match = re.fullmatch(r"([JB]?)\s*(\d+(?:\.\d*)?)", text, re.IGNORECASE)
    year = float(match[2]) if match else math.nan
    if match is None or not _YEARS[0] <= year <= _YEARS[1]:
        raise InputError(f"its equinox is '{text}'; a year such as J2000 or B1950 is needed")
    return match[1].upper(), year
