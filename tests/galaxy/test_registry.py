"""Profiles by name."""

import sys
from dataclasses import dataclass
from types import ModuleType

import numpy as np
import pytest

from uvshear.errors import InputError
from uvshear.galaxy import (
    PROFILES,
    DiscBulge,
    Exponential,
    Gaussian,
    Profile,
    Sersic,
    profile_named,
)


@dataclass(frozen=True)
class Lorentzian(Profile):
    """A profile of a user's own."""

    width: float = 1.0

    def envelope(self, q):
        return np.exp(-self.width * np.sqrt(q))


@pytest.mark.parametrize(
    ("name", "profile"),
    [
        ("exponential", Exponential()),
        ("gaussian", Gaussian()),
        ("sersic-2", Sersic(2.0)),
        ("disc-bulge", DiscBulge()),
    ],
)
def test_the_profiles_of_the_package_go_by_name(name, profile):
    assert profile_named(name) == profile
    assert name in PROFILES.names()


@pytest.fixture
def module(monkeypatch):
    mine = ModuleType("profiles_of_mine")
    monkeypatch.setitem(sys.modules, "profiles_of_mine", mine)
    return mine


@pytest.mark.parametrize("found", [Lorentzian, Lorentzian(), lambda: Lorentzian(1.0)])
def test_a_class_an_instance_and_a_function_are_all_profiles(module, found):
    module.mine = found
    assert profile_named("profiles_of_mine:mine") == Lorentzian()


def test_what_is_no_profile_is_refused(module):
    module.mine = 7
    with pytest.raises(
        InputError, match="'profiles_of_mine:mine' is not a Profile but has the type int"
    ):
        profile_named("profiles_of_mine:mine")
    with pytest.raises(InputError, match="'round' is not a known profile"):
        profile_named("round")
