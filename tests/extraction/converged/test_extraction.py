"""All sources of a field together: what the catalogue has right, and what it has wrong."""

import tracemalloc
from dataclasses import dataclass, replace

import numpy as np
import pytest

from tests.extraction.fields import extract, field_of, measure
from tests.progress.heard import Heard
from tests.skies import galaxies, vla
from uvshear.constants import ARCMIN, ARCSEC
from uvshear.estimators.bayesian import Bayesian
from uvshear.estimators.metacal import Metacal
from uvshear.estimators.moments import Moments
from uvshear.execution import SERIAL, Copies, Resources
from uvshear.extraction import ConvergedExtraction, MeasurementOptions, Method, Model
from uvshear.extraction.converged import extraction as converged
from uvshear.extraction.converged import major_cycle
from uvshear.galaxy import CatalogueSize
from uvshear.interferometer.visibilities import Visibilities, VisibilitySet
from uvshear.io.catalogue import catalogue_from_galaxies
from uvshear.predict import gridded, predict_visibilities
from uvshear.shapes.measurement import FitFlag

FREQUENCY = np.array([1.35e9, 1.45e9])
SIGMA = 1e-4
OPTIONS = MeasurementOptions(Model(size=CatalogueSize()), resources=Resources(SERIAL))

SKY = galaxies(
    l=np.array([0.0, 1.5, -1.5, -1.0, 2.5, 0.25]) * ARCMIN,
    m=np.array([0.0, 2.0, 1.0, 1.2, -2.0, 0.05]) * ARCMIN,
    flux=np.array([1.0, 2.0, 2.0, 0.7, 0.5, 0.6]) * 1e-3,
    alpha=np.array([2.0, 2.2, 2.5, 1.8, 1.6, 2.0]) * ARCSEC,
    e=np.array([0.3, 0.1j, -0.2 + 0.4j, -0.3j, 0.1 + 0.2j, -0.3]),
)
"""The last stands 15 arcsec from the first: three beams, and seven scale lengths."""


@pytest.fixture(scope="module")
def array():
    return vla("b", samples=6)


def _observe(sky, array, seed=3, sigma=SIGMA):
    uvw, centre = array
    vis = predict_visibilities(sky, uvw, FREQUENCY)
    noise = np.random.default_rng(seed).normal(size=(2, *vis.shape))
    vis += sigma * (noise[0] + 1j * noise[1])
    weights = np.full(vis.shape, sigma**-2)
    return VisibilitySet(centre, (Visibilities(uvw, FREQUENCY, vis, weights),))


def _joined(first, second):
    names = ("l", "m", "flux", "scale_length", "ellipticity", "spectral_index")
    pairs = {n: np.concatenate([getattr(first, n), getattr(second, n)]) for n in names}
    return replace(first, **pairs)


def _pulls(shapes, sky):
    e = sky.ellipticity
    first = (shapes["e1"] - e.real) / shapes["e1_err"]
    return np.abs(np.stack([first, (shapes["e2"] - e.imag) / shapes["e2_err"]]))


def _flags(shapes):
    return shapes["flag"].tolist()


@pytest.fixture(scope="module")
def shapes(array):
    observation = _observe(SKY, array)
    return measure(observation, catalogue_from_galaxies(SKY, array[1]), OPTIONS)


def test_every_galaxy_of_a_field_is_measured_within_its_error(shapes):
    assert _flags(shapes) == ["ok"] * len(SKY)
    # 12 numbers; a wrong sign of a neighbour's subtraction is tens of errors
    assert np.max(_pulls(shapes, SKY)) < 4


def test_the_metadata_tell_that_the_sky_has_converged(shapes):
    record = shapes.meta
    assert record["extraction"] == "converged"
    assert record["major_cycles"] == len(record["minor_cycles"]) == len(record["change_max"])
    assert record["left_undone"] < ConvergedExtraction().tolerance
    assert record["change_max"][-1] < record["change_max"][0]


def test_threads_change_no_bit(array, shapes):
    catalogue = catalogue_from_galaxies(SKY, array[1])
    again = measure(
        _observe(SKY, array), catalogue, replace(OPTIONS, resources=Resources(Copies(3)))
    )
    for name in ("e1", "e2", "e1_err", "flux_fit", "dl"):
        assert np.array_equal(again[name], shapes[name])


def test_memory_threads_and_chunks_change_no_bit_of_shapes_and_statistics(array, monkeypatch):
    """Several blocks of samples. With blocks that follow the memory e moves by 1e-4 of its error."""
    monkeypatch.setattr(gridded, "BLOCK", 1000)
    observation = _observe(SKY, array, seed=4)
    chunk = observation.blocks[0]
    rows = np.array_split(np.arange(len(chunk)), 7)
    parts = tuple(
        Visibilities(chunk.uvw[r], FREQUENCY, chunk.stokes_i[r], chunk.weights[r]) for r in rows
    )
    assert 2 * len(chunk) > 4 * gridded.BLOCK
    catalogue = catalogue_from_galaxies(SKY, array[1])
    kept = (Moments(), Metacal(), Bayesian())
    first, second = (
        extract(seen, catalogue, replace(OPTIONS, resources=resources, keep=estimators))
        for seen, resources, estimators in (
            (observation, Resources(SERIAL, 64e9), kept),
            (VisibilitySet(array[1], parts), Resources(Copies(3), 1e6), kept),
        )
    )
    assert sorted(first.kept) == list(range(len(SKY)))
    for source, shape in first.measurements.items():
        other = second.measurements[source]
        assert np.array_equal(other.ellipticity, shape.ellipticity)
        assert np.array_equal(other.covariance, shape.covariance)
        assert (other.flux, other.snr) == (shape.flux, shape.snr)
        numbers, others = first.kept[source], second.kept[source]
        assert numbers.keys() == others.keys()
        for name, value in numbers.items():
            assert np.array_equal(others[name], value), name
        assert {numbers[f"flag_{each.name}"] for each in kept} == {"ok"}


def test_a_disc_of_25_arcsec_takes_neither_the_memory_nor_the_shapes_of_the_others(array, shapes):
    """The width of its facet would give moments and metacalibration 2e5 and 1e5 unknowns."""
    disc = galaxies(l=-2 * ARCMIN, m=-1.5 * ARCMIN, flux=4e-3, alpha=25 * ARCSEC, e=0.2 + 0.1j)
    sky = _joined(SKY, disc)
    estimators = (Moments(), Metacal(), Bayesian())
    options = replace(OPTIONS, resources=Resources(SERIAL, 1e8), keep=estimators)
    tracemalloc.start()
    extracted = extract(_observe(sky, array), catalogue_from_galaxies(sky, array[1]), options)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 0.5e9  # measured 0.05e9
    for source in range(len(SKY)):
        shape = extracted.measurements[source]
        for e, name in zip(shape.ellipticity, ("e1", "e2"), strict=True):
            # measured 0.02
            assert abs(e - shapes[name][source]) < 0.1 * shapes[f"{name}_err"][source]
        assert all(extracted.kept[source][f"flag_{each.name}"] == "ok" for each in estimators)
    measured, kept = extracted.measurements[len(SKY)], extracted.kept[len(SKY)]
    assert measured.flag is FitFlag.OK
    assert abs(complex(*measured.ellipticity) - (0.2 + 0.1j)) < 4 * measured.e_sigma
    assert kept["flag_moments"] == kept["flag_metacal"] == "too_large"
    assert "m1" not in kept
    assert "mc1" not in kept


def test_a_source_that_is_there_twice_is_left_out_once(array, shapes):
    twice = _joined(SKY, replace(SKY.select(np.array([1])), flux=np.array([1e-3])))
    table = measure(_observe(SKY, array), catalogue_from_galaxies(twice, array[1]), OPTIONS)
    assert _flags(table) == ["ok"] * len(SKY) + ["duplicate"]
    assert np.array_equal(table["e1"][:-1], shapes["e1"])


def test_a_neighbour_that_the_catalogue_lacks_is_told(array):
    known = SKY.select(np.arange(len(SKY) - 1))
    near = galaxies(
        l=known.l[0] + 6 * ARCSEC, m=known.m[0] + 4 * ARCSEC, flux=4e-4, alpha=1.5 * ARCSEC
    )
    observation = _observe(_joined(known, near), array)
    lacking = measure(observation, catalogue_from_galaxies(known, array[1]), OPTIONS)
    assert lacking["flag"][0] == "contaminated"
    complete = catalogue_from_galaxies(_joined(known, near), array[1])
    assert measure(observation, complete, OPTIONS)["flag"][0] == "ok"


def test_a_star_a_thousand_times_as_bright_near_the_edge_leaves_the_galaxies_alone(array):
    star = galaxies(l=5 * ARCMIN, m=4 * ARCMIN, flux=1.0, alpha=0.0)
    sky = _joined(SKY, star)
    believed = replace(sky, flux=sky.flux * np.where(sky.flux == 1.0, 1.02, 1.0))
    catalogue = catalogue_from_galaxies(believed, array[1])
    points = replace(
        catalogue,
        scale_length=np.where(sky.scale_length == 0, 2 * ARCSEC, sky.scale_length),
        is_point=sky.scale_length == 0,
    )
    table = measure(_observe(sky, array), points, OPTIONS)
    assert table["flag"][-1] == "point_source"
    assert _flags(table)[:-1] == ["ok"] * len(SKY)
    # two per cent of a jansky left in the sky would be 200 times the noise of a visibility
    assert np.max(_pulls(table[:-1], SKY)) < 4


def test_sources_keep_their_own_spectral_indices(array):
    sky = replace(SKY, spectral_index=np.array([-0.7, -2.0, 1.0, 0.0, -1.0, -0.2]))
    table = measure(_observe(sky, array), catalogue_from_galaxies(sky, array[1]), OPTIONS)
    assert _flags(table) == ["ok"] * len(SKY)
    pull = (table["flux_fit"] - sky.flux) / table["flux_fit_err"]
    assert np.max(np.abs(pull)) < 4
    assert np.max(_pulls(table, sky)) < 4


def test_overlapping_galaxies_are_fitted_together_with_wider_errors(array):
    first = SKY.select(np.array([0]))
    beside = galaxies(l=3.5 * ARCSEC, m=2 * ARCSEC, flux=8e-4, alpha=1.8 * ARCSEC, e=0.2j)
    pair = _joined(first, beside)
    table = measure(_observe(pair, array), catalogue_from_galaxies(pair, array[1]), OPTIONS)
    alone = measure(_observe(first, array), catalogue_from_galaxies(first, array[1]), OPTIONS)
    assert _flags(table) == ["ok", "ok"]
    assert np.max(_pulls(table, pair)) < 4
    assert table["e1_err"][0] > 1.05 * alone["e1_err"][0]


@pytest.mark.parametrize("most_major_cycles", [1, 2, 5])
def test_the_last_major_cycle_takes_the_longest_baselines(array, monkeypatch, most_major_cycles):
    """The first two of several leave them out; the field is wide enough for two bands of baselines."""
    sky = galaxies(
        l=np.array([-25.0, 25.0]) * ARCMIN, flux=1e-3, alpha=6 * ARCSEC, e=np.array([0.3, -0.2j])
    )
    longest = []

    def spied(cycle):
        def spy(observation, plan, *others):
            longest.append(plan.longest == plan.bands[0].longest)
            return cycle(observation, plan, *others)

        return spy

    for name in ("first_major_cycle", "next_major_cycle"):
        monkeypatch.setattr(converged, name, spied(getattr(major_cycle, name)))
    method = Method(ConvergedExtraction(most_major_cycles=most_major_cycles))
    catalogue = catalogue_from_galaxies(sky, array[1])
    table = measure(_observe(sky, array), catalogue, replace(OPTIONS, method=method))
    assert table.meta["major_cycles"] == len(longest)
    assert longest == [False] * min(most_major_cycles - 1, 2) + [True]


@pytest.mark.parametrize("bytes_per_sample", [165, 3000])
def test_the_visibilities_are_read_once_a_major_cycle_or_once_if_they_fit(array, bytes_per_sample):
    """The beams come with the first."""

    @dataclass(frozen=True)
    class Counted:
        seen: VisibilitySet
        readings: list

        @property
        def phase_centre(self):
            return self.seen.phase_centre

        def chunks(self):
            self.readings.append(len(self.readings))
            return self.seen.chunks()

    observation = _observe(SKY, array)
    field = field_of(observation, catalogue_from_galaxies(SKY, array[1]), OPTIONS)
    counted = Counted(observation, [])
    memory = field.summary.samples * float(bytes_per_sample)
    setting = replace(OPTIONS.setting, resources=Resources(SERIAL, memory))
    extracted = ConvergedExtraction().extract(counted, field, setting)
    cycles = extracted.record["major_cycles"]
    assert len(counted.readings) == (cycles if bytes_per_sample == 165 else 1)
    assert cycles >= 2


def test_a_field_without_sources_is_not_read(array):
    empty = SKY.select(np.array([], int))
    observation = _observe(SKY, array)
    field = field_of(observation, catalogue_from_galaxies(empty, array[1]), OPTIONS)
    nothing = VisibilitySet(array[1], ())
    extracted = ConvergedExtraction().extract(nothing, field, OPTIONS.setting)
    assert extracted.measurements == {}
    assert extracted.record == {"extraction": "converged", "major_cycles": 0}


def test_progress_ends_when_all_is_done(array):
    heard = []
    observation = _observe(SKY, array)
    field = field_of(observation, catalogue_from_galaxies(SKY, array[1]), OPTIONS)
    ConvergedExtraction().extract(
        observation, field, OPTIONS.setting, lambda done, total: heard.append((done, total))
    )
    assert heard[-1][0] == heard[-1][1]
    assert all(done <= total for done, total in heard)


def test_an_observer_hears_of_every_stage_and_of_its_convergence(array):
    heard = Heard()
    observation = _observe(SKY, array)
    field = field_of(observation, catalogue_from_galaxies(SKY, array[1]), OPTIONS)
    setting = replace(OPTIONS.setting, keep=(Moments(),))
    found = ConvergedExtraction().extract(observation, field, setting, heard)
    count = found.record["major_cycles"]
    cycles = [
        f"{kind} cycle {number + 1}" for number in range(count) for kind in ("major", "minor")
    ]
    assert heard.stages == [*cycles, "posteriors", "wide prior", "statistics"]
    notes = [what[1] for what in heard.all if what[0] == "note"]
    assert [note["change_rms"] for note in notes[:-1]] == found.record["change_rms"]
    assert notes[-1] == {"moves": found.record["released"]}
    assert heard.all[-1] == ("finish",)
    # Each stage comes as it was foreseen, unless the sky took more or fewer cycles.
    ends = [what for what in heard.all if what[0] == "begin"]
    assert all(then[-3:] == ("posteriors", "wide prior", "statistics") for *_, then in ends[:-3])
    # Every cycle has worked through the visibilities once, with the beams or without.
    for stage in ("minor cycle 1", "minor cycle 2"):
        _, done, expected = heard.all[[what[:2] for what in heard.all].index(("begin", stage)) - 1]
        assert 0.9 * field.summary.samples < done <= 1.001 * field.summary.samples
        assert done > 0.9 * expected
