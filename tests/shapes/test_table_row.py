"""One measurement as a row of the table of shapes."""

from dataclasses import replace

import numpy as np
import pytest

from tests.shapes.facets import EXPONENTIAL, PRIOR, noisy
from uvshear.galaxy import DiscEllipticityPrior
from uvshear.shapes.measurement import FitFlag, ShapeMeasurement
from uvshear.shapes.shape import measure_shape
from uvshear.shapes.table_row import shape_values
from uvshear.shapes.weight import lensfit_weight

POPULATION = DiscEllipticityPrior()
SHAPE = measure_shape(noisy(np.random.default_rng(1), 0.2 + 0.1j)[0], PRIOR, EXPONENTIAL)


def test_the_values_are_those_of_the_measurement():
    values = shape_values(SHAPE, POPULATION)
    assert (values["e1"], values["e2"]) == tuple(SHAPE.ellipticity)
    assert (values["dl"], values["dm"]) == tuple(SHAPE.offset)
    assert values["e1_err"] ** 2 == pytest.approx(SHAPE.covariance[0, 0])
    assert values["e2_err"] ** 2 == pytest.approx(SHAPE.covariance[1, 1])
    assert values["e12_cov"] == SHAPE.covariance[0, 1]
    assert values["flux_fit"] == SHAPE.flux
    expected = lensfit_weight(np.array([SHAPE.e_sigma]), POPULATION)[0]
    assert values["weight"] == expected > 0


def test_a_flag_takes_the_weight_away():
    flagged = replace(SHAPE, flag=FitFlag.CONTAMINATED)
    assert shape_values(flagged, POPULATION)["weight"] == 0.0


def test_a_failure_has_every_column_without_a_number():
    values = shape_values(ShapeMeasurement.failed(FitFlag.NO_PEAK), POPULATION)
    assert values.keys() == shape_values(SHAPE, POPULATION).keys()
    assert values["weight"] == 0.0
    assert all(np.isnan(value) for name, value in values.items() if name != "weight")
