"""Shapes from visibilities that DP3 has averaged, against those from the visibilities before.

With Gaussian noise the shapes e_f of all visibilities are the most precise ones. The change e_a - e_f by averaging is
then independent of e_f, and its variance is the difference of the variances of e_a and e_f.
"""

from pathlib import Path

import numpy as np
import pytest
from astropy.table import Table

import uvshear
from tests.io.measurement_set.crossed_hands import with_crossed_hands
from tests.other_programs import run_dp3
from uvshear.constants import ARCMIN, ARCSEC
from uvshear.extraction import ConvergedExtraction
from uvshear.galaxy import CatalogueSize, Galaxies
from uvshear.geometry.directions import PhaseCentre
from uvshear.interferometer.attenuation import total_attenuation
from uvshear.interferometer.coverage import Track
from uvshear.interferometer.layout import load_layout
from uvshear.interferometer.plan import ObservingPlan
from uvshear.interferometer.spectral_window import Channels
from uvshear.interferometer.summary import summarise
from uvshear.io.catalogue import Catalogue, catalogue_from_galaxies
from uvshear.io.measurement_set.writer import write_measurement_set
from uvshear.io.observations import open_observation

pytestmark = [pytest.mark.referee, pytest.mark.long]

CENTRE = PhaseCentre(2.0, np.radians(34.0))
HALF = 10 * ARCMIN
COUNT = 60
HOUR = np.radians(15)


def _sky(seed: int) -> Galaxies:
    rng = np.random.default_rng(seed)
    return Galaxies(
        l=rng.uniform(-HALF, HALF, COUNT),
        m=rng.uniform(-HALF, HALF, COUNT),
        flux=np.exp(rng.uniform(np.log(200), np.log(2000), COUNT)),
        scale_length=np.exp(rng.normal(np.log(1.6), 0.2, COUNT)) * ARCSEC,
        ellipticity=rng.uniform(0, 0.5, COUNT) * np.exp(2j * np.pi * rng.uniform(size=COUNT)),
        spectral_index=np.full(COUNT, -0.7),
    )


def _plan() -> ObservingPlan:
    """Sixteen times 100 s with the VLA (A), in integrations of 10 s and channels of 1 MHz.

    They are 28 minutes apart, multiples of 20 s. With much sparser coverage, sidelobes couple all sources of the field,
    which the errors do not allow for.
    """
    starts = np.radians(15) * (np.arange(16) * 28 / 60 - 3.5)
    track = Track(CENTRE, tuple((start, start + HOUR / 36) for start in starts), 10.0)
    return ObservingPlan(load_layout("vla-a"), track, Channels.from_band(1.396e9, 1.404e9, 8), True)


def _averaged(fine: Path, channels: int, times: int) -> Path:
    """Let DP3 average a Measurement Set."""
    averaged = fine.with_name(f"averaged_{channels}_{times}.ms")
    run_dp3(
        f"msin={fine}",
        f"msout={averaged}",
        "steps=[average]",
        f"average.freqstep={channels}",
        f"average.timestep={times}",
        directory=fine.parent,
    )
    return averaged


def _measured(path: Path, catalogue: Catalogue) -> Table:
    model = uvshear.Model(size=CatalogueSize())
    # What another major cycle would change must not be mistaken for what averaging changes.
    method = uvshear.Method(ConvergedExtraction(tolerance=0.03))
    return uvshear.measure(path, catalogue, model=model, method=method).shapes


@pytest.fixture(scope="module")
def fine(tmp_path_factory: pytest.TempPathFactory) -> tuple:
    directory = tmp_path_factory.mktemp("averaging")
    path = directory / "fine.ms"
    sky, plan = _sky(1), _plan()
    nothing = uvshear.simulate(catalogue_from_galaxies(sky, CENTRE), plan, seed=1)
    sky.flux[:] /= np.sqrt(summarise(nothing).weight)
    catalogue = catalogue_from_galaxies(sky, CENTRE)
    seen = uvshear.simulate(catalogue, plan, noise=nothing.noise, seed=1)
    write_measurement_set(directory / "hands.ms", seen)
    with_crossed_hands(directory / "hands.ms", path)
    return path, catalogue, _measured(path, catalogue)


def _kept(path: Path, catalogue: Catalogue) -> np.ndarray:
    """Part of the peak of each source's image that smearing leaves."""
    probes = summarise(open_observation(path)).probes
    l, m, _ = catalogue.directions(CENTRE)
    smears = total_attenuation(CENTRE.dec)
    return np.array(
        [
            np.average(smears.factor(probes, *place), weights=probes.weights)
            for place in zip(l, m, strict=True)
        ]
    )


def _changes(fine: tuple, channels: int, times: int, kept: float = 0.0) -> tuple:
    """Changes of e1 and e2 by averaging, and the variances before and after, where averaging keeps this amplitude."""
    path, catalogue, before = fine
    averaged = _averaged(path, channels, times)
    after = _measured(averaged, catalogue)
    good = (before["flag"] == "ok") & (after["flag"] == "ok")
    assert np.sum(good) > 0.8 * COUNT
    good &= _kept(averaged, catalogue) >= kept * _kept(path, catalogue)
    names = ("e1", "e2")
    change = np.concatenate([np.array(after[name] - before[name])[good] for name in names])
    fine_var, coarse_var = (
        np.concatenate([np.array(table[f"{name}_err"])[good] ** 2 for name in names])
        for table in (before, after)
    )
    return change, fine_var, coarse_var


def test_heavy_averaging_loses_what_the_errors_say(fine: tuple) -> None:
    """20 s by 8 MHz: channels and times at the edge of the field are smeared to four fifths."""
    change, before, after = _changes(fine, 8, 2)
    lost = after - before
    told = lost > 0.05 * before
    assert np.sum(told) > 80
    pull = change[told] / np.sqrt(lost[told])
    width = float(np.sqrt(np.mean(pull**2)))
    error = width / np.sqrt(2 * len(pull))
    assert error < 0.08
    assert abs(width - 1) < 0.1 + 2 * error


def test_light_averaging_changes_little(fine: tuple) -> None:
    """By 10 s and 2 MHz, where 99 per cent of the amplitude and more are left."""
    change, before, _ = _changes(fine, 2, 1, kept=0.99)
    assert len(change) > 10
    assert np.all(np.abs(change) <= 0.3 * np.sqrt(before))
