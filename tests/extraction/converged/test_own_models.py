"""The own models of sources: the part that the image of changes lacks, whoever adds it."""

import numpy as np
import pytest

from tests.extraction.converged.five_galaxies import SKY, before_a_vla
from tests.reference import plane
from tests.shapes.facets import EXPONENTIAL, PRIOR
from uvshear.execution import SERIAL, Copies, Processes, Threads
from uvshear.extraction.converged.major_cycle import MajorCycle
from uvshear.extraction.converged.own_models import AT_A_TIME, with_own_models
from uvshear.extraction.converged.sources import GalaxySource
from uvshear.shapes.measurement import GalaxyFit


@pytest.fixture(scope="module")
def field():
    return before_a_vla()


def _fits():
    zero = np.zeros(2)
    parameters = zip(
        SKY.flux.tolist(), SKY.ellipticity.tolist(), SKY.scale_length.tolist(), strict=True
    )
    return [GalaxyFit(flux, zero, complex(e), size, 1.0) for flux, e, size in parameters]


def _with_own_models(field, executor):
    plan, places = field.plan, [facet.copy() for facet in field.before]
    for facet, cutout, offset in zip(places, plan.cutouts, plan.offset, strict=True):
        cutout.recentre(facet, tuple(-offset))
    cycle = MajorCycle(plan, field.beams, tuple(places))
    fits = _fits()
    sources = [GalaxySource(PRIOR, EXPONENTIAL, fit) for fit in fits]
    return with_own_models(cycle, field.interaction(), sources, fits, executor)


def test_what_is_added_is_the_model_times_the_power_that_the_image_lacks(field):
    interaction, facets = field.interaction(), _with_own_models(field, SERIAL)
    for k, fit in enumerate(_fits()):
        cutout = field.plan.cutouts[k]
        model = plane.galaxy(cutout.uv, fit.flux, (0, 0), fit.ellipticity, fit.scale_length)
        lacking = field.beams.power(k, cutout) - interaction.own_power(k)
        added = facets[k] - field.before[k]
        np.testing.assert_allclose(added, lacking * model, rtol=0, atol=2e-6 * np.abs(added).max())


@pytest.mark.parametrize("executor", [Threads(2), Copies(2), Processes(2)])
def test_it_does_not_matter_who_adds(field, executor, monkeypatch):
    expected = _with_own_models(field, SERIAL)
    monkeypatch.setattr("uvshear.extraction.converged.own_models.AT_A_TIME", 2)
    assert len(expected) < AT_A_TIME
    for found, other in zip(_with_own_models(field, executor), expected, strict=True):
        np.testing.assert_array_equal(found, other)
