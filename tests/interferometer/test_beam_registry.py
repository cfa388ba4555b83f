"""Primary beams by name."""

import sys
from types import ModuleType

import numpy as np
import pytest

from uvshear.errors import InputError
from uvshear.interferometer.attenuation import Attenuation
from uvshear.interferometer.beam_registry import PRIMARY_BEAMS, primary_beam_named
from uvshear.interferometer.primary_beam import AiryBeam, CosineCubedBeam, CosineTaperBeam

DIAMETERS = np.array([13.5, 15.0])


class Halving(Attenuation):
    """A beam of a user's own."""

    def __init__(self, diameters, pointing):
        self.diameters, self.pointing = diameters, pointing

    def factor(self, samples, l, m):
        return np.full(len(samples), 0.5)


@pytest.mark.parametrize(
    ("name", "kind"),
    [("airy", AiryBeam), ("cosine-cubed", CosineCubedBeam), ("meerkat", CosineTaperBeam)],
)
def test_the_beams_of_the_package_go_by_name(name, kind):
    beam = primary_beam_named(name, DIAMETERS, (0.1, 0.2))
    assert isinstance(beam, kind)
    assert beam.pointing == (0.1, 0.2)
    assert name in PRIMARY_BEAMS.names()


def test_diameters_may_be_a_function():
    beam = primary_beam_named("airy", lambda: DIAMETERS)
    np.testing.assert_array_equal(beam.width, AiryBeam.from_diameters(DIAMETERS).width)


def test_unknown_diameters_matter_only_to_beams_that_depend_on_them():
    unknown = np.array([13.5, np.nan])
    primary_beam_named("meerkat", unknown)
    with pytest.raises(InputError, match="dish of antenna 1 is not known"):
        primary_beam_named("airy", unknown)


@pytest.fixture
def module(monkeypatch):
    mine = ModuleType("beams_of_mine")
    monkeypatch.setitem(sys.modules, "beams_of_mine", mine)
    return mine


def test_a_beam_of_a_users_own_is_found_by_its_place(module):
    module.Halving = Halving
    beam = primary_beam_named("beams_of_mine:Halving", np.array([np.nan, 3.0]), (0.1, 0.0))
    assert isinstance(beam, Halving)
    np.testing.assert_array_equal(beam.diameters, [0.0, 3.0])


def test_what_is_no_beam_is_refused(module):
    module.number, module.text = 7, lambda diameters, pointing: "beam"
    with pytest.raises(InputError, match="is not a function of diameters and pointing"):
        primary_beam_named("beams_of_mine:number", DIAMETERS)
    with pytest.raises(InputError, match="is not an Attenuation but has the type str"):
        primary_beam_named("beams_of_mine:text", DIAMETERS)


def test_a_name_that_nobody_knows_lists_those_that_are_known():
    with pytest.raises(
        InputError,
        match="'round' is not a known primary beam; the known names are airy, cosine-cubed",
    ):
        primary_beam_named("round", DIAMETERS)
