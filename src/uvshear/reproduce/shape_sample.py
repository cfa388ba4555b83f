"""Measured shapes of simulated galaxies, as arrays that a part of a computation keeps."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Self

import numpy as np

from uvshear.bias.isolated import FITTED, mock_galaxies
from uvshear.diagnostics.slope import Slopes, fit_slopes
from uvshear.galaxy import DiscEllipticityPrior
from uvshear.reproduce.mock_survey import MockSurvey
from uvshear.reproduce.repeats import AsDrawn, Repeats
from uvshear.shapes.measurement import FitFlag
from uvshear.shapes.shape import measure_shape
from uvshear.shapes.weight import lensfit_weight
from uvshear.typing import Array, Bool, Complex, Float, Int

FLAGS = tuple(FitFlag)
"""Flags in the order in which they are numbered."""


@dataclass(frozen=True)
class ShapeTask:
    """Galaxies whose shapes are measured together.

    Parameters
    ----------
    survey
        The survey.
    first, number
        Number of the first galaxy, and number of galaxies.
    repeats
        Realisations of each galaxy.
    """

    survey: MockSurvey
    first: int
    number: int
    repeats: Repeats = AsDrawn()  # noqa: RUF009 - frozen

    @property
    def seconds(self) -> float:
        """Estimated processor time [s]."""
        fits = self.number * len(self.survey.shears) * len(self.repeats.realisations())
        return fits * self.survey.facets.seconds


@dataclass(frozen=True)
class ShapeSample:
    """Measurements, one for each galaxy, shear and realisation.

    Parameters
    ----------
    galaxy, shear, realisation
        Numbers of each.
    flux
        Flux in the catalogue [Jy].
    true
        True ellipticity e1 + i e2 behind the shear.
    measured
        Posterior mean of the ellipticity; NaN where the fit failed.
    error
        Standard deviations of e1 and e2.
    e_sigma
        det(covariance)^(1/4).
    snr
        Signal-to-noise ratio of the fit.
    flag
        Number of the flag in ``FLAGS``.
    """

    galaxy: Int[Array, " shape"]
    shear: Int[Array, " shape"]
    realisation: Int[Array, " shape"]
    flux: Float[Array, " shape"]
    true: Complex[Array, " shape"]
    measured: Complex[Array, " shape"]
    error: Float[Array, "shape 2"]
    e_sigma: Float[Array, " shape"]
    snr: Float[Array, " shape"]
    flag: Int[Array, " shape"]

    def __len__(self) -> int:
        return len(self.galaxy)

    @property
    def is_good(self) -> Bool[Array, " shape"]:
        """Mask of the successful fits; what they found need not be significant."""
        return np.isin(self.flag, [number for number, flag in enumerate(FLAGS) if flag.is_fitted])

    @property
    def weight(self) -> Float[Array, " shape"]:
        """Weights of the ellipticities in a mean; 0 where the fit failed."""
        weight = lensfit_weight(self.e_sigma, DiscEllipticityPrior())
        return np.where(self.is_good, weight, 0.0)

    def select(self, chosen: Bool[Array, " shape"]) -> Self:
        """Return some of the measurements."""
        return type(self)(**{name: values[chosen] for name, values in self.arrays().items()})

    def arrays(self) -> dict[str, Array]:
        """Return all columns."""
        return {name: getattr(self, name) for name in self.__dataclass_fields__}

    @classmethod
    def join(cls, parts: Iterable[Mapping[str, Array]]) -> Self:
        """Join the columns of parts that were measured one by one."""
        columns = list(parts)
        return cls(
            **{
                name: np.concatenate([part[name] for part in columns])
                for name in cls.__dataclass_fields__
            }
        )

    def slopes(self) -> tuple[Slopes, Slopes]:
        """Return the slopes of e1 and of e2 of the successful fits."""
        good = self.select(self.is_good)
        return (
            fit_slopes(good.true.real, good.measured.real, good.error[:, 0]),
            fit_slopes(good.true.imag, good.measured.imag, good.error[:, 1]),
        )


def measure_shapes(task: ShapeTask) -> dict[str, Array]:
    """Draw galaxies, and measure every realisation of each of them behind every shear."""
    realisations = task.repeats.realisations()
    rows = []
    experiment = task.survey.experiment()
    mocks = mock_galaxies(experiment, task.first, task.number, realisations)
    for count, mock in enumerate(mocks):
        shape = measure_shape(mock.source.facet, mock.source.prior, FITTED)
        (xx, _), (_, yy) = shape.covariance
        rows.append(
            (
                task.first + mock.number,
                mock.shear,
                count % len(realisations),
                mock.source.flux,
                mock.true.ellipticity,
                complex(*shape.ellipticity),
                (np.sqrt(xx), np.sqrt(yy)),
                shape.e_sigma,
                shape.snr,
                FLAGS.index(shape.flag),
            )
        )
    columns = dict(zip(ShapeSample.__dataclass_fields__, zip(*rows, strict=True), strict=True))
    return {name: np.array(values) for name, values in columns.items()}


def shape_tasks(
    name: str, survey: MockSurvey, galaxies: int, block: int, repeats: Repeats | None = None
) -> Iterator[tuple[str, ShapeTask]]:
    """Divide galaxies into tasks of equal size, and yield the name of each part with its task.

    Parameters
    ----------
    name
        Beginning of the names, after which the number of the first galaxy follows.
    survey
        The survey.
    galaxies, block
        Number of galaxies in all, and in a task.
    repeats
        Realisations of each galaxy; each is measured once unless given.
    """
    for first in range(0, galaxies, block):
        number = min(block, galaxies - first)
        yield f"{name}-{first}", ShapeTask(survey, first, number, repeats or AsDrawn())


def sample_named(found: Mapping[str, Mapping[str, Array]], name: str) -> ShapeSample:
    """Join the parts whose names begin with a name, as ``shape_tasks`` has given them."""
    return ShapeSample.join(part for key, part in found.items() if key.rpartition("-")[0] == name)
