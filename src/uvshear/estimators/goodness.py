r"""Tests of whether galaxies are those of an assumed population.

Rao's score test: under the right population the scores d ln P(D|g, theta)/d theta of galaxies have the mean zero. With
their mean s and covariance C over n galaxies, Hotelling's statistic

.. math:: \frac{n - k}{k (n - 1)}\, n\, s^T C^{-1} s

of k parameters has the F distribution with k and n - k degrees of freedom. With all others right, one parameter is off
by about its s/C.

White's test of the information: with q and h the gradient and the curvature of ln P with respect to the shear, the mean
of q q^T - h is zero. It also holds for a fitted population, whose scores are zero by construction.

References
----------
Rao 1948, Proc. Cambridge Phil. Soc. 44, 50; White 1982, Econometrica 50, 1.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final, Self

import numpy as np
from scipy.special import fdtrc, stdtr

from uvshear.estimators.terms import Terms
from uvshear.typing import Array, Float

IMPROBABLE: Final = 1e-6
"""Probability of a test below which a population is judged not to fit."""

DIFFERENT: Final = 0.1
"""Deviation of a parameter's logarithm that matters. With sizes that are wrong by 0.1 in their logarithm, m is 0.02."""

DIFFERENT_INFORMATION: Final = 0.25
"""Deviation of the information from its expectation that is told."""

FEWEST_INFORMATION: Final = 300
"""Smallest number of galaxies for a test of the information. Precise shapes near the rim of the disc of ellipticities
have squares of the gradient without an upper limit, so that few galaxies scatter too little: in 20 samples of 100 of
the right population one probability was 6e-6; in 33 samples of 310 none was below 0.05."""

ABSENT: Final = 0.05
"""Fraction of galaxies that do not occur in a population above which it is judged not to fit."""

FEWEST: Final = 100
"""Smallest number of galaxies for a test of the parameters; its probabilities are those of normal scores. In 90 samples
of 30 galaxies of the right population one probability was 3e-8; in 85 samples of 100 none was below 0.002."""

FEWEST_ABSENT: Final = 5
"""Smallest number of galaxies that do not occur in a population by which it is judged."""

PARTS: Final[Mapping[str, tuple[str, str]]] = {
    "size": ("median", "sigma"),
    "ellipticity": ("c", "e0"),
}
"""Parameters of each part of a population, in the order of the scores; all of them as logarithms."""


@dataclass(frozen=True)
class PartTest:
    """Test of one part of a population.

    Parameters
    ----------
    probability
        Probability of scores so far from zero under the right population.
    shift
        Deviation of the logarithm of each parameter from the assumed value, to first order, with the others fixed.
    """

    probability: float
    shift: Mapping[str, float]

    @property
    def fits(self) -> bool:
        """Whether no deviation is both significant and large enough to matter."""
        return self.probability > IMPROBABLE or max(map(abs, self.shift.values())) < DIFFERENT


@dataclass(frozen=True)
class PopulationGoodness:
    """How well an assumed population fits the galaxies.

    Parameters
    ----------
    n
        Number of galaxies with a likelihood.
    absent
        Number of these that cannot belong to the population.
    information_ratio
        Sum of the squares of the gradients of ln P with respect to the shear, over the sum of the curvatures; 1 is
        expected.
    information_probability
        Probability of a ratio so far from 1 under the right population.
    parts
        Test of each part of the population that has parameters and was not fitted to the same galaxies.
    """

    n: int
    absent: int
    information_ratio: float
    information_probability: float
    parts: Mapping[str, PartTest]

    @classmethod
    def from_terms(cls, terms: Terms, scores: Float[Array, "source parameter"]) -> Self:
        """Test a population with the terms and the scores of the galaxies.

        Parameters
        ----------
        terms
            Gradients and curvatures of ln P by the shear; NaN for a source without a likelihood, and zero for a galaxy
            that does not occur in the population.
        scores
            Gradients by the parameters of the population, in the order of ``PARTS``; none if it was fitted.
        """
        is_scored = np.isfinite(scores).all(axis=1)
        present = terms.tells & is_scored
        count = int((np.isfinite(terms.value).all(axis=1) & is_scored).sum())
        q, h = terms.value[present], terms.response[present]
        squares, curvatures = np.sum(q**2, axis=1), np.trace(h, axis1=1, axis2=2)
        total = float(curvatures.sum())
        parts = {
            name: _tested(scores[present, 2 * k : 2 * k + 2], names)
            for k, (name, names) in enumerate(PARTS.items())
            if scores.shape[1] >= 2 * k + 2 and len(q) >= FEWEST
        }
        return cls(
            n=count,
            absent=count - len(q),
            information_ratio=float(squares.sum()) / total if total else float("nan"),
            information_probability=_probability_of_mean(squares - curvatures),
            parts=parts,
        )

    @property
    def reasons(self) -> tuple[str, ...]:
        """Why the population does not fit; empty if it may be the right one."""
        found = []
        size, ellipticity = self.parts.get("size"), self.parts.get("ellipticity")
        if size is not None and not size.fits:
            median = size.shift["median"]
            found.append(
                f"their sizes are about {np.exp(np.clip(median, -99, 99)):.2g} times those of the population"
                if abs(median) >= DIFFERENT
                else "the scatter of their sizes differs from that of the population"
            )
        if ellipticity is not None and not ellipticity.fits:
            found.append("their ellipticities have a different distribution")
        is_far = not abs(self.information_ratio - 1) < DIFFERENT_INFORMATION
        if self.information_probability < IMPROBABLE and is_far:
            found.append(
                "their response to a shear is not that of the population (information ratio"
                f" {self.information_ratio:.2g}, where 1 is expected)"
            )
        if self.absent > ABSENT * self.n and self.absent >= FEWEST_ABSENT:
            found.append(f"{self.absent} of {self.n} galaxies cannot belong to it")
        return tuple(found)

    def record(self) -> dict[str, object]:
        """Return the numbers for a JSON file."""
        record: dict[str, object] = {
            "n": self.n,
            "absent": self.absent,
            "information_ratio": self.information_ratio,
            "information_probability": self.information_probability,
        }
        for name, part in self.parts.items():
            shifts = {f"{key}_log_shift": value for key, value in part.shift.items()}
            record[name] = {"probability": part.probability, **shifts}
        return record


def _tested(scores: Float[Array, "source parameter"], names: tuple[str, ...]) -> PartTest:
    """Test whether the scores have the mean zero, by Hotelling's statistic."""
    number, count = scores.shape
    mean = scores.mean(axis=0)
    covariance = np.atleast_2d(np.cov(scores.T))
    # The pseudoinverse leaves out a parameter on which nothing depends.
    distance = float(mean @ np.linalg.pinv(covariance, hermitian=True) @ mean)
    statistic = number * distance * (number - count) / (count * (number - 1))
    probability = float(fdtrc(count, number - count, statistic))
    variance = np.diag(covariance)
    shift = np.divide(mean, variance, out=np.zeros(count), where=variance > 0)
    return PartTest(probability, dict(zip(names, map(float, shift), strict=True)))


def _probability_of_mean(values: Float[Array, " source"]) -> float:
    """Return the probability of a mean so far from zero, by Student's distribution; 1 for few galaxies."""
    number = len(values)
    if number < FEWEST_INFORMATION:
        return 1.0
    error = float(np.std(values, ddof=1)) / number**0.5
    if error == 0:
        return 1.0
    return float(2 * stdtr(number - 1, -abs(float(values.mean())) / error))
