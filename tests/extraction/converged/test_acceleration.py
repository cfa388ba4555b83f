"""The sky to subtract next, from the last cycles: against linear problems whose solution is known, and a real one."""

import numpy as np
import pytest

import uvshear
from uvshear.constants import ARCMIN, ARCSEC
from uvshear.execution import SERIAL
from uvshear.extraction import ConvergedExtraction
from uvshear.extraction.converged import extraction
from uvshear.extraction.converged.acceleration import Cycle, accelerated_step
from uvshear.galaxy import CatalogueSize, Galaxies
from uvshear.geometry.directions import PhaseCentre
from uvshear.interferometer.coverage import Track
from uvshear.interferometer.layout import load_layout
from uvshear.interferometer.plan import ObservingPlan
from uvshear.interferometer.spectral_window import Channels
from uvshear.interferometer.summary import summarise
from uvshear.io.catalogue import catalogue_from_galaxies

SOURCES = 5
UNIT = np.broadcast_to(np.eye(6), (SOURCES, 6, 6))


def _problem(eigenvalues):
    """Steps f(x) = A (solution - x) whose matrix has these eigenvalues, and the solution."""
    rng = np.random.default_rng(1)
    size = 6 * SOURCES
    basis, _ = np.linalg.qr(rng.normal(size=(size, size)))
    values = np.resize(eigenvalues, size)
    matrix, solution = basis @ np.diag(values) @ basis.T, rng.normal(size=size)
    return lambda x: (matrix @ (solution - x.ravel())).reshape(-1, 6), solution.reshape(-1, 6)


def _iterated(eigenvalues, number, *, is_accelerated):
    """Distance to the solution after a number of cycles from zero."""
    step, solution = _problem(eigenvalues)
    x, cycles = np.zeros((SOURCES, 6)), []
    for _ in range(number):
        cycles.append(Cycle(x, step(x)))
        x = x + (accelerated_step(cycles, UNIT) if is_accelerated else cycles[-1].step)
    return float(np.abs(x - solution).max())


def test_as_many_cycles_as_distinct_eigenvalues_solve_a_linear_problem():
    """As for GMRES; without acceleration the eigenvalues above 2 let the iteration diverge."""
    values = (0.4, 1.0, 2.5)
    assert _iterated(values, 4, is_accelerated=True) < 1e-9
    assert _iterated(values, 4, is_accelerated=False) > 2
    assert _iterated(values, 3, is_accelerated=True) > 1e-3


def test_slow_convergence_becomes_faster():
    """The distance falls as fast as Chebyshev's bound says for a condition number of 3: by 0.27 a cycle, not by 0.6."""
    values = np.linspace(0.4, 1.2, 30)
    bound = 2 * ((np.sqrt(3) - 1) / (np.sqrt(3) + 1)) ** 7 * np.abs(_problem(values)[1]).max()
    assert _iterated(values, 8, is_accelerated=True) < 3 * bound
    assert _iterated(values, 8, is_accelerated=False) > 20 * bound


def test_the_first_step_is_taken_as_it_is():
    cycle = Cycle(np.zeros((SOURCES, 6)), np.ones((SOURCES, 6)))
    np.testing.assert_array_equal(accelerated_step([cycle], UNIT), cycle.step)


def test_a_step_that_does_not_change_is_no_harm():
    cycle = Cycle(np.zeros((SOURCES, 6)), np.ones((SOURCES, 6)))
    step = accelerated_step([cycle, cycle, cycle], UNIT)
    np.testing.assert_allclose(step, cycle.step)


def test_the_information_sets_what_counts():
    """With two parameters that disagree on the best combination, the one with the information decides."""
    known = np.zeros((1, 6, 6))
    known[0, 0, 0] = 1.0
    before = np.zeros((1, 6))
    first, second = before.copy(), before.copy()
    first[0, :2], second[0, :2] = (1.0, 1.0), (0.5, -3.0)
    cycles = [Cycle(before, first), Cycle(before + 0.5, second)]
    step = accelerated_step(cycles, known)
    # f_0 falls from 1 to 0.5 over a step of 0.5: it is zero another 0.5 farther
    assert 0.5 + step[0, 0] == pytest.approx(1.0)


def test_many_sources_before_few_antennas_converge(monkeypatch):
    """Half an hour with the VLA (A) at one frequency: sidelobes couple all sources of the field."""
    half, count, rng = 10 * ARCMIN, 25, np.random.default_rng(1)
    galaxies = Galaxies(
        l=rng.uniform(-half, half, count),
        m=rng.uniform(-half, half, count),
        flux=np.exp(rng.uniform(np.log(200), np.log(2000), count)),
        scale_length=np.exp(rng.normal(np.log(1.6), 0.2, count)) * ARCSEC,
        ellipticity=rng.uniform(0, 0.5, count) * np.exp(2j * np.pi * rng.uniform(size=count)),
        spectral_index=np.full(count, -0.7),
    )
    centre, hour = PhaseCentre(2.0, np.radians(34.0)), np.radians(15)
    track = Track(centre, ((-hour / 4, hour / 4),), 60.0)
    channels = Channels.from_band(1.396e9, 1.404e9, 1)
    plan = ObservingPlan(load_layout("vla-a"), track, channels, True)
    empty = uvshear.simulate(catalogue_from_galaxies(galaxies, centre), plan, seed=1)
    galaxies.flux[:] /= np.sqrt(summarise(empty).weight)
    catalogue = catalogue_from_galaxies(galaxies, centre)
    seen = uvshear.simulate(catalogue, plan, noise=empty.noise, seed=1)

    def measured(most_major_cycles):
        return uvshear.measure(
            seen,
            catalogue,
            model=uvshear.Model(size=CatalogueSize()),
            method=uvshear.Method(ConvergedExtraction(most_major_cycles=most_major_cycles)),
            resources=uvshear.Resources(SERIAL),
        )

    result = measured(15)
    assert np.all(result.shapes["flag"] == "ok")
    assert result.record["major_cycles"] <= 10  # measured 8
    e = np.array(result.shapes["e1"] + 1j * result.shapes["e2"])
    pull = (e - galaxies.ellipticity).real / np.array(result.shapes["e1_err"])
    assert np.sqrt(np.mean(pull**2)) < 1.5
    monkeypatch.setattr(extraction, "next_sky", lambda state, cycles: state.fits)
    with pytest.warns(uvshear.DataWarning):
        changes = measured(8).record["change_rms"]
    # measured 10, against 0.09
    assert changes[-1] > 5 > 20 * result.record["change_rms"][-1]
