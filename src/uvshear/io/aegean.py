"""Component catalogues of Aegean."""

import numpy as np
from astropy import units
from astropy.table import Table

from uvshear.geometry.deconvolution import FittedGaussians, deconvolved_widths, matrix_of
from uvshear.io.columns import Columns, NamedColumn
from uvshear.io.source_finders import Sizes, SourceFinder, fitted_values

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
_ERRORS = ("err_a", "err_b", "err_pa")
_UNITS = {
    name: units.deg if name.endswith("pa") else units.arcsec for name in (*_ELLIPSES, *_ERRORS)
}


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
        values = np.array(fitted_values(columns, (*_ELLIPSES, *_ERRORS), _UNITS))
        known = np.isfinite(values[: len(_ELLIPSES)]).all(axis=0)
        a, b, pa, psf_a, psf_b, psf_pa, *errors = np.where(known, np.nan_to_num(values), 0.0)
        # An error of -1 means that there is none.
        fitted = FittedGaussians(a, b, pa, *(np.maximum(error, 0.0) for error in errors))
        beam = matrix_of(psf_a, psf_b, psf_pa)
        return Sizes.from_widths(deconvolved_widths(fitted, beam)).where(known)
