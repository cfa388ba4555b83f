"""Slopes of measured against true ellipticity, by every definition that the documentation quotes."""

import numpy as np

from uvshear.diagnostics.slope import fit_slope, fit_slopes

FLUX_BINS_UJY = ((10, 20), (20, 50), (50, 200))


def slope_figures(
    true: np.ndarray, measured: np.ndarray, errors: np.ndarray, flux_ujy: np.ndarray
) -> dict[str, float]:
    """Return the slopes of e1 and e2 by every definition, and the paper's by flux.

    Parameters
    ----------
    true, measured
        e1 + i e2.
    errors
        Standard deviations of e1 and e2, a row a galaxy.
    flux_ujy
        True flux [uJy].
    """
    figures: dict[str, float] = {}
    for k, (x, y) in enumerate(((true.real, measured.real), (true.imag, measured.imag))):
        name, error = f"e{k + 1}", errors[:, k]
        slopes = fit_slopes(x, y, error)
        figures |= {
            f"slope_{name}": slopes.inverse_variance.value,
            f"slope_{name}_err": slopes.inverse_variance.formal_error,
            f"effective_galaxies_{name}": round(slopes.inverse_variance.effective_number),
        }
        for kind, fitted in (("population", slopes.population), ("unweighted", slopes.unweighted)):
            figures |= {
                f"slope_{kind}_{name}": fitted.value,
                f"slope_{kind}_{name}_err": fitted.error,
            }
        for low, high in FLUX_BINS_UJY:
            chosen = (flux_ujy >= low) & (flux_ujy < high)
            if chosen.sum() < 2:
                continue
            inside = fit_slope(x[chosen], y[chosen], error[chosen])
            figures |= {
                f"slope_{low}_{high}_{name}": inside.value,
                f"slope_{low}_{high}_{name}_err": inside.formal_error,
            }
    return figures
