"""Baselines that take part, and what those left out would have told."""

import math
from dataclasses import replace

import numpy as np
import pytest

from tests.skies import galaxies
from uvshear.constants import MICROJANSKY, SPEED_OF_LIGHT
from uvshear.extraction.converged.baselines import Baselines
from uvshear.extraction.field import Field
from uvshear.galaxy import SizeFluxRelation
from uvshear.geometry.directions import PhaseCentre
from uvshear.interferometer.coverage import Track, synthesise
from uvshear.interferometer.layout import load_layout
from uvshear.interferometer.samples import Samples
from uvshear.interferometer.summary import ObservationSummary
from uvshear.interferometer.uv_range import UvRange
from uvshear.shapes.measurement import FitFlag

FREQUENCY = 1.07e9
NOTHING = np.zeros(0)
NOBODY = Samples(
    np.zeros((0, 3)), NOTHING + 0j, NOTHING, NOTHING, NOTHING, NOTHING, np.zeros((0, 2), int)
)


def _field(flux, uv_range):
    """Only what the choice looks at."""
    flux = np.asarray(flux) * MICROJANSKY
    count = len(flux)
    summary = ObservationSummary(1, 1, uv_range.maximum, FREQUENCY, FREQUENCY, 1.0, NOBODY)
    size = SizeFluxRelation().prior(flux)
    nowhere = np.zeros(count)
    sky = galaxies(nowhere, nowhere, flux, np.exp(size.log_median), nowhere + 0j)
    flags = np.full(count, FitFlag.OK, dtype=object)
    every = np.arange(count)
    return Field(
        nowhere, nowhere, sky, size, every, flags, uv_range, summary, nowhere, nowhere, nowhere + 1
    )


def _chosen(flux=(10.0, 50.0, 200.0), longest=5e5, shortest=None, uv_min=0.0, stars=False):
    field = _field(flux, UvRange(uv_min, longest))
    return Baselines.from_field(field, np.full(len(flux), not stars), shortest)


def test_the_galaxies_of_a_survey_need_no_baseline_below_3000_wavelengths():
    assert 2500 < _chosen().shortest < 3500


def test_one_giant_among_many_galaxies_does_not_bring_the_short_baselines_back():
    many = np.full(300, 100.0)
    assert _chosen(many).shortest == pytest.approx(_chosen([*many, 1e5]).shortest, rel=1e-6)


def test_a_shortest_baseline_that_is_asked_for_is_taken():
    assert _chosen(shortest=0.0).shortest == 0
    assert _chosen(shortest=0.0, uv_min=700.0).shortest == 700
    assert _chosen(uv_min=5e3).shortest == 5e3


def test_an_array_that_hardly_resolves_its_galaxies_loses_the_shortest_alone():
    chosen = _chosen(longest=2e4)
    assert chosen.shortest == pytest.approx(2e4 / 50)
    assert chosen.finest == pytest.approx(4e4)


def test_stars_alone_take_every_baseline():
    chosen = _chosen(stars=True)
    assert chosen.shortest == 0
    assert np.all(chosen.uv_max == 5e5)


def _array_with_a_gap(lengths=(173.0,), numbers=(60,)):
    """Two thousand baselines of 2785 to 1e5 wavelengths, and few short ones."""
    rng = np.random.default_rng(1)
    length = np.concatenate(
        [
            np.geomspace(2785, 1e5, 2000),
            *(np.full(n, x) for x, n in zip(lengths, numbers, strict=True)),
        ]
    )
    angle = rng.uniform(0, np.pi, len(length))
    none = np.zeros(len(length))
    uvw = np.column_stack([length * np.cos(angle), length * np.sin(angle), none])
    antennas = np.zeros((len(length), 2), int)
    return Samples(uvw, none + 0j, none + 1e9, none + FREQUENCY, none, none, antennas)


def test_few_short_baselines_beyond_a_gap_are_used_for_what_they_tell_of_fluxes():
    field = _field((1e4, 3e4), UvRange(0.0, 1e5))
    with_probes = replace(field, summary=replace(field.summary, probes=_array_with_a_gap()))
    every = np.full(2, True)
    usual, chosen = (Baselines.from_field(f, every, None) for f in (field, with_probes))
    assert usual.shortest > 173
    assert (chosen.shortest, chosen.limit) == (0.0, usual.shortest)
    fewer = chosen.without_short_ones()
    assert (fewer.shortest, fewer.limit) == (usual.shortest, 0.0)
    assert fewer.longest == chosen.longest
    # asked for, nothing is chosen
    assert Baselines.from_field(with_probes, every, 250.0).shortest == 250
    assert Baselines.from_field(with_probes, every, 250.0).limit == 0


def test_many_short_baselines_are_still_left_out():
    field = _field((1e4, 3e4), UvRange(0.0, 1e5))
    lengths = np.linspace(150, 2785, 60)
    dense = _array_with_a_gap(lengths, np.full(60, 30))
    with_probes = replace(field, summary=replace(field.summary, probes=dense))
    chosen = Baselines.from_field(with_probes, np.full(2, True), None)
    assert chosen.shortest == Baselines.from_field(field, np.full(2, True), None).shortest


def _disc(e, alpha, uv):
    """Transform of an exponential disc stretched along l."""
    stretched = uv / np.array([[1 - e], [1 + e]])
    return (1 + (2 * np.pi * alpha) ** 2 * np.sum(stretched**2, axis=0)) ** -1.5


@pytest.mark.parametrize(
    ("flux", "of_median", "of_large"), [(10.0, 1e-3, 8e-3), (50.0, 6e-3, 5e-2), (200.0, 3e-2, 0.2)]
)
def test_what_is_left_out_tells_hardly_anything_of_shapes(flux, of_median, of_large):
    """Share of the Fisher information on e of the median galaxy, and of one 2 sigma larger, for SKA-Mid."""
    track = Track.from_clock(PhaseCentre(0.3, math.radians(-30)), ((-14400.0, 14400.0),), 3600.0)
    uvw = synthesise(load_layout("ska-mid-aa4"), track).uvw
    uv = uvw[:, :2].T * FREQUENCY / SPEED_OF_LIGHT
    kept = np.hypot(*uv) >= _chosen().shortest
    prior = SizeFluxRelation().prior(np.array([flux * MICROJANSKY]))
    for sigmas, most in ((0.0, of_median), (2.0, of_large)):
        alpha = float(np.exp(prior.log_median[0] + sigmas * prior.sigma[0]))
        ahead, behind = (_disc(0.3 + step, alpha, uv) for step in (1e-3, -1e-3))
        information = (ahead - behind) ** 2
        share = information[~kept].sum() / information.sum()
        assert most / 5 < share < most
