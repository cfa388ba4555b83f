"""Models of a galaxy in the cells of a facet, and their fit to the averages of visibilities by least squares."""

from abc import ABC, abstractmethod
from dataclasses import dataclass

import numpy as np

from uvshear.bias.isolated import FITTED
from uvshear.reproduce.visibility_cells import VisibilityCells
from uvshear.shapes.measurement import GalaxyFit
from uvshear.shapes.prior import ShapePrior
from uvshear.shapes.template import Template, moved
from uvshear.typing import Array, Complex, Float

STEPS = 8
"""Number of Gauss-Newton steps, which converge in three or four from the true galaxy."""


class CellModel(ABC):
    """Visibilities of a galaxy in cells, and their derivatives with respect to its parameters."""

    @abstractmethod
    def model(self, galaxy: GalaxyFit) -> Complex[Array, " cell"]:
        """Return the visibilities [Jy]."""

    @abstractmethod
    def responses(self, galaxy: GalaxyFit) -> Complex[Array, "6 cell"]:
        """Differentiate them with respect to flux, e1, e2, ln alpha, l and m."""


@dataclass(frozen=True)
class AtPoints(CellModel):
    """The model is sampled at one point of each cell.

    Parameters
    ----------
    uv
        Points [wavelengths].
    """

    uv: Float[Array, "cell 2"]

    def model(self, galaxy: GalaxyFit) -> Complex[Array, " cell"]:
        """Return the visibilities."""
        return Template(self.uv, FITTED).model(galaxy)

    def responses(self, galaxy: GalaxyFit) -> Complex[Array, "6 cell"]:
        """Return the derivatives."""
        return Template(self.uv, FITTED).responses(galaxy)


@dataclass(frozen=True)
class Gridded(CellModel):
    """The model is predicted at all samples and averaged as the data are."""

    cells: VisibilityCells

    def model(self, galaxy: GalaxyFit) -> Complex[Array, " cell"]:
        """Return the visibilities."""
        return self._averaged(Template(self.cells.uv, FITTED).model(galaxy))

    def responses(self, galaxy: GalaxyFit) -> Complex[Array, "6 cell"]:
        """Return the derivatives."""
        rows = Template(self.cells.uv, FITTED).responses(galaxy)
        return np.array([self._averaged(row) for row in rows])

    def _averaged(self, values: Complex[Array, " sample"]) -> Complex[Array, " cell"]:
        return self.cells.total(values) / self.cells.weight


@dataclass(frozen=True)
class CellFit:
    """Most likely ellipticity, with its errors from the Fisher matrix.

    Parameters
    ----------
    ellipticity
        e1 + i e2.
    error
        Standard deviations of e1 and e2.
    """

    ellipticity: complex
    error: tuple[float, float]


def fit_cells(
    data: Complex[Array, " cell"],
    power: Float[Array, " cell"],
    model: CellModel,
    prior: ShapePrior,
    start: GalaxyFit,
) -> CellFit:
    """Fit a galaxy to mean visibilities by Gauss-Newton steps from a galaxy nearby.

    Parameters
    ----------
    data
        Mean visibility of each cell [Jy].
    power
        Its inverse variance [Jy^-2].
    model
        Model of the cells.
    prior
        Prior of the size.
    start
        Galaxy to start from.
    """
    fit = start
    for _ in range(STEPS):
        rows = model.responses(fit).astype(complex)
        pull, precision = prior.pull(fit)
        scaled = rows.conj() * power
        hessian = np.real(scaled @ rows.T) + np.diag(precision)
        gradient = np.real(scaled @ (data - model.model(fit))) + pull
        unit = 1 / np.sqrt(np.diag(hessian))
        inverse = np.linalg.inv(hessian * np.outer(unit, unit)) * np.outer(unit, unit)
        fit = moved(fit, inverse @ gradient)
    error = np.sqrt(np.diag(inverse)[1:3]).tolist()
    return CellFit(fit.ellipticity, (error[0], error[1]))
