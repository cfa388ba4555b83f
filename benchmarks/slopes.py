"""Slopes of measured against true ellipticity, by every definition that the documentation quotes."""

from dataclasses import dataclass

import numpy as np

from uvshear.diagnostics.slope import equal_weights, fit_slope, population_weights

FLUX_BINS_UJY = ((10, 20), (20, 50), (50, 200))


@dataclass(frozen=True)
class PaperSlope:
    """A slope by the definition of Rivi & Miller 2018, as its formal error suggests it.

    Parameters
    ----------
    value
        Regression through the origin with the weights w = 1/s^2.
    error
        Formal error, 1/sqrt(sum x^2/s^2).
    effective
        Number of galaxies that carry the slope, (sum w x^2)^2/sum (w x^2)^2.
    """

    value: float
    error: float
    effective: float


def paper_slope(true: np.ndarray, measured: np.ndarray, error: np.ndarray) -> PaperSlope:
    """Fit the slope of one component with weights 1/s^2; galaxies without a finite shape are left out."""
    good = np.isfinite(true) & np.isfinite(measured) & np.isfinite(error) & (error > 0)
    x, y, weight = true[good], measured[good], error[good] ** -2
    carried = weight * x**2
    norm = float(carried.sum())
    return PaperSlope(
        value=float(np.sum(weight * x * y)) / norm,
        error=norm**-0.5,
        effective=norm**2 / float(np.sum(carried**2)),
    )


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
        paper = paper_slope(x, y, error)
        figures |= {
            f"slope_{name}": paper.value,
            f"slope_{name}_err": paper.error,
            f"effective_galaxies_{name}": round(paper.effective),
        }
        for kind, fitted in (
            ("population", fit_slope(x, y, error, population_weights)),
            ("unweighted", fit_slope(x, y, error, equal_weights)),
        ):
            figures |= {
                f"slope_{kind}_{name}": fitted.value,
                f"slope_{kind}_{name}_err": fitted.error,
            }
        for low, high in FLUX_BINS_UJY:
            chosen = (flux_ujy >= low) & (flux_ujy < high)
            if chosen.sum() < 2:
                continue
            inside = paper_slope(x[chosen], y[chosen], error[chosen])
            figures |= {
                f"slope_{low}_{high}_{name}": inside.value,
                f"slope_{low}_{high}_{name}_err": inside.error,
            }
    return figures
