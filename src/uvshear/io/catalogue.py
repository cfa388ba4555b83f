"""Catalogues of sources: any table astropy reads, checked, in SI and radians."""

import math
import warnings
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Final, Self

import numpy as np
from astropy import units
from astropy.table import Column, Table

from uvshear.constants import ARCSEC, MICROJANSKY, REFERENCE_FREQUENCY, SPECTRAL_INDEX
from uvshear.errors import DataWarning, InputError
from uvshear.galaxy.galaxies import Galaxies
from uvshear.geometry.directions import PhaseCentre, direction_cosines, equatorial
from uvshear.io.catalogue_columns import (
    GALAXY,
    POINT,
    columns_of,
    field_centre,
    frequencies,
    has_positions_and_fluxes,
    points,
    position_errors,
    positions,
    sizes,
    spin_2,
)
from uvshear.io.column_map import check_column_map
from uvshear.io.columns import shown
from uvshear.io.identifiers import OTHER_NAMES
from uvshear.io.tables import Wanted, read_table, write_table
from uvshear.typing import Array, Bool, Complex, Float, Shaped

BRIGHTEST: Final = 1e10
"""Flux density that no source has [Jy]; the Sun reaches a hundredth of it in its strongest bursts."""

STEEPEST: Final = 100.0
"""Largest spectral index, of either sign, that can be computed with; fits to few channels give wild values."""

IDENTIFIERS: Final = frozenset({"id", "ID", "Id", "Source_name", *OTHER_NAMES})
"""Columns that may have identifiers, which stay text in formats without types."""


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
        Scale length alpha of the profile [rad], NaN where it is not known; None where the catalogue has none.
    ellipticity
        e1 + i e2 in the (l, m) frame, in simulated catalogues; never used in a measurement.
    shear
        Reduced shear g1 + i g2 of each source for simulations, in the frame of local North (TreeCorr's convention for
        RA and Dec); None where the catalogue has none. It is not part of ``ellipticity``.
    scale_length_err
        Standard error of ``scale_length`` [rad], 0 where it is not known; None where the catalogue has none.
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
    scale_length_err: Float[Array, " source"] | None = None
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
            worst = shown(self.identifier[int(np.argmin(n))])
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
    column_map: Mapping[str, str] | None = None,
) -> Catalogue:
    """Read a catalogue in ECSV, FITS, VOTable, CSV and similar formats, or a source list of PyBDSF or Aegean as it is.

    Parameters
    ----------
    path
        The file, compressed or not; ``FILE.fits[2]`` or ``FILE.fits[NAME]`` chooses one of several tables.
    flux_unit
        Unit of a flux column that has none (CSV), as astropy spells it.
    reference_frequency
        Frequency of the fluxes [Hz], in place of the one that the file states.
    column_map
        Names of the file's columns that differ from those of this package, such as ``{"ra": "RAJ2000"}``.

    Warns
    -----
    DataWarning
        The catalogue has no identifiers; its table was chosen among several; or the source finder's sizes cannot be
        used.
    """
    given = dict(column_map or {})
    check_column_map(given)
    wanted = Wanted(
        "catalogue",
        suits=lambda names: has_positions_and_fluxes(names, given),
        texts=IDENTIFIERS | ({given["id"]} if "id" in given else set()),
    )
    table = read_table(Path(path), wanted)
    catalogue = catalogue_from_table(
        table,
        str(path),
        flux_unit=flux_unit,
        reference_frequency=reference_frequency,
        column_map=given,
    )
    if not columns_of(table, str(path), given).has_identifiers:
        warnings.warn(
            f"{path}: has no column of identifiers; its sources are numbered by row, from 1",
            DataWarning,
            stacklevel=2,
        )
    return catalogue


def catalogue_from_table(
    table: Table,
    name: str = "catalogue",
    *,
    flux_unit: str | None = None,
    reference_frequency: float | None = None,
    column_map: Mapping[str, str] | None = None,
) -> Catalogue:
    """Check a table and turn it into a catalogue; error messages call the table by ``name``."""
    check_column_map(column_map or {})
    if len(table) == 0:
        raise InputError(f"{name}: has no rows; a catalogue of at least one source is needed")
    columns = columns_of(table, name, column_map or {})
    flux = columns.number("flux", units.Jy, given=flux_unit, needs_unit=True)
    columns.require("flux", flux > 0, "a positive flux density (here in Jy) is needed", flux)
    columns.require("flux", flux < BRIGHTEST, f"less than {BRIGHTEST:g} Jy is needed", flux)

    position = positions(columns)

    index = np.full(len(table), SPECTRAL_INDEX)
    if columns.has("spectral_index"):
        index = columns.number("spectral_index", units.dimensionless_unscaled)
        needed = f"-{STEEPEST:g} to {STEEPEST:g} is needed"
        columns.require("spectral_index", np.abs(index) <= STEEPEST, needed, index)

    size = sizes(columns)
    flux_err = None
    if columns.has("flux_err"):
        flux_err = columns.error("flux_err", units.Jy, assumed=columns.unit_of("flux", flux_unit))
        flux_err = np.where(flux_err < BRIGHTEST, flux_err, 0.0)
    frequency = frequencies(columns, reference_frequency)
    common = float(frequency[0])
    return Catalogue(
        identifier=columns.identifier,
        flux=flux * (common / frequency) ** index,
        flux_err=None if flux_err is None else flux_err * (common / frequency) ** index,
        position_err=position_errors(columns),
        spectral_index=index,
        scale_length=None if size is None else size.scale_length,
        scale_length_err=None if size is None or not size.err.any() else size.err,
        ellipticity=spin_2(columns, "e1", "e2", "|e| = (a-b)/(a+b) below 1 is needed"),
        shear=spin_2(columns, "shear1", "shear2", "a reduced shear below 1 is needed"),
        is_point=points(columns),
        reference_frequency=common,
        field_centre=field_centre(columns),
        **position,
    )


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
    if (err := catalogue.scale_length_err) is not None:
        add("scale_length_err", err / ARCSEC, "arcsec", "standard error of scale_length")
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
