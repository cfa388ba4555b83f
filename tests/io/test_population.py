"""Populations in JSON files."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from uvshear.constants import MICROJANSKY
from uvshear.errors import InputError
from uvshear.estimators.population import UnlensedPopulation
from uvshear.estimators.population_fit import FittedPopulation
from uvshear.galaxy import DiscEllipticityPrior, PowerLawFlux, SizeFluxRelation
from uvshear.io.population import read_population

OWN = UnlensedPopulation(
    PowerLawFlux(index=-1.6, minimum=5 * MICROJANSKY, maximum=300 * MICROJANSKY),
    SizeFluxRelation(intercept=-0.8, slope=0.3, sigma=0.4),
    DiscEllipticityPrior(c=0.3, e0=0.1, maximum=0.9),
)


def _written(tmp_path: Path, record: object) -> Path:
    path = tmp_path / "population.json"
    path.write_text(json.dumps(record))
    return path


def test_what_is_written_is_read(tmp_path: Path) -> None:
    found = read_population(_written(tmp_path, OWN.record()))
    assert (found.size, found.ellipticity) == (OWN.size, OWN.ellipticity)
    assert found.flux.index == OWN.flux.index
    assert found.flux.minimum == pytest.approx(OWN.flux.minimum)
    assert found.flux.maximum == pytest.approx(OWN.flux.maximum)


def test_fluxes_are_in_microjanskys(tmp_path: Path) -> None:
    found = read_population(_written(tmp_path, {"flux": {"minimum_ujy": 3.0}}))
    assert found.flux.minimum == pytest.approx(3e-6)


def test_what_is_left_out_is_the_papers(tmp_path: Path) -> None:
    found = read_population(_written(tmp_path, {"size": {"sigma": 0.2}}))
    assert found == replace(UnlensedPopulation(), size=SizeFluxRelation(sigma=0.2))


def test_a_fitted_population_is_read_without_its_errors(tmp_path: Path) -> None:
    covariance = np.diag([0.02, 0.05, 0.1, 0.2]) ** 2
    record = FittedPopulation(OWN, covariance).record()
    assert "intercept_err" in record["size"]
    # as a shear has it
    found = read_population(_written(tmp_path, {"g1": 0.01, "population": record}))
    assert (found.size, found.ellipticity) == (OWN.size, OWN.ellipticity)


def test_a_path_may_be_text(tmp_path: Path) -> None:
    assert read_population(str(_written(tmp_path, {}))) == UnlensedPopulation()


@pytest.mark.parametrize(
    ("record", "message"),
    [
        ([], "is not a population"),
        (
            {"sizes": {}},
            "unknown entry 'sizes'; a population has the entries flux, size, ellipticity",
        ),
        ({"population": 3}, "the population is not an object with the entries"),
        ({"size": 3}, "'size' is not an object with the parameters intercept, slope, sigma"),
        (
            {"size": {"scatter": 0.3}},
            "unknown parameter 'scatter' of 'size'; its parameters are intercept, slope, sigma",
        ),
        ({"size": {"sigma": "wide"}}, "the parameter 'sigma' of 'size' is not a finite number"),
        (
            {"size": {"sigma": -0.3}},
            "the parameter 'sigma' of 'size' is -0.3; it must lie between 0.01 and 10",
        ),
        ({"size": {"sigma": 10**400}}, "the parameter 'sigma' of 'size' is not a finite number"),
        (
            {"flux": {"index": 400}},
            "the parameter 'index' of 'flux' is 400; it must lie between -10 and 10",
        ),
        ({"ellipticity": {"e0": 0}}, "the parameter 'e0' of 'ellipticity' is 0"),
        ({"ellipticity": {"maximum": 1.5}}, "it must lie between 0.01 and 1"),
        ({"flux": {"minimum_ujy": 500}}, "positive and below the maximum"),
    ],
)
def test_a_wrong_file_is_one_line(tmp_path: Path, record: object, message: str) -> None:
    with pytest.raises(InputError) as error:
        read_population(_written(tmp_path, record))
    assert "population.json: " in str(error.value)
    assert message in str(error.value)
    assert "\n" not in str(error.value)


def test_a_file_that_is_not_there_is_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="papers: no such file"):
        read_population(tmp_path / "papers")
