from dataclasses import dataclass
from typing import ClassVar

import pytest

from uvshear.errors import InputError
from uvshear.extraction import (
    ConvergedExtraction,
    MeasurementOptions,
    Method,
    PaperExtraction,
)
from uvshear.interferometer.weighting import RoundPsf
from uvshear.shapes.source_facet import Column


@dataclass(frozen=True)
class Norm:
    """A statistic of a user's own."""

    columns: ClassVar = {"norm": Column("sum of the power")}

    def statistic(self, source):
        return {"norm": float(source.facet.power.sum())}


@dataclass(frozen=True)
class Nothing:
    """A statistic that keeps nothing, for the table of shapes has all that it needs."""

    columns: ClassVar = {}

    def statistic(self, source):
        return None


def test_the_extraction_is_the_converged_one_unless_told():
    assert MeasurementOptions().method.extraction == ConvergedExtraction()


def test_every_extraction_is_given_the_model_the_resources_and_the_statistics():
    options = MeasurementOptions(keep=[Norm()])
    assert options.setting.model is options.model
    assert options.setting.resources is options.resources
    assert options.setting.keep == (Norm(),)


def test_statistics_cannot_be_combined_with_another_weighting():
    method = Method(weightings=(RoundPsf(),))
    with pytest.raises(InputError, match="another weighting cannot be combined"):
        MeasurementOptions(method=method, keep=[Norm()])
    MeasurementOptions(method=method, keep=[Nothing()])


def test_an_extraction_that_keeps_no_statistics_is_not_asked_for_any():
    method = Method(PaperExtraction())
    with pytest.raises(InputError, match="PaperExtraction keeps no statistics"):
        MeasurementOptions(method=method, keep=[Norm()])
    MeasurementOptions(method=method, keep=[Nothing()])
