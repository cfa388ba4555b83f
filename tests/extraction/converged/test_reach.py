"""Sources far from the phase centre: predicted as by the direct sum, or out of reach."""

from dataclasses import replace

import numpy as np
import pytest

from tests.skies import galaxies, random_baselines
from uvshear.constants import SPEED_OF_LIGHT
from uvshear.extraction.converged.baselines import Baselines
from uvshear.extraction.converged.plan import FacetRequests, plan_major_cycle
from uvshear.extraction.converged.reach import out_of_reach, too_large
from uvshear.extraction.field import Field
from uvshear.galaxy import Exponential, SizePrior
from uvshear.interferometer.samples import Samples
from uvshear.interferometer.summary import ObservationSummary
from uvshear.interferometer.uv_range import UvRange
from uvshear.predict import predict_visibilities
from uvshear.predict.gridded import Gridding, ModelledSky, predict_samples
from uvshear.predict.response import Response
from uvshear.shapes.measurement import FitFlag

ANGLES = [1.0, 3.0, 5.0, 10.0, 20.0, 40.0, 60.0, 75.0, 85.0, 89.0, 89.99]
IN_WAVELENGTHS = np.array([SPEED_OF_LIGHT])


def _samples(uvw):
    none = np.zeros(len(uvw))
    antennas = np.zeros((len(uvw), 2), int)
    return Samples(uvw, none + 0j, none + 1, none + SPEED_OF_LIGHT, none, none, antennas)


def _field(longest, depth, angles=ANGLES):
    """Small discs at these angles from the phase centre [deg], in all directions."""
    seen = _samples(random_baselines(1500, longest, depth=depth))
    radius, turn = np.sin(np.radians(angles)), np.arange(len(angles)) * 2.4
    sky = galaxies(radius * np.cos(turn), radius * np.sin(turn), alpha=0.05 / longest, beta=0)
    nothing = np.zeros(len(sky))
    return Field(
        sky.l,
        sky.m,
        sky,
        SizePrior(np.log(sky.scale_length), nothing + 0.3),
        np.arange(len(sky)),
        np.full(len(sky), FitFlag.OK, dtype=object),
        UvRange(0.0, longest),
        ObservationSummary(1500, 1500, longest, 3e8, 3e8, 1.0, seen),
        nothing,
        nothing,
        nothing + 1,
    )


def _error(field, source):
    """Relative error of the prediction of one source, by way of the tiles of all."""
    samples = field.summary.probes
    used = Baselines.from_field(field, np.full(len(field.modelled), True), 0.0)
    lm = np.column_stack([field.l, field.m])[field.modelled]
    width = np.full(len(lm), 64 / used.finest)
    requests = FacetRequests(*lm.T, width, used.uv_max)
    plan = plan_major_cycle(requests, 0.0, used.longest, used.finest, baselines=samples.uvw)
    sky = field.sky.select(field.modelled)
    only = galaxies(sky.l, sky.m, np.eye(len(sky))[source], sky.scale_length, beta=0)
    modelled = ModelledSky(only, width / 2, Response.from_sky(only), Exponential())
    model = np.zeros(len(samples), complex)
    number = plan.band_of(samples.uvw)
    for band, tiles, b in zip(plan.bands, plan.tiles, range(len(plan.bands)), strict=True):
        chosen = np.flatnonzero(number == b)
        part = samples.select(chosen)
        model[chosen] = predict_samples(part, tiles, band, modelled, Gridding(1e-5))
    expected = predict_visibilities(only, samples.uvw, IN_WAVELENGTHS)[:, 0]
    return float(np.linalg.norm(model - expected) / np.linalg.norm(expected))


@pytest.mark.parametrize(
    ("longest", "depth", "farthest"),
    [
        (30.0, 0.0, 89.99),
        (300.0, 0.0, 89.99),
        (30.0, 0.05, 40.0),
        (300.0, 0.05, 60.0),
        (300.0, 1.0, 20.0),
        (3000.0, 1.0, 20.0),
    ],
)
def test_sources_within_reach_are_predicted_as_by_the_direct_sum(longest, depth, farthest):
    field = _field(longest, depth)
    far = out_of_reach(field, longest)
    assert np.array(ANGLES)[~far].max() == farthest
    near = field.without(far, FitFlag.OUTSIDE_FIELD)
    errors = [_error(near, source) for source in range(len(near.modelled))]
    # measured 2e-6 to 4e-4. Without the limit of the tiles' widths, or with bands by the length from the phase centre,
    # 0.02 to 1.5; with a plane that touches where there is no sphere, NaN.
    assert max(errors) < 1e-3


def test_sources_left_out_have_their_flag_and_no_flux():
    field = _field(300.0, 1.0)
    far = out_of_reach(field, 300.0)
    near = field.without(far, FitFlag.OUTSIDE_FIELD)
    assert set(near.flags[far]) == {FitFlag.OUTSIDE_FIELD}
    assert set(near.flags[~far]) == {FitFlag.OK}
    assert not near.sky.flux[far].any()
    np.testing.assert_array_equal(near.modelled, np.flatnonzero(~far))
    assert near.without(np.zeros(len(near.modelled), bool), FitFlag.NO_DATA) is near


def test_a_narrow_field_is_all_within_reach_and_keeps_its_pixels():
    field = _field(2e5, 1.0, [0.1, 0.3, 0.6, 1.0])
    assert not out_of_reach(field, 2e5).any()
    used = Baselines.from_field(field, np.full(4, True), 0.0)
    at_centre = Baselines.from_field(_field(2e5, 1.0, [0.0]), np.full(1, True), 0.0)
    assert used.finest == at_centre.finest


def test_a_source_is_too_large_where_its_image_would_be():
    field = _field(2e5, 1.0, [0.1, 0.3, 0.6, 1.0])
    assert not too_large(field, 2e5, 45.0).any()
    # 8192 pixels of 1/(2.4 longest) over 45 scale lengths
    limit = 8192 / 45 / (2.4 * 2e5)
    medians = np.array([0.99, 1.01, 1e4, 1e4]) * limit
    flags = np.full(4, FitFlag.OK, dtype=object)
    flags[3] = FitFlag.POINT_SOURCE
    sizes = SizePrior(np.log(medians), np.full(4, 0.3))
    giants = replace(field, size=sizes, flags=flags)
    np.testing.assert_array_equal(too_large(giants, 2e5, 45.0), [False, True, True, False])
