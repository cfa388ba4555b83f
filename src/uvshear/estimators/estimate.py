"""The shear of a sample by an estimator, in total and by flux."""

import cmath
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from uvshear.errors import InputError
from uvshear.estimators.estimator import Estimator
from uvshear.estimators.flux_bins import FLUX_BINS
from uvshear.estimators.goodness import PopulationGoodness
from uvshear.estimators.population_fit import FORESEEN
from uvshear.estimators.sample import Sample
from uvshear.estimators.shear_estimate import ShearEstimate
from uvshear.estimators.terms import Terms, shear_in_field_frame
from uvshear.estimators.uncertainty import ratio, ratio_error
from uvshear.execution import SERIAL, Executor
from uvshear.progress import Meter, Stage
from uvshear.typing import Array, Bool, Float, Int

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

    An estimator that fits its population to the sample is first trained on all of it.

    Raises
    ------
    InputError
        Fewer than two sources contribute to the shear, or the estimator should have been trained before the
        measurement.
    """
    meter = meter or Meter(None)
    rounds, count = ROUNDS if estimator.is_expanded else 1, len(sample)
    # Work is counted in galaxies. All bins together hold about as many as the sample.
    guess = Stage("first estimate", rounds * count, unit="galaxies", kind="terms")
    population = Stage("population", FORESEEN * count, unit="galaxies", kind="population")
    final = Stage("shear", (2 * rounds - 1) * count, unit="galaxies", kind="terms")
    if estimator.is_learning:
        meter.begin(guess, population, final)
        if estimator.learner is not estimator:
            raise InputError(
                f"the estimator '{estimator.name}' wraps '{estimator.learner.name}' with a population that is yet to be"
                " fitted, and the stored statistics depend on that population; fit it first, and measure again with the"
                " fitted population"
            )
        ((first, _),) = _estimates(estimator, sample, [slice(None)], executor, meter)
        meter.begin(population, final)
        estimator = estimator.trained(sample, _known(first, sample).shear, meter)
    meter.begin(final)
    masks = _bins(sample)
    (total, terms), *parts = _estimates(
        estimator, sample, [slice(None), *masks.values()], executor, meter
    )
    bins = {
        name: part
        for name, (part, _) in zip(masks, parts, strict=True)
        if part is not None and part.n >= FEWEST
    }
    found = _known(total, sample)
    scores = _scores(estimator, sample, found.shear, executor, meter)
    return replace(
        found,
        bins={name: part for name, part in bins.items() if part.is_determined},
        assumed=estimator.record(),
        goodness=None if scores is None else PopulationGoodness.from_terms(terms, scores),
    ).with_remarks(bins)


def _known(estimate: ShearEstimate | None, sample: Sample) -> ShearEstimate:
    if estimate is None:
        raise InputError(
            f"of {len(sample)} selected galaxies, fewer than {LEAST} contribute to the shear; {LEAST} or more are"
            " needed that were measured, pass the cuts and have statistics for the estimator"
        )
    if not cmath.isfinite(estimate.shear):
        raise InputError(
            f"the responses of {estimate.n} galaxies to a shear add up to zero, so that they do not determine a shear;"
            " more galaxies or another estimator are needed"
        )
    return estimate


def _bins(sample: Sample) -> dict[str, Bool[Array, " source"]]:
    """Return the masks of the bins of flux that have enough sources."""
    if "flux" not in sample.columns:
        return {}
    inside = {flux_bin.name: flux_bin.holds(sample["flux"]) for flux_bin in FLUX_BINS}
    return {name: mask for name, mask in inside.items() if mask.sum() >= FEWEST}


def _estimates(
    estimator: Estimator,
    sample: Sample,
    groups: Sequence[Bool[Array, " source"] | slice],
    executor: Executor,
    meter: Meter,
) -> list[tuple[ShearEstimate | None, Terms]]:
    """Estimate the shear of each group of sources; None for a group to which fewer than ``LEAST`` contribute.

    The terms of the group come with it.
    """
    members = [sample.select(group) for group in groups]
    further = ROUNDS - 1 if estimator.is_expanded else 0
    meter.expect(len(sample) + further * sum(map(len, members)))
    # About zero shear, the terms of a group are among those of the sample.
    everyone = sky_terms(estimator, sample, 0j, executor, meter)
    terms = [everyone.select(group) for group in groups]
    about = [0j] * len(groups)
    for _ in range(further):
        about = [
            within_reach(_shear(each, expansion))
            for each, expansion in zip(terms, about, strict=True)
        ]
        terms = _terms_about(estimator, members, about, executor, meter)
    return [
        (_estimate(estimator, each, g, group.patch), each)
        for each, g, group in zip(terms, about, members, strict=True)
    ]


def _shear(terms: Terms, about: complex) -> complex:
    """Return the shear from terms that are expanded about another one, or that one if too few sources contribute."""
    contributing = terms.select(terms.tells)
    if len(contributing) < LEAST:
        return about
    shear = about + complex(*ratio(contributing))
    return shear if cmath.isfinite(shear) else about


def _estimate(
    estimator: Estimator, terms: Terms, about: complex, patch: Int[Array, " source"] | None
) -> ShearEstimate | None:
    contributing = terms.select(terms.tells)
    if len(contributing) < LEAST:
        return None
    if patch is not None:
        patch = patch[terms.tells]
        if len(np.unique(patch)) < LEAST:
            return None
    shear = about + complex(*ratio(contributing))
    error = ratio_error(contributing, patch)
    return ShearEstimate(
        g1=shear.real,
        g1_err=float(error[0]),
        g2=shear.imag,
        g2_err=float(error[1]),
        n=len(contributing),
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
    (terms,) = _terms_about(estimator, [sample], [about], executor, meter or Meter(None))
    return terms


def _terms_about(
    estimator: Estimator,
    samples: Sequence[Sample],
    about: Sequence[complex],
    executor: Executor,
    meter: Meter,
) -> list[Terms]:
    """Return the terms of several samples, each expanded about a shear of its own; all are divided into tasks."""
    tasks, owner = [], []
    for number, (sample, shear) in enumerate(zip(samples, about, strict=True)):
        for first in range(0, len(sample), PART):
            tasks.append((sample.select(slice(first, first + PART)), shear))
            owner.append(number)
    # A single task is not worth a process of its own.
    runner = executor if len(tasks) > 1 else SERIAL
    found: list[list[Terms]] = [[] for _ in samples]
    results = runner.distribute(_terms_of_part, estimator, tasks)
    for number, (part, _), terms in zip(owner, tasks, results, strict=True):
        found[number].append(terms)
        meter.add(len(part))
    return [Terms.joined(parts) for parts in found]


def _terms_of_part(estimator: Estimator, task: tuple[Sample, complex]) -> Terms:
    part, about = task
    local = shear_in_field_frame(about, part.local_north)
    return estimator.terms(part, local).in_sky_frame(part.local_north)


def _scores(
    estimator: Estimator, sample: Sample, about: complex, executor: Executor, meter: Meter
) -> Float[Array, "source parameter"] | None:
    """Return the scores of the assumed population for every source; None if the estimator assumes none."""
    if estimator.scores(sample.select(slice(0)), np.zeros(0, complex)) is None:
        return None
    meter.expect(len(sample))
    shear = within_reach(about)
    parts = [sample.select(slice(first, first + PART)) for first in range(0, len(sample), PART)]
    runner = executor if len(parts) > 1 else SERIAL
    found = []
    for scores in runner.distribute(_scores_of_part, estimator, [(part, shear) for part in parts]):
        found.append(scores)
        meter.add(len(scores))
    return np.concatenate(found)


def _scores_of_part(
    estimator: Estimator, task: tuple[Sample, complex]
) -> Float[Array, "source parameter"]:
    part, about = task
    scores = estimator.scores(part, shear_in_field_frame(about, part.local_north))
    if scores is None:
        raise TypeError(f"the estimator '{estimator.name}' has scores of no source, but not of all")
    return scores


def within_reach(shear: complex) -> complex:
    """Return the shear, or one of modulus ``LARGEST`` in its direction: the shear of few galaxies may be larger."""
    return shear * min(1.0, LARGEST / max(abs(shear), 1e-12))
