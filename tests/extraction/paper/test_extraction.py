"""The paper's extraction: bad measurements, and the record."""

from dataclasses import replace

import numpy as np
import pytest

from tests.extraction.fields import BRIGHT, FAINT, SIZES, extract, pair, with_extraction
from uvshear.errors import InputError
from uvshear.extraction import PaperExtraction
from uvshear.extraction.paper.cell_average import CellAverageFacets, PaperTable
from uvshear.extraction.paper.exact import ExactFacets
from uvshear.predict import predict_visibilities
from uvshear.shapes.measurement import FitFlag, ShapeMeasurement
from uvshear.shapes.shape import measure_shape

ONE_PASS = PaperExtraction(ExactFacets())
SAME, TELLING = 1e-4, 0.02
"""Differences of e: of two ways to subtract the same galaxy, and of a neighbour that is a circle or an ellipse."""


@pytest.fixture(scope="module")
def scene():
    return pair()


class Spoilt:
    """The fit, whose first ``times`` measurements of the bright galaxy are bad; it remembers whom it met."""

    def __init__(self, times, flag=FitFlag.UNRELIABLE):
        self.met, self._times, self._flag = [], times, flag

    def __call__(self, facet, prior, profile, start, *, information_fraction):
        source = int(np.argmin(np.abs(np.log(SIZES) - prior.log_scale_length)))
        self.met.append(source)
        shape = measure_shape(
            facet, prior, profile, start, information_fraction=information_fraction
        )
        if source == BRIGHT and self.met.count(BRIGHT) <= self._times:
            return replace(shape, best=None, flag=self._flag)
        return shape


def _extract(scene, extraction=ONE_PASS, fit=None):
    """Extract, with a fit of one's own if given."""
    observation, catalogue, _ = scene
    with pytest.MonkeyPatch.context() as patch:
        if fit is not None:
            patch.setattr("uvshear.extraction.paper.sequential_pass.measure_shape", fit)
        return extract(observation, catalogue, with_extraction(extraction))


def _ellipticity(extracted, source):
    return extracted.measurements[source].ellipticity @ (1, 1j)


def _alone(scene, source, other):
    """Ellipticity of a source that is alone in the catalogue, when ``other`` has been taken out of the data."""
    observation, catalogue, _ = scene
    block = observation.blocks[0]
    left = block.stokes_i - predict_visibilities(other, block.uvw, block.frequency)
    observation = replace(observation, blocks=(block.with_stokes_i(left),))
    alone = catalogue.select(np.array([source]))
    return _ellipticity(extract(observation, alone, with_extraction(ONE_PASS)), 0)


def _circle(truth, source):
    return replace(truth.select(np.array([source])), ellipticity=np.zeros(1, complex))


def test_the_fainter_is_fitted_against_the_ellipse_of_the_brighter(scene):
    extracted = _extract(scene)
    assert {shape.flag for shape in extracted.measurements.values()} == {FitFlag.OK}
    ellipse = extracted.sky.select(np.array([BRIGHT]))
    against_ellipse = _alone(scene, FAINT, ellipse)
    against_circle = _alone(scene, FAINT, _circle(scene[2], BRIGHT))
    assert abs(against_circle - against_ellipse) > TELLING
    assert abs(_ellipticity(extracted, FAINT) - against_ellipse) < SAME
    assert extracted.record["fitted_again"] == 0


def test_a_bad_measurement_leaves_its_circle_and_is_fitted_again_at_the_end(scene):
    fit = Spoilt(times=1)
    extracted = _extract(scene, fit=fit)
    assert fit.met == [BRIGHT, FAINT, BRIGHT]
    against_circle = _alone(scene, FAINT, _circle(scene[2], BRIGHT))
    assert abs(_ellipticity(extracted, FAINT) - against_circle) < SAME
    in_the_end = _alone(scene, BRIGHT, extracted.sky.select(np.array([FAINT])))
    at_first = _alone(scene, BRIGHT, _circle(scene[2], FAINT))
    assert abs(in_the_end - at_first) > TELLING
    assert abs(_ellipticity(extracted, BRIGHT) - in_the_end) < SAME
    best = extracted.measurements[BRIGHT].best
    assert extracted.measurements[BRIGHT].flag is FitFlag.OK
    assert extracted.sky.ellipticity[BRIGHT] == best.ellipticity
    assert extracted.record["fitted_again"] == 1
    assert extracted.record["bad_again"] == 0


def test_what_is_bad_again_keeps_its_circle_and_its_flag(scene):
    _, _, truth = scene
    fit = Spoilt(times=2)
    extracted = _extract(scene, fit=fit)
    assert fit.met == [BRIGHT, FAINT, BRIGHT]
    assert extracted.sky.ellipticity[BRIGHT] == 0
    assert extracted.sky.flux[BRIGHT] == truth.flux[BRIGHT]
    assert extracted.record["bad_again"] == 1
    flags = [extracted.measurements[source].flag for source in (BRIGHT, FAINT)]
    assert flags == [FitFlag.UNRELIABLE, FitFlag.OK]
    assert np.isfinite(_ellipticity(extracted, BRIGHT))


def test_the_last_fit_looks_anew(scene):
    """Two passes: the first finds the bright galaxy well, and its place is not where the last fit starts."""
    starts = []

    class Watched(Spoilt):
        def __call__(self, facet, prior, profile, start, *, information_fraction):
            starts.append(start)
            return super().__call__(
                facet, prior, profile, start, information_fraction=information_fraction
            )

    _extract(scene, PaperExtraction(ExactFacets(), passes=2), Watched(times=1))
    assert [start is None for start in starts] == [False, False, True]


@pytest.mark.parametrize("flag", [FitFlag.NO_DATA, FitFlag.UNDETERMINED])
def test_what_no_sky_mends_is_not_tried_again(scene, monkeypatch, flag):
    calls = []

    def failing(*_, **__):
        calls.append(flag)
        return ShapeMeasurement.failed(flag)

    extracted = _extract(scene, fit=failing)
    assert len(calls) == 2
    assert extracted.record["major_cycles"] == 2


@pytest.mark.parametrize(("times", "major_cycles"), [(0, 2), (1, 3)])
def test_progress_ends_at_what_there_was_to_do(scene, monkeypatch, times, major_cycles):
    observation, catalogue, _ = scene
    monkeypatch.setattr("uvshear.extraction.paper.sequential_pass.measure_shape", Spoilt(times))
    heard = []
    options = with_extraction(ONE_PASS)
    extract(observation, catalogue, options, progress=lambda *x: heard.append(x))
    rows = len(observation.blocks[0])
    cycles = [(rows * k, rows * max(k, 2)) for k in range(1, major_cycles + 1)]
    assert heard == [*cycles, cycles[-1]]  # the end is told as well


def test_the_record_tells_how_sources_were_told_apart(scene):
    observation, catalogue, _ = scene
    extracted = extract(observation, catalogue, with_extraction(PaperExtraction(passes=2)))
    assert extracted.record == {
        "extraction": "paper",
        "facet": "CellAverageFacets",
        "averages_cells": True,
        "passes": 2,
        "major_cycles": 4,
        "fitted_again": 0,
        "bad_again": 0,
    }


def test_it_is_one_pass_with_the_facets_of_table_1_unless_told():
    assert PaperExtraction() == PaperExtraction(CellAverageFacets(PaperTable()), passes=1)


def test_less_than_one_pass_is_an_error():
    with pytest.raises(InputError, match="0 passes"):
        PaperExtraction(passes=0)
