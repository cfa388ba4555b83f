"""Catalogues as source finders write them, in the columns that this package knows.

A source finder fits Gaussians to an image. The deconvolved size of a Gaussian gives the scale length of a disc with the
same half-light radius, which is FWHM/2 of a Gaussian and 1.678 scale lengths of an exponential disc. A source that the
finder does not resolve is a point source.
"""

from abc import ABC, abstractmethod
from dataclasses import dataclass, field

import numpy as np
from astropy import units
from astropy.table import Column, MaskedColumn, Table

from uvshear.typing import Array, Float

FWHM_OF_SCALE_LENGTH = 2 * 1.6783469900166605
"""Full width at half maximum of a Gaussian over the scale length of a disc of the same half-light radius."""


ADDED = frozenset(
    {
        "scale_length",
        "profile",
        "spectral_index",
        "reference_frequency",
        "e1",
        "e2",
        "shear1",
        "shear2",
    }
)
"""Columns of this package that a user may have added to a source finder's table."""


@dataclass(frozen=True)
class SourceFinder(ABC):
    """A source finder: how its tables are recognised, and what its columns mean.

    Parameters
    ----------
    signature
        Columns by which its tables are recognised.
    columns
        For each of its columns, the name in this package and the unit to assume where a file gives none.
    """

    signature: frozenset[str]
    columns: dict[str, tuple[str, units.UnitBase | None]] = field(default_factory=dict)

    def writes(self, table: Table) -> bool:
        """Tell whether a table is one of this finder's."""
        return self.signature <= set(table.colnames)

    def translated(self, table: Table) -> Table:
        """Return the table in the columns of this package."""
        found = Table(meta=table.meta)
        for theirs, (ours, unit) in self.columns.items():
            if theirs in table.colnames:
                column = table[theirs].copy()
                if column.unit is None or str(column.unit).strip() == "":
                    column.unit = unit
                found[ours] = column
        for name in table.colnames:
            # Columns that a user has added take precedence.
            if name.lower() in ADDED and name not in found.colnames:
                found[name.lower()] = table[name]
        width = self.deconvolved(table)
        if width is not None:
            if "scale_length" not in found.colnames:
                found["scale_length"] = Column(width / FWHM_OF_SCALE_LENGTH, unit="arcsec")
            if "profile" not in found.colnames:
                found["profile"] = np.where(width > 0, "galaxy", "point")
        return found

    @abstractmethod
    def deconvolved(self, table: Table) -> Float[Array, " source"] | None:
        """Return the geometric mean of the deconvolved FWHM [arcsec], 0 where not resolved; None without sizes."""


class PyBDSF(SourceFinder):
    """Source lists (.srl) and lists of Gaussians (.gaul) of PyBDSF."""

    def __init__(self) -> None:
        super().__init__(
            frozenset({"RA", "DEC", "Total_flux"}),
            {
                "Source_id": ("id", None),
                "Gaus_id": ("id", None),
                "RA": ("ra", units.deg),
                "DEC": ("dec", units.deg),
                "E_RA": ("ra_err", units.deg),
                "E_DEC": ("dec_err", units.deg),
                "Total_flux": ("flux", None),
                "E_Total_flux": ("flux_err", None),
            },
        )

    def deconvolved(self, table: Table) -> Float[Array, " source"] | None:
        """Geometric mean of PyBDSF's own deconvolved axes, DC_Maj and DC_Min."""
        if not {"DC_Maj", "DC_Min"} <= set(table.colnames):
            return None
        long, short = (_in_arcsec(table[name], units.deg) for name in ("DC_Maj", "DC_Min"))
        return _mean_width(long, short)


class Aegean(SourceFinder):
    """Component catalogues of Aegean."""

    def __init__(self) -> None:
        super().__init__(
            frozenset({"island", "source", "int_flux", "ra", "dec", "psf_a", "psf_b"}),
            {
                "uuid": ("id", None),
                "ra": ("ra", units.deg),
                "dec": ("dec", units.deg),
                "err_ra": ("ra_err", units.deg),
                "err_dec": ("dec_err", units.deg),
                "int_flux": ("flux", units.Jy),
                "err_int_flux": ("flux_err", units.Jy),
            },
        )

    def deconvolved(self, table: Table) -> Float[Array, " source"]:
        """Geometric mean of the axes of the fitted a, b, pa less the beam's psf_a, psf_b, psf_pa."""
        fitted, beam = (
            _covariance(*(table[f"{prefix}{name}"] for name in ("a", "b", "pa")))
            for prefix in ("", "psf_")
        )
        short, long = np.sqrt(np.maximum(np.linalg.eigvalsh(fitted - beam), 0.0)).T
        return _mean_width(long, short)


SOURCE_FINDERS: tuple[SourceFinder, ...] = (PyBDSF(), Aegean())


def in_our_columns(table: Table) -> Table:
    """Return a source finder's table in the columns of this package, and any other table as it is."""
    for finder in SOURCE_FINDERS:
        if finder.writes(table):
            return finder.translated(table)
    return table


def _mean_width(
    long: Float[Array, " source"], short: Float[Array, " source"]
) -> Float[Array, " source"]:
    """Geometric mean of the axes, the short one taken as half of the long one or more: it may not be resolved."""
    return np.sqrt(long * np.maximum(short, 0.5 * long))


def _in_arcsec(column: Column, assumed: units.UnitBase) -> Float[Array, " source"]:
    unit = column.unit or assumed
    values = column.filled(np.nan) if isinstance(column, MaskedColumn) else column
    return np.asarray(values, float) * float(units.Unit(unit).to(units.arcsec))


def _covariance(a: Column, b: Column, angle: Column) -> Float[Array, "source 2 2"]:
    """Squares of the axes [arcsec^2] in the axes North and East."""
    first, second = (_in_arcsec(axis, units.arcsec) for axis in (a, b))
    turn = np.radians(np.asarray(angle, float))
    along = np.stack([np.cos(turn), np.sin(turn)], axis=-1)
    across = np.stack([-np.sin(turn), np.cos(turn)], axis=-1)
    long, short = (np.einsum("si,sj->sij", way, way) for way in (along, across))
    return (first**2)[:, None, None] * long + (second**2)[:, None, None] * short
