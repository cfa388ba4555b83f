r"""The noise of visibilities, estimated from the visibilities themselves, and compared with their weights.

Every estimate is a median of powers over the variance that the weights imply,

.. math:: \frac{\sigma^2}{\sigma_w^2} = \frac{\mathrm{med}\,\{w |x|^2\}}{2 \ln 2}

where x holds the noise and as little of the sky as possible:

- the difference of the two parallel hands, in which an unpolarised sky is absent;
- the residual of the fitted sky, and the differences of successive integrations and of neighbouring channels in it;
- the differences of successive integrations and of neighbouring channels in the data.

A sky that is left in x raises an estimate, and nothing lowers it, except that neighbouring channels whose noise is
correlated (Hanning smoothing) differ too little. The smallest estimate is therefore nearest to the noise. Whether it is
the noise, or no more than an upper limit, is part of the result.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Final

import numpy as np

from uvshear.interferometer.accumulate import accumulate
from uvshear.interferometer.noise_sample import NoiseSample, NoiseSampleAccumulator
from uvshear.interferometer.samples import Samples
from uvshear.interferometer.visibilities import Observation
from uvshear.typing import Array, Complex, Float

FEWEST: Final = 100
"""Number of powers below which no estimate is made."""

WEIGHTS_OFF: Final = 0.05
"""Fraction by which the noise may differ from what the weights claim without a warning. Weights that are 20 per cent
off imply a noise that is 10 per cent off."""

CLEAR: Final = 3.0
"""Number of standard errors by which an estimate must be beyond a limit."""

ALIKE: Final = 0.1
"""Fraction by which estimates of the same noise may differ where noise alone is left in a residual. Sources that are
missing from the model raise them by different fractions."""

COPIES: Final = 0.5
"""Hands are not independent if their difference has less than this fraction of the noise that the weights claim, and of
the noise that anything else shows: some simulators and converters write copies of Stokes I, or the same noise, into
both."""

TAIL: Final = 0.9
"""Quantile of the powers, besides the median, that is looked at: the powers of a bright source that is missing from the
model are not distributed like those of noise."""

Predict = Callable[[Samples], Complex[Array, " sample"]]
"""Function that predicts the visibilities of a sky [Jy]."""


@dataclass(frozen=True)
class Scatter:
    """One estimate of the noise.

    Parameters
    ----------
    ratio
        Standard deviation over the one that the weights imply.
    error
        Standard error of the ratio.
    origin
        Words for what was looked at.
    """

    ratio: float
    error: float
    origin: str

    @classmethod
    def from_powers(
        cls, powers: Float[Array, " drawn"], origin: str, quantile: float = 0.5
    ) -> "Scatter":
        """Estimate the noise from powers over their variance; the median unless another quantile is given.

        The error of a quantile p of N exponentially distributed numbers is sqrt(p/(1 - p)/N) times their mean.
        """
        level = -math.log(1 - quantile)
        ratio = math.sqrt(float(np.quantile(powers, quantile)) / (2 * level))
        relative = math.sqrt(quantile / (1 - quantile) / len(powers)) / level / 2
        return cls(ratio, ratio * relative, origin)

    def is_alike(self, other: "Scatter") -> bool:
        """Whether two estimates may be those of the same noise."""
        allowed = ALIKE * min(self.ratio, other.ratio)
        return abs(self.ratio - other.ratio) < allowed + CLEAR * math.hypot(self.error, other.error)


@dataclass(frozen=True)
class NoiseEstimate:
    """The noise of an observation over the noise that its weights imply.

    Parameters
    ----------
    smallest
        The smallest estimate.
    is_certain
        Whether the noise is known. If not, the smallest estimate is an upper limit, which sources may have raised.
    contradicting
        An estimate from the residual of the fitted sky that disagrees, where the noise is not known for this reason.
    """

    smallest: Scatter
    is_certain: bool
    contradicting: Scatter | None = None

    @property
    def ratio(self) -> float:
        """The smallest estimate."""
        return self.smallest.ratio

    def is_near(self, claimed: float = 1.0) -> bool:
        """Whether the smallest estimate agrees with a claimed noise."""
        return not (self.exceeds(claimed) or self.is_below(claimed))

    def is_below(self, claimed: float = 1.0) -> bool:
        """Whether the noise is clearly smaller than a claimed one; an upper limit is enough to tell."""
        return self.ratio < claimed * (1 - WEIGHTS_OFF) - CLEAR * self.smallest.error

    def exceeds(self, claimed: float = 1.0) -> bool:
        """Whether the smallest estimate is clearly larger than a claimed noise."""
        return self.ratio > claimed * (1 + WEIGHTS_OFF) + CLEAR * self.smallest.error


def estimate_noise(
    sample: NoiseSample, predict: Predict | None = None, claimed: float = 1.0
) -> NoiseEstimate | None:
    """Estimate the noise; None where there are too few samples.

    Without two independent hands the noise is known where the estimates agree with one another, or where they agree
    with the claim that the weights make.

    Parameters
    ----------
    sample
        Visibilities with their neighbours.
    predict
        Function that predicts the fitted sky, whose residual is then looked at; without it, only the data are.
    claimed
        Ratio that is found if the weights are right as they came with the data: 1 unless they were scaled since.
    """
    hands = _scatter(sample.hand_powers, "the difference of the two parallel hands")
    data = _Differences.from_sample(sample, tuple(part.stokes_i for part in _parts(sample)), "")
    left = _Residual() if predict is None else _Residual.from_sample(sample, predict)
    others = _known(data.in_time, left.whole, left.differences.in_time)
    channels = _known(data.in_frequency, left.differences.in_frequency)
    if hands is not None and not _are_copies(hands, others, claimed):
        return NoiseEstimate(_least(hands, *others), is_certain=True)
    if left.whole is None:
        return _upper_limit(others, channels, claimed)
    found = NoiseEstimate(_least(*others), is_certain=True)
    if found.is_near(claimed):
        return found
    across = NoiseEstimate(_least(*channels), is_certain=True) if channels else found
    if found.exceeds(claimed) and across.is_near(claimed):
        return across
    unlike = [scatter for scatter in left.every if not scatter.is_alike(found.smallest)]
    if not unlike:
        return found
    least = _least(found.smallest, across.smallest)
    contradicting = max(unlike, key=lambda scatter: _factor_between(scatter.ratio, least.ratio))
    return NoiseEstimate(least, is_certain=False, contradicting=contradicting)


def _factor_between(first: float, second: float) -> float:
    """Return the larger of two ratios over the smaller; infinite where one, as of data that are all zero, is 0."""
    smaller, larger = sorted((first, second))
    return larger / smaller if smaller > 0 else math.inf


def noise_over_weights(observation: Observation) -> NoiseEstimate | None:
    """Read the start of an observation, and estimate its noise without knowledge of the sky."""
    sample: NoiseSample | None
    (sample,) = accumulate(observation, [NoiseSampleAccumulator()])
    return None if sample is None else estimate_noise(sample)


@dataclass(frozen=True)
class _Differences:
    """Estimates from the differences of neighbours; None where there are too few."""

    in_time: Scatter | None = None
    in_frequency: Scatter | None = None

    @classmethod
    def from_sample(
        cls, sample: NoiseSample, values: Sequence[Complex[Array, " sample"]], where: str
    ) -> "_Differences":
        here, later, beside = values
        between = _difference_powers(sample.here, sample.later, later - here)
        across = _difference_powers(sample.here, sample.beside, beside - here)
        return cls(
            _scatter(between, f"the differences of successive integrations{where}"),
            _scatter(across, f"the differences of neighbouring channels{where}"),
        )


@dataclass(frozen=True)
class _Residual:
    """Estimates from the residual of the fitted sky, which agree with one another if nothing but noise is left."""

    whole: Scatter | None = None
    shorter: Scatter | None = None
    longer: Scatter | None = None
    tail: Scatter | None = None
    differences: _Differences = field(default_factory=_Differences)

    @classmethod
    def from_sample(cls, sample: NoiseSample, predict: Predict) -> "_Residual":
        values = tuple(_left(part, predict) for part in _parts(sample))
        powers = np.abs(values[0]).astype(float) ** 2 * sample.here.weights
        distance = sample.here.uv_distance
        is_short = distance < np.median(distance) if len(distance) else np.zeros(0, bool)
        words = "the residual of the fitted sky"
        return cls(
            whole=_scatter(powers, words),
            shorter=_scatter(powers[is_short], f"{words} on the shorter half of the baselines"),
            longer=_scatter(powers[~is_short], f"{words} on the longer half of the baselines"),
            tail=_scatter(powers, f"the largest tenth of {words}", TAIL),
            differences=_Differences.from_sample(sample, values, f" in {words}"),
        )

    @property
    def every(self) -> list[Scatter]:
        between = self.differences
        return _known(
            self.whole, self.shorter, self.longer, self.tail, between.in_time, between.in_frequency
        )


def _upper_limit(
    others: Sequence[Scatter], channels: Sequence[Scatter], claimed: float
) -> NoiseEstimate | None:
    """Return the smallest of the estimates that a sky may have raised."""
    if not (others or channels):
        return None
    every = NoiseEstimate(_least(*others, *channels), is_certain=False)
    if not others:
        return every
    found = NoiseEstimate(_least(*others), is_certain=False)
    # Smoothed channels differ too little: they alone do not tell that there is less noise than the weights claim.
    return found if every.is_below(claimed) and not found.is_below(claimed) else every


def _are_copies(hands: Scatter, others: Sequence[Scatter], claimed: float) -> bool:
    if hands.ratio == 0:
        return True
    least = min((scatter.ratio for scatter in others), default=0.0)
    return hands.ratio < COPIES * min(least, claimed)


def _parts(sample: NoiseSample) -> tuple[Samples, Samples, Samples]:
    return sample.here, sample.later, sample.beside


def _left(samples: Samples, predict: Predict) -> Complex[Array, " sample"]:
    """Return the residual of a prediction, which is 0 for samples without weight."""
    residual = np.zeros(len(samples), complex)
    used = np.flatnonzero(samples.weights > 0)
    if len(used):
        part = samples.select(used)
        residual[used] = part.stokes_i - predict(part)
    return residual


def _difference_powers(
    first: Samples, second: Samples, difference: Complex[Array, " sample"]
) -> Float[Array, " pair"]:
    both = (first.weights > 0) & (second.weights > 0)
    variance = 1 / first.weights[both].astype(float) + 1 / second.weights[both]
    return np.abs(difference[both]).astype(float) ** 2 / variance


def _scatter(powers: Float[Array, " drawn"], origin: str, quantile: float = 0.5) -> Scatter | None:
    return Scatter.from_powers(powers, origin, quantile) if len(powers) >= FEWEST else None


def _known(*scatters: Scatter | None) -> list[Scatter]:
    return [scatter for scatter in scatters if scatter is not None]


def _least(*scatters: Scatter) -> Scatter:
    return min(scatters, key=_ratio)


def _ratio(scatter: Scatter) -> float:
    return scatter.ratio
