"""The population of galaxies without a lens, and its record."""

import json

import pytest

from uvshear.constants import MICROJANSKY
from uvshear.estimators.population import PARAMETERS, UnlensedPopulation, unit_of
from uvshear.galaxy import (
    DiscEllipticityPrior,
    FlatEllipticityPrior,
    PowerLawFlux,
    SizeFluxRelation,
)

OWN = UnlensedPopulation(
    PowerLawFlux(index=-1.6, minimum=5 * MICROJANSKY, maximum=300 * MICROJANSKY),
    SizeFluxRelation(intercept=-0.8, slope=0.3, sigma=0.4),
    DiscEllipticityPrior(c=0.3, e0=0.1, maximum=0.9),
)


def test_the_record_has_the_units_of_files():
    assert json.loads(json.dumps(OWN.record())) == {
        "flux": {
            "index": -1.6,
            "minimum_ujy": pytest.approx(5.0),
            "maximum_ujy": pytest.approx(300.0),
        },
        "size": {"intercept": -0.8, "slope": 0.3, "sigma": 0.4},
        "ellipticity": {"c": 0.3, "e0": 0.1, "maximum": 0.9},
    }
    assert unit_of("minimum_ujy") == MICROJANSKY
    assert unit_of("index") == 1.0


def test_every_parameter_is_a_field_of_its_part():
    for part, names in PARAMETERS.items():
        for field_name in names.values():
            assert isinstance(getattr(getattr(UnlensedPopulation(), part), field_name), float)


def test_ellipticities_of_another_kind_are_left_out():
    flat = UnlensedPopulation(ellipticity=FlatEllipticityPrior())
    assert set(flat.record()) == {"flux", "size"}
