"""From a sample and an estimator to the shear, in total and by flux."""

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
"""Rounds of an expansion about the estimate: what is left is of the fourth order in the error of the first round."""

LARGEST = 0.3
"""Largest shear that an expansion is taken about."""

FEWEST = 20
"""Sources that a bin of flux has at least, to have a shear of its own."""

LEAST = 2
"""Sources that a shear needs."""

PART = 64
"""Sources that are worked on at a time."""


def estimate_sample_shear(
    estimator: Estimator,
    sample: Sample,
    executor: Executor = SERIAL,
    meter: Meter | None = None,
) -> ShearEstimate:
    """Shear of a sample, in the frame of the sky, with the shear of each bin of the column ``flux``.

    An estimator that learns does so first, from the whole sample.

    Raises
    ------
    InputError
        Fewer than two sources tell anything of the shear.
    """
    meter = meter or Meter(None)
    if estimator.is_learning:
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
                f"the shear of {len(told)} galaxies that tell anything of it, of {len(sample)} that were chosen;"
                f" {LEAST} or more are needed"
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
    """Terms of every source of a sample in the frame of the sky, expanded about a shear in that frame."""
    parts = [
        sample.select(slice(first, first + PART)) for first in range(0, max(len(sample), 1), PART)
    ]
    found = []
    for part, terms in zip(
        parts, executor.distribute(_terms_of_part, (estimator, about), parts), strict=True
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
    """Return the shear, or one of ``LARGEST`` in its direction: a first estimate of few galaxies may be anything."""
    return shear * min(1.0, LARGEST / max(abs(shear), 1e-12))


def _by_flux(
    estimator: Estimator, sample: Sample, executor: Executor, meter: Meter
) -> Iterator[tuple[str, ShearEstimate]]:
    """Shear of the sources in each bin of the catalogue's flux that has enough of them."""
    if "flux" not in sample.columns:
        return
    for flux_bin in FLUX_BINS:
        inside = flux_bin.holds(sample["flux"])
        if inside.sum() < FEWEST:
            continue
        try:
            found = _estimate(estimator, sample.select(inside), executor, meter)
        except InputError:
            # Galaxies that tell nothing tell nothing together, however many there are.
            continue
        if found.n >= FEWEST:
            yield flux_bin.name, found
