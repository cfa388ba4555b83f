"""Catalogues of sources: any table astropy reads, checked, in SI and radians."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Final, Self

import numpy as np
from astropy import units
from astropy.table import Column, Table

from uvshear.constants import (
    ARCSEC,
    MICROJANSKY,
    RADIO_FREQUENCIES,
    REFERENCE_FREQUENCY,
    SPECTRAL_INDEX,
)
from uvshear.errors import InputError
from uvshear.galaxy.galaxies import Galaxies
from uvshear.galaxy.registry import PROFILES
from uvshear.geometry.directions import PhaseCentre, direction_cosines, equatorial
from uvshear.io.columns import Columns
from uvshear.io.source_finders import in_our_columns
from uvshear.io.tables import read_table, write_table
from uvshear.typing import Array, Bool, Complex, Float, Shaped

REFERENCE_FREQUENCY_KEYS = ("reference_frequency", "reffreq", "freq0")
"""Keys of the metadata that state the frequency of the fluxes; the last is PyBDSF's."""

POINT = "point"
GALAXY = "galaxy"
"""Words of the column ``profile``. An empty cell or the name of any known profile stands for a galaxy as well; the
profile of the model is an option of the measurement."""

BRIGHTEST: Final = 1e10
"""Flux density that no source has [Jy]; the Sun reaches a hundredth of it in its strongest bursts."""

STEEPEST: Final = 100.0
"""Largest spectral index, of either sign, that can be computed with; fits to few channels give wild values."""

LARGEST: Final = 1.0
"""Scale length that no source has [rad]."""


@dataclass(frozen=True)
class Catalogue:
    """Sources to simulate or to measure, with one element for each; positions are (ra, dec) or (l, m).

    Parameters
    ----------
    identifier
        Unique names or numbers.
    flux
        Flux density at ``reference_frequency`` [Jy], positive.
    spectral_index
        beta in S proportional to frequency^beta.
    ra, dec
        ICRS [rad]; None where the catalogue gives (l, m).
    l, m
        Direction cosines from the phase centre; None where the catalogue gives (ra, dec).
    scale_length
        Scale length alpha of the profile [rad]; None where the catalogue has none.
    ellipticity
        e1 + i e2 in the (l, m) frame, in simulated catalogues; never used in a measurement.
    shear
        Reduced shear g1 + i g2 of each source for simulations, in the frame of local North (TreeCorr's convention for
        RA and Dec); None where the catalogue has none. It is not part of ``ellipticity``.
    flux_err
        Standard deviation of the flux [Jy], 0 where it is not known; None where the catalogue has none.
    position_err
        Standard deviation of the position along each axis [rad], 0 where it is not known; None where the catalogue has
        none.
    is_point
        Whether the source is an unresolved star or active nucleus; None where the catalogue has no column ``profile``.
    reference_frequency
        Frequency of the fluxes [Hz].
    field_centre
        Direction of l = m = 0 of a simulated catalogue, where it was given.
    """

    identifier: Shaped[Array, " source"]
    flux: Float[Array, " source"]
    spectral_index: Float[Array, " source"]
    ra: Float[Array, " source"] | None = None
    dec: Float[Array, " source"] | None = None
    l: Float[Array, " source"] | None = None
    m: Float[Array, " source"] | None = None
    scale_length: Float[Array, " source"] | None = None
    ellipticity: Complex[Array, " source"] | None = None
    shear: Complex[Array, " source"] | None = None
    flux_err: Float[Array, " source"] | None = None
    position_err: Float[Array, " source"] | None = None
    is_point: Bool[Array, " source"] | None = None
    reference_frequency: float = REFERENCE_FREQUENCY
    field_centre: PhaseCentre | None = None

    def __len__(self) -> int:
        return len(self.flux)

    def select(self, index: Array | slice) -> Self:
        """Return the sources at ``index`` (any one-dimensional numpy index)."""
        chosen: dict[str, Any] = {
            name: None if (values := getattr(self, name)) is None else values[index]
            for name in self.__dataclass_fields__
            if name not in {"reference_frequency", "field_centre"}
        }
        return replace(self, **chosen)

    def directions(
        self, phase_centre: PhaseCentre
    ) -> tuple[Float[Array, " source"], Float[Array, " source"], Float[Array, " source"]]:
        """Direction cosines l, m, n of the sources about ``phase_centre``; n <= 0 is behind it."""
        if self.ra is not None and self.dec is not None:
            return direction_cosines(phase_centre, self.ra, self.dec)
        if self.l is None or self.m is None:
            raise InputError(
                "the catalogue has neither (ra, dec) nor (l, m); one of these pairs is needed"
            )
        return self.l, self.m, np.sqrt(1 - self.l**2 - self.m**2)

    def galaxies(self, phase_centre: PhaseCentre) -> Galaxies:
        """Return the galaxies before any shear; without sizes they are points, without ellipticities round."""
        l, m, n = self.directions(phase_centre)
        if np.any(n <= 0):
            worst = self.identifier[int(np.argmin(n))]
            raise InputError(
                f"source id {worst} is 90 degrees or more from the phase centre; "
                "give a catalogue of the field that is observed"
            )
        none = np.zeros(len(self))
        size = none if self.scale_length is None else self.scale_length
        return Galaxies(
            l=l,
            m=m,
            flux=self.flux,
            scale_length=size if self.is_point is None else np.where(self.is_point, 0.0, size),
            ellipticity=none.astype(complex) if self.ellipticity is None else self.ellipticity,
            spectral_index=self.spectral_index,
            reference_frequency=self.reference_frequency,
        )


def read_catalogue(
    path: Path | str,
    *,
    flux_unit: str | None = None,
    reference_frequency: float | None = None,
) -> Catalogue:
    """Read a catalogue in ECSV, FITS, VOTable, CSV and similar formats, or a source list of PyBDSF or Aegean as it is.

    Parameters
    ----------
    flux_unit
        Unit of a flux column that has none (CSV), as astropy spells it.
    reference_frequency
        Frequency of the fluxes [Hz], in place of the one that the file states.
    """
    table = read_table(Path(path), "catalogue")
    return catalogue_from_table(
        table, str(path), flux_unit=flux_unit, reference_frequency=reference_frequency
    )


def catalogue_from_table(
    table: Table,
    name: str = "catalogue",
    *,
    flux_unit: str | None = None,
    reference_frequency: float | None = None,
) -> Catalogue:
    """Check a table and turn it into a catalogue; error messages call the table by ``name``."""
    if len(table) == 0:
        raise InputError(f"{name}: has no rows; a catalogue of at least one source is needed")
    columns = Columns(in_our_columns(table), name)
    flux = columns.number("flux", units.Jy, given=flux_unit, needs_unit=True)
    columns.require("flux", flux > 0, "a positive flux density (here in Jy) is needed", flux)
    columns.require("flux", flux < BRIGHTEST, f"less than {BRIGHTEST:g} Jy is needed", flux)

    position = _positions(columns)

    index = np.full(len(table), SPECTRAL_INDEX)
    if columns.has("spectral_index"):
        index = columns.number("spectral_index", units.dimensionless_unscaled)
        needed = f"-{STEEPEST:g} to {STEEPEST:g} is needed"
        columns.require("spectral_index", np.abs(index) <= STEEPEST, needed, index)

    scale_length = None
    if columns.has("scale_length"):
        scale_length = columns.number("scale_length", units.rad, assumed=units.arcsec)
        columns.require("scale_length", scale_length >= 0, "a size >= 0 is needed", scale_length)
        fits = scale_length < LARGEST
        columns.require("scale_length", fits, "a size below 1 rad is needed", scale_length)

    flux_err = None
    if columns.has("flux_err"):
        flux_err = columns.error("flux_err", units.Jy, assumed=columns.unit_of("flux", flux_unit))
    frequency = _frequencies(columns, reference_frequency)
    common = float(frequency[0])
    return Catalogue(
        identifier=columns.identifier,
        flux=flux * (common / frequency) ** index,
        flux_err=None if flux_err is None else flux_err * (common / frequency) ** index,
        position_err=_position_errors(columns),
        spectral_index=index,
        scale_length=scale_length,
        ellipticity=_spin_2(columns, "e1", "e2", "|e| = (a-b)/(a+b) below 1 is needed"),
        shear=_spin_2(columns, "shear1", "shear2", "a reduced shear below 1 is needed"),
        is_point=_points(columns),
        reference_frequency=common,
        field_centre=_field_centre(columns),
        **position,
    )


def _positions(columns: Columns) -> dict[str, Float[Array, " source"]]:
    """Read (ra, dec) where the table has them, else (l, m)."""
    for pair in (("ra", "dec"), ("l", "m")):
        there = [columns.has(name) for name in pair]
        if any(there) and not all(there):
            absent = pair[there.index(False)]
            raise InputError(
                f"{columns.name}: has no column '{absent}' to go with '{pair[there.index(True)]}'"
            )
    if columns.has("ra"):
        ra = columns.number("ra", units.rad, assumed=units.deg)
        dec = columns.number("dec", units.rad, assumed=units.deg)
        columns.require(
            "dec", np.abs(dec) <= math.pi / 2, "-90 to 90 degrees is needed", np.degrees(dec)
        )
        return {"ra": ra, "dec": dec}
    if columns.has("l"):
        l = columns.number("l", units.rad, assumed=units.rad)
        m = columns.number("m", units.rad, assumed=units.rad)
        radius = np.hypot(l, m)
        columns.require("l, m", radius < 1, "l^2 + m^2 < 1 is needed (radians)", radius)
        return {"l": l, "m": m}
    raise InputError(
        f"{columns.name}: has no positions; columns 'ra' and 'dec' (deg), or 'l' and 'm' (rad),"
        f" are needed (it has {', '.join(columns.names)})"
    )


def _spin_2(
    columns: Columns, first: str, second: str, needed: str
) -> Complex[Array, " source"] | None:
    """Return both components as a complex number below 1 in modulus, if the table has them."""
    if not (columns.has(first) or columns.has(second)):
        return None
    if not (columns.has(first) and columns.has(second)):
        absent = first if columns.has(second) else second
        raise InputError(
            f"{columns.name}: has no column '{absent}'; give both {first} and {second}, or neither"
        )
    real, imaginary = (
        columns.number(name, units.dimensionless_unscaled) for name in (first, second)
    )
    value = real + 1j * imaginary
    columns.require(f"{first}, {second}", np.abs(value) < 1, needed, value)
    return value


def _position_errors(columns: Columns) -> Float[Array, " source"] | None:
    """Root of the mean of both axes' variances, if both have errors."""
    if not (columns.has("ra_err") and columns.has("dec_err")):
        return None
    ra, dec = (columns.error(name, units.rad, assumed=units.deg) for name in ("ra_err", "dec_err"))
    return np.sqrt((ra**2 + dec**2) / 2)


def _points(columns: Columns) -> Bool[Array, " source"] | None:
    """Tell which sources the column ``profile`` calls points; all others are galaxies."""
    if not columns.has("profile"):
        return None
    words = columns.words("profile")
    galaxies = (GALAXY, *PROFILES.names())
    known = np.isin(words, [POINT, "", *galaxies])
    if not known.all():
        raise InputError(
            f"{columns.name}: column 'profile' has '{words[~known][0]}';"
            f" '{POINT}' or one of {', '.join(repr(word) for word in galaxies)} is needed"
        )
    return words == POINT


def _field_centre(columns: Columns) -> PhaseCentre | None:
    metadata = columns.metadata
    try:
        return PhaseCentre(math.radians(metadata["ra0_deg"]), math.radians(metadata["dec0_deg"]))
    except (KeyError, TypeError):
        return None


def _frequencies(columns: Columns, option: float | None) -> Float[Array, " source"]:
    """Frequency of each flux: from the option, else the column, else the metadata, else 1.4 GHz."""
    frequency = np.full(len(columns.identifier), REFERENCE_FREQUENCY)
    if option is not None:
        frequency[:] = option
    elif columns.has("reference_frequency"):
        frequency = columns.number("reference_frequency", units.Hz, assumed=units.Hz)
    else:
        metadata = columns.metadata
        stated = [metadata[key] for key in REFERENCE_FREQUENCY_KEYS if key in metadata]
        if stated:
            try:
                quantity = units.Quantity(stated[0])
                if quantity.unit.is_equivalent(units.dimensionless_unscaled):
                    quantity = quantity * units.Hz
                frequency[:] = quantity.to_value(units.Hz)
            except (TypeError, ValueError) as error:
                raise InputError(
                    f"{columns.name}: its metadata give the reference frequency {stated[0]!r};"
                    " a number of Hz or a text such as '1.4 GHz' is needed"
                ) from error
    lowest, highest = RADIO_FREQUENCIES
    good = (frequency >= lowest) & (frequency <= highest)
    if not good.all():
        raise InputError(
            f"{columns.name}: the reference frequency is {frequency[~good][0]:g} Hz;"
            f" a frequency from {lowest:g} to {highest:g} Hz is needed"
        )
    return frequency


def catalogue_from_galaxies(
    galaxies: Galaxies, phase_centre: PhaseCentre | None = None
) -> Catalogue:
    """Catalogue of simulated galaxies, with (ra, dec) about ``phase_centre``, or (l, m) without one."""
    position = {"l": galaxies.l, "m": galaxies.m}
    if phase_centre is not None:
        ra, dec = equatorial(phase_centre, galaxies.l, galaxies.m)
        position = {"ra": ra, "dec": dec}
    return Catalogue(
        identifier=np.arange(1, len(galaxies) + 1),
        flux=galaxies.flux,
        spectral_index=galaxies.spectral_index,
        scale_length=galaxies.scale_length,
        ellipticity=galaxies.ellipticity,
        reference_frequency=galaxies.reference_frequency,
        field_centre=phase_centre,
        **position,
    )


def catalogue_table(catalogue: Catalogue, provenance: Mapping[str, str] | None = None) -> Table:
    """Return the catalogue with units and descriptions, as it is written."""
    table = Table()

    def add(name: str, values: Array | None, unit: str | None, description: str) -> None:
        if values is not None:
            table[name] = Column(values, unit=unit, description=description)

    add("id", catalogue.identifier, None, "identifier of the source")
    for name in ("ra", "dec"):
        angle = getattr(catalogue, name)
        degrees = None if angle is None else np.degrees(angle)
        add(name, degrees, "deg", f"{name}, ICRS")
    add("l", catalogue.l, "rad", "direction cosine to the East")
    add("m", catalogue.m, "rad", "direction cosine to the North")
    add("flux", catalogue.flux / MICROJANSKY, "uJy", "flux density at reference_frequency")
    size = catalogue.scale_length
    add(
        "scale_length",
        None if size is None else size / ARCSEC,
        "arcsec",
        "scale length alpha of the profile",
    )
    add("spectral_index", catalogue.spectral_index, None, "beta in S ~ frequency^beta")
    if catalogue.ellipticity is not None:
        frame = "e = e1 + i e2, |e| = (a-b)/(a+b), (l East, m North) frame of the phase centre"
        add("e1", catalogue.ellipticity.real, None, frame)
        add("e2", catalogue.ellipticity.imag, None, frame)
    if catalogue.shear is not None:
        frame = "reduced shear g1 + i g2 of the source, axes local East and North, as TreeCorr takes RA and Dec"
        add("shear1", catalogue.shear.real, None, frame)
        add("shear2", catalogue.shear.imag, None, frame)
    if catalogue.is_point is not None:
        words = np.where(catalogue.is_point, POINT, GALAXY)
        add("profile", words, None, "point: a star or an active nucleus without size")
    table.meta["reference_frequency"] = f"{catalogue.reference_frequency:.17g} Hz"
    if catalogue.field_centre is not None:
        table.meta["ra0_deg"] = math.degrees(catalogue.field_centre.ra)
        table.meta["dec0_deg"] = math.degrees(catalogue.field_centre.dec)
    if provenance is not None:
        table.meta.update(provenance)
    return table


def write_catalogue(
    path: Path | str,
    catalogue: Catalogue,
    provenance: Mapping[str, str] | None = None,
    *,
    overwrite: bool = False,
) -> None:
    """Write a catalogue as ECSV, FITS or VOTable, by extension."""
    write_table(Path(path), catalogue_table(catalogue, provenance), overwrite=overwrite)
