"""The residual of a sky that changes by a few sources at a time."""

from dataclasses import replace

import numpy as np
import pytest

from tests.extraction.sources import ALPHA, PROFILE
from tests.skies import L_BAND, galaxies, vla
from uvshear.execution import SERIAL, Resources
from uvshear.extraction.paper import residual
from uvshear.extraction.paper.residual import Residual, SubtractedSky
from uvshear.interferometer.visibilities import Visibilities, VisibilitySet
from uvshear.predict import predict_visibilities

NUMBER = 40
ROOM, NO_ROOM = Resources(SERIAL, 1e9), Resources(SERIAL, 1.0)
ROUNDING = 2.0**-residual.BITS * NUMBER


def _sky(seed):
    rng = np.random.default_rng(seed)
    l, m = rng.uniform(-0.003, 0.003, (2, NUMBER))
    flux, e = rng.uniform(1e-5, 2e-4, NUMBER), rng.uniform(-0.5, 0.5, NUMBER) * 1j
    return galaxies(l, m, flux, ALPHA * rng.uniform(0.5, 2, NUMBER), e)


SKY = _sky(1)
"""The true sky."""


def _observation():
    uvw, centre = vla("b", samples=2)
    vis = predict_visibilities(SKY, uvw, L_BAND, PROFILE)
    seen = Visibilities(uvw, L_BAND, vis, np.ones(vis.shape))
    return VisibilitySet(centre, (seen.of_rows(slice(0, 300)), seen.of_rows(slice(300, None))))


def _changes():
    """Return skies that differ by a few sources from one to the next; the last is the true one."""
    skies, rng, now = [_sky(2)], np.random.default_rng(3), _sky(2)
    for some in np.array_split(rng.permutation(NUMBER), 5):
        columns = {name: getattr(now, name).copy() for name in ("l", "m", "flux", "ellipticity")}
        columns["scale_length"] = now.scale_length.copy()
        for name, values in columns.items():
            values[some] = getattr(SKY, name)[some]
        now = replace(now, **columns)
        skies.append(now)
    return skies


def _left(subtracted, sky):
    found = Residual(_observation(), sky, subtracted)
    return np.concatenate([chunk.stokes_i for chunk in found.chunks()])


def test_the_residual_is_the_data_less_the_sum_over_all_sources():
    subtracted, observation = SubtractedSky(SKY, PROFILE, ROOM), _observation()
    data = np.concatenate([block.stokes_i for block in observation.blocks])
    uvw = np.concatenate([block.uvw for block in observation.blocks])
    total = SKY.flux.sum()
    for sky in _changes():
        expected = data - predict_visibilities(sky, uvw, L_BAND, PROFILE)
        found = _left(subtracted, sky)
        assert np.abs(found - expected).max() < ROUNDING * total  # measured: a twentieth
    assert np.abs(found).max() < ROUNDING * total


def test_the_way_to_a_sky_changes_no_bit():
    by_steps, without_memory = (
        SubtractedSky(SKY, PROFILE, resources) for resources in (ROOM, NO_ROOM)
    )
    for sky in _changes():
        step = _left(by_steps, sky)
        np.testing.assert_array_equal(step, _left(SubtractedSky(SKY, PROFILE, ROOM), sky))
        np.testing.assert_array_equal(step, _left(without_memory, sky))


# Eight sources change. Where their models are held, they are summed before and after the change, for two chunks.
@pytest.mark.parametrize(
    ("resources", "unchanged", "changed"),
    [(ROOM, 0, 2 * 2 * 8), (NO_ROOM, 2 * NUMBER, 2 * NUMBER)],
)
def test_only_sources_that_have_changed_are_summed_again(
    monkeypatch, resources, unchanged, changed
):
    sums = []

    def counted(sky, *arguments):
        sums.append(len(sky))
        return predict(sky, *arguments)

    predict = residual.predict_multiples
    subtracted, (first, second, *_) = SubtractedSky(SKY, PROFILE, resources), _changes()
    _left(subtracted, first)
    monkeypatch.setattr(residual, "predict_multiples", counted)
    _left(subtracted, first)
    assert sum(sums) == unchanged
    sums.clear()
    _left(subtracted, second)
    assert sum(sums) == changed


def test_memory_is_for_as_many_chunks_as_fit():
    (first, second) = _observation().blocks
    memory = 16 * first.stokes_i.size / residual.HELD_PART
    subtracted = SubtractedSky(SKY, PROFILE, Resources(SERIAL, memory))
    _left(subtracted, SKY)
    assert list(subtracted._held) == [0]
    assert len(second) > len(first)


def test_a_sky_without_flux_changes_nothing():
    nothing = replace(SKY, flux=np.zeros(NUMBER))
    data = np.concatenate([block.stokes_i for block in _observation().blocks])
    np.testing.assert_array_equal(_left(SubtractedSky(nothing, PROFILE, ROOM), nothing), data)
