import numpy as np
import pytest

from tests.extraction.fields import OPTIONS, field_of, pair
from uvshear.constants import ARCSEC
from uvshear.geometry.directions import PhaseCentre
from uvshear.shapes.measurement import FitFlag


@pytest.fixture
def field():
    observation, catalogue, _ = pair()
    return field_of(observation, catalogue)


def test_sources_without_a_flag_are_measured(field):
    assert field.measured.tolist() == [0, 1]
    field.flags[0] = FitFlag.POINT_SOURCE
    assert field.measured.tolist() == [1]


def test_names_differ_between_sources_and_between_fields(field):
    centres = PhaseCentre(1.0, 0.7), PhaseCentre(1.1, 0.7)
    names = {field.name(source, centre) for source in (0, 1) for centre in centres}
    assert len(names) == 4
    assert field.name(0, centres[0]) == field.name(0, centres[0])
    assert all(0 <= number < 2**32 for name in names for number in name)


def test_a_prior_has_the_size_of_the_field(field):
    prior = field.prior(1, 3 * ARCSEC, OPTIONS.model.ellipticity)
    assert prior.log_scale_length == pytest.approx(np.log(2 * ARCSEC))
    assert prior.position_radius == 3 * ARCSEC
    assert np.isinf(prior.ellipticity_sigma)
