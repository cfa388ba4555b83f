"""Component catalogues of Aegean."""

import numpy as np
from astropy import units
from astropy.table import Table

from uvshear.geometry.deconvolution import FittedGaussians, deconvolved_widths, matrix_of
from uvshear.io.columns import Columns, NamedColumn
from uvshear.io.source_finders import Sizes, SourceFinder
from uvshear.typing import Array, Float

_COLUMNS = {
    "id": NamedColumn("uuid"),
    "ra": NamedColumn("ra", units.deg),
    "dec": NamedColumn("dec", units.deg),
    "ra_err": NamedColumn("err_ra", units.deg),
    "dec_err": NamedColumn("err_dec", units.deg),
    "flux": NamedColumn("int_flux", units.Jy),
    "flux_err": NamedColumn("err_int_flux", units.Jy),
}

_ELLIPSES = ("a", "b", "pa", "psf_a", "psf_b", "psf_pa")


class Aegean(SourceFinder):
    """Component catalogues of Aegean, whose columns have these units by convention."""

    def __init__(self) -> None:
        super().__init__(
            "Aegean", frozenset({"island", "source", "int_flux", "ra", "dec", "psf_a", "psf_b"})
        )

    def sources(self, table: Table) -> dict[str, NamedColumn]:
        """Return the columns that the table has."""
        return {
            ours: source for ours, source in _COLUMNS.items() if source.column in table.colnames
        }

    def sizes(self, columns: Columns) -> Sizes | None:
        """Return the sizes of the fitted a, b, pa less the beam's psf_a, psf_b, psf_pa."""
        if not all(columns.has(name) for name in _ELLIPSES):
            return None
        a, b, pa, psf_a, psf_b, psf_pa = (_angle(columns, name) for name in _ELLIPSES)
        errors = (_error(columns, f"err_{name}", a) for name in ("a", "b", "pa"))
        known = np.isfinite(a + b + pa + psf_a + psf_b + psf_pa)
        fitted = FittedGaussians(
            *(np.where(known, value, 0.0) for value in (a, b, pa)),
            *errors,
        )
        beam = matrix_of(*(np.where(known, value, 0.0) for value in (psf_a, psf_b, psf_pa)))
        return Sizes.from_widths(deconvolved_widths(fitted, beam)).where(known)


def _angle(columns: Columns, name: str) -> Float[Array, " source"]:
    unit = units.deg if name.endswith("pa") else units.arcsec
    return columns.known(name, units.rad, assumed=unit)


def _error(columns: Columns, name: str, like: Float[Array, " source"]) -> Float[Array, " source"]:
    if not columns.has(name):
        return np.zeros_like(like)
    unit = units.deg if name.endswith("pa") else units.arcsec
    return columns.error(name, units.rad, assumed=unit)
