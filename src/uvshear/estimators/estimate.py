"""The shear of a sample by an estimator, in total and by flux."""

from collections.abc import Iterator
from dataclasses import replace

from uvshear.errors import InputError
from uvshear.estimators.estimator import Estimator
from uvshear.estimators.flux_bins import FLUX_BINS
from uvshear.estimators.sample import Sample
from uvshear.estimators.shear_estimate import ShearEstimate
from uvshear.estimators.terms import Terms, shear_in_field_frame
from uvshear.estimators.uncertainty import ratio
from uvshear.execution import SERIAL, Executor
from uvshear.progress import Meter

ROUNDS = 3
"""Iterations of the expansion about the estimate; the remaining error is of fourth order in that of the first."""

LARGEST = 0.3
"""Largest shear about which an expansion is taken."""

FEWEST = 20
"""Smallest number of sources in a bin of flux for which a shear is reported."""

LEAST = 2
"""Smallest number of sources from which a shear is estimated."""

PART = 64
"""Number of sources in one task of the executor."""


def estimate_sample_shear(
    estimator: Estimator,
    sample: Sample,
    executor: Executor = SERIAL,
    meter: Meter | None = None,
) -> ShearEstimate:
    """Estimate the shear of a sample in the frame of the sky, in total and in bins of the column ``flux``.

    An estimator that learns from the sample is first trained on all of it.

    Raises
    ------
    InputError
        Fewer than two sources contribute to the shear, or the estimator should have been trained before the
        measurement.
    """
    meter = meter or Meter(None)
    if estimator.is_learning:
        if estimator.learner is not estimator:
            raise InputError(
                f"the estimator '{estimator.name}' wraps '{estimator.learner.name}', which learns from a sample; this"
                f" must happen before the measurement, because the statistics depend on it"
            )
        first = _estimate(estimator, sample, executor, meter)
        estimator = estimator.trained(sample, first.shear, meter)
    total = _estimate(estimator, sample, executor, meter)
    bins = dict(_by_flux(estimator, sample, executor, meter))
    return replace(total, bins=bins, assumed=estimator.record())


def _estimate(
    estimator: Estimator, sample: Sample, executor: Executor, meter: Meter
) -> ShearEstimate:
    rounds = ROUNDS if estimator.is_expanded else 1
    meter.expect(rounds * len(sample))
    about = 0j
    for number in range(1, rounds + 1):
        terms = sky_terms(estimator, sample, about, executor, meter)
        told = terms.select(terms.tells)
        if len(told) < LEAST:
            raise InputError(
                f"the shear of {len(sample)} galaxies, of which {len(told)} contribute to it; {LEAST} or more such"
                f" galaxies are needed"
            )
        found = ratio(told)
        if number < rounds:
            about = within_reach(about + complex(*found))
    error = estimator.uncertainty.error(told)
    shear = about + complex(*found)
    return ShearEstimate(
        g1=shear.real,
        g1_err=float(error[0]),
        g2=shear.imag,
        g2_err=float(error[1]),
        n=len(told),
        estimator=estimator.name,
    )


def sky_terms(
    estimator: Estimator,
    sample: Sample,
    about: complex,
    executor: Executor = SERIAL,
    meter: Meter | None = None,
) -> Terms:
    """Return the terms of every source in the frame of the sky, expanded about a shear in that frame."""
    parts = [
        sample.select(slice(first, first + PART)) for first in range(0, max(len(sample), 1), PART)
    ]
    # A single part is not worth a process of its own.
    runner = executor if len(parts) > 1 else SERIAL
    found = []
    for part, terms in zip(
        parts, runner.distribute(_terms_of_part, (estimator, about), parts), strict=True
    ):
        found.append(terms)
        if meter is not None:
            meter.add(len(part))
    return Terms.joined(found)


def _terms_of_part(setting: tuple[Estimator, complex], part: Sample) -> Terms:
    estimator, about = setting
    local = shear_in_field_frame(about, part.local_north)
    return estimator.terms(part, local).in_sky_frame(part.local_north)


def within_reach(shear: complex) -> complex:
    """Return the shear, or one of modulus ``LARGEST`` in its direction: the shear of few galaxies may be larger."""
    return shear * min(1.0, LARGEST / max(abs(shear), 1e-12))


def _by_flux(
    estimator: Estimator, sample: Sample, executor: Executor, meter: Meter
) -> Iterator[tuple[str, ShearEstimate]]:
    """Yield the shear of the sources in each bin of the catalogue's flux that has enough of them."""
    if "flux" not in sample.columns:
        return
    for flux_bin in FLUX_BINS:
        inside = flux_bin.holds(sample["flux"])
        if inside.sum() < FEWEST:
            continue
        try:
            found = _estimate(estimator, sample.select(inside), executor, meter)
        except InputError:
            # Too few of them contribute to the shear.
            continue
        if found.n >= FEWEST:
            yield flux_bin.name, found
