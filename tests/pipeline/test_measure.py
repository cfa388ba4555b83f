"""The measurement end to end, in memory: a VLA field of a few sources."""

import warnings
from dataclasses import replace

import numpy as np
import pytest
from astropy import units
from astropy.coordinates import SkyCoord
from astropy.wcs import WCS

from tests.pipeline.fields import (
    FREQUENCY,
    GOOD,
    METHOD,
    MODEL,
    SIGMA,
    catalogue_of_sky,
    observe,
    vla_field,
)
from tests.skies import galaxies, vla
from uvshear.constants import ARCSEC
from uvshear.errors import DataWarning, InputError, NothingMeasuredWarning
from uvshear.execution import Copies, Resources, Serial, Threads
from uvshear.extraction import ConvergedExtraction, PaperExtraction
from uvshear.extraction.paper.cell_average import CellAverageFacets
from uvshear.galaxy import DiscEllipticityPrior
from uvshear.geometry.directions import PhaseCentre
from uvshear.interferometer.uv_range import UvRange
from uvshear.io.shapes import COLUMNS
from uvshear.pipeline.data_checks import DataChecks
from uvshear.pipeline.measure import measure
from uvshear.pipeline.shear import estimate_shear
from uvshear.predict import predict_visibilities
from uvshear.shapes.weight import lensfit_weight

SOURCES_LEFT = pytest.mark.filterwarnings("ignore:.*agree with the noise cannot be told")
"""The catalogue lacks bright sources, which is said."""


def measured(observation, catalogue, **more):
    """Measure with the settings of these tests."""
    settings = {"model": MODEL, "method": METHOD, "resources": Resources(Serial())}
    return measure(observation, catalogue, **settings | more)


@pytest.fixture(scope="module")
def measurement(field):
    return measured(field.observation, field.catalogue)


@pytest.fixture(scope="module")
def shapes(measurement):
    return measurement.shapes


def test_samples_that_cannot_be_right_change_nothing_and_are_told(field, shapes):
    """Rows of a missing antenna, of a broken uvw, and of interference that no receiver can have."""
    observation = field.observation
    first = observation.blocks[0]
    bad = replace(
        first,
        uvw=np.array([[0.0, 0.0, 0.0], [1e20, 5.0, 1.0], [np.nan, 1.0, 2.0], [300.0, 400.0, 10.0]]),
        stokes_i=np.full((4, first.stokes_i.shape[1]), 1e30, np.complex64),
        weights=np.full((4, first.weights.shape[1]), first.weights.max()),
        integrations=None if first.integrations is None else first.integrations.select(slice(4)),
    )
    among = replace(observation, blocks=(*observation.blocks, bad))
    with pytest.warns(DataWarning) as told:
        found = measured(among, field.catalogue).shapes
    texts = [str(warning.message) for warning in told]
    channels = first.stokes_i.shape[1]
    assert any(f"{3 * channels} of" in text and "have a UVW that is zero" in text for text in texts)
    assert any(f"{channels} of" in text and "1e8 times their noise" in text for text in texts)
    for name in shapes.colnames:
        np.testing.assert_array_equal(found[name], shapes[name])


def test_every_source_has_its_row_and_its_flag(shapes):
    assert shapes["id"].tolist() == [f"s{k}" for k in range(7)]
    assert shapes["flag"].tolist() == [
        *("ok", "point_source", "ok", "ok", "outside_field", "ok", "below_horizon")
    ]
    assert shapes.colnames == list(COLUMNS)


def test_shapes_sizes_fluxes_and_places_are_the_true_ones_within_their_errors(field, shapes):
    truth, row = field.truth.select(np.array(GOOD)), shapes[GOOD]
    pulls = [
        (row["e1"] - truth.ellipticity.real) / row["e1_err"],
        (row["e2"] - truth.ellipticity.imag) / row["e2_err"],
        (row["flux_fit"] - 1e6 * truth.flux) / row["flux_fit_err"],
        (row["scale_length"] - truth.scale_length / ARCSEC) / row["scale_length_err"],
    ]
    assert np.abs(pulls).max() < 3.5  # measured 2.5, of 16
    assert np.all(row["e_sigma"] < 0.06)
    assert np.all(np.hypot(row["dl"], row["dm"]) < 0.15)
    assert np.all((row["snr"] > 60) & (row["snr"] < 1200))


def test_what_was_not_measured_is_nan_and_weighs_nothing(shapes):
    bad = [1, 4, 6]
    for name in ("e1", "e2", "e1_err", "e_sigma", "snr", "flux_fit", "position_angle", "g1"):
        assert np.all(np.isnan(shapes[name][bad]))
        assert np.all(np.isfinite(shapes[name][GOOD]))
    assert shapes["weight"][bad].tolist() == [0, 0, 0]
    assert not np.any(np.isnan(shapes["weight"]))


def test_weights_and_errors_belong_together(shapes):
    row = shapes[GOOD]
    np.testing.assert_allclose(
        row["weight"], lensfit_weight(np.array(row["e_sigma"]), DiscEllipticityPrior())
    )
    determinant = row["e1_err"] ** 2 * row["e2_err"] ** 2 - row["e12_cov"] ** 2
    np.testing.assert_allclose(row["e_sigma"], determinant**0.25, rtol=1e-9)


def test_shear_is_estimated_from_the_rows_with_weight(shapes):
    shear = estimate_shear(shapes)
    assert shear.n == len(GOOD)
    weight = np.array(shapes["weight"][GOOD])
    # Each ellipticity counts in the frame of its own local North, as the columns g1 and g2 are.
    assert shear.frame == "sky"
    assert shear.g1 == pytest.approx(np.average(shapes["g1"][GOOD], weights=weight))
    assert shear.g2 == pytest.approx(np.average(shapes["g2"][GOOD], weights=weight))
    cut = float(np.median(shapes["snr"][GOOD]))
    assert estimate_shear(shapes, snr_min=cut).n == 2


def _numbers(table):
    return np.array([table[name] for name in COLUMNS if name not in ("id", "flag")])


@pytest.mark.parametrize("executor", [Threads(2), Copies(2), Copies(3)])
def test_executors_change_no_bit(field, shapes, executor):
    other = measured(field.observation, field.catalogue, resources=Resources(executor))
    np.testing.assert_array_equal(_numbers(other.shapes), _numbers(shapes))


def test_chunks_do_not_matter(shapes):
    field = vla_field(pieces=7)
    other = measured(field.observation, field.catalogue).shapes
    for name in ("e1", "e2", "e_sigma"):
        # measured 1.2e-5, 5e-4 sigma: the gridder's epsilon and single precision. A lost chunk: 1 sigma
        np.testing.assert_allclose(other[name], shapes[name], rtol=0, atol=5e-5)


def test_the_order_of_the_catalogue_does_not_matter(field, shapes):
    order = np.array([5, 3, 1, 6, 0, 2, 4])
    other = measured(field.observation, field.catalogue.select(order)).shapes
    assert other["id"].tolist() == [f"s{k}" for k in order]
    for name in ("e1", "e2", "flux_fit"):
        np.testing.assert_allclose(other[name], shapes[name][order], rtol=1e-4, atol=5e-5)


def test_short_baselines_cut_change_shapes_but_not_the_natural_snr(field, shapes):
    method = replace(METHOD, uv_range=UvRange(6e3))
    cut = measured(field.observation, field.catalogue, method=method)
    assert cut.record["uv_range"][0] == 6e3
    row, whole = cut.shapes[GOOD], shapes[GOOD]
    assert np.all(row["e1"] != whole["e1"])
    assert np.all(row["e_sigma"] > whole["e_sigma"])
    # measured 0.4 per cent: another shape fitted
    np.testing.assert_allclose(row["snr"], whole["snr"], rtol=0.02)


def test_progress_ends_where_it_said(field):
    heard = []
    measured(field.observation, field.catalogue, progress=lambda *x: heard.append(x))
    done, total = np.array(heard).T
    assert np.all(np.diff(done) >= 0)
    assert np.all(done <= total)
    assert done[-1] == total[-1]


def test_the_papers_extraction_measures_the_same_field(field, shapes):
    method = replace(METHOD, extraction=PaperExtraction(CellAverageFacets()))
    other = measured(field.observation, field.catalogue, method=method).shapes
    assert other["flag"].tolist() == shapes["flag"].tolist()
    difference = np.hypot(other["e1"] - shapes["e1"], other["e2"] - shapes["e2"])[GOOD]
    assert np.all(difference < 0.05)
    assert np.any(difference > 1e-4)


@SOURCES_LEFT
def test_a_field_of_point_sources_alone_has_no_shapes(field):
    table = measured(field.observation, field.catalogue.select(np.array([1]))).shapes
    assert table["flag"].tolist() == ["point_source"]
    assert np.isnan(table["e1"][0])


def test_a_uv_range_without_data_is_flagged(field):
    method = replace(METHOD, uv_range=UvRange(1e3, 1.001e3))
    with pytest.warns(NothingMeasuredWarning, match="no_data"):
        table = measured(
            field.observation, field.catalogue.select(np.array([0])), method=method
        ).shapes
    assert table["flag"].tolist() == ["no_data"]


def test_an_observation_without_weight_is_an_error(field):
    blocks = tuple(replace(b, weights=0 * b.weights) for b in field.observation.blocks)
    with pytest.raises(InputError, match="no visibility carries weight"):
        measured(replace(field.observation, blocks=blocks), field.catalogue)


def test_the_sky_that_was_found_leaves_noise(field, measurement):
    """Every modelled source is in it, fitted or not: without the point source 9 sigma^2 would be left."""
    assert measurement.sky.identifier.tolist() == ["s0", "s1", "s2", "s3", "s5"]
    sky = measurement.sky.galaxies(field.observation.phase_centre)
    left = np.concatenate(
        [
            np.abs(b.stokes_i - predict_visibilities(sky, b.uvw, FREQUENCY))[b.weights > 0]
            for b in field.observation.blocks
        ]
    )
    assert np.mean(left**2) == pytest.approx(2 * SIGMA**2, rel=0.05)


@pytest.mark.filterwarnings("ignore:.*the noise is at most")  # there is none
@pytest.mark.parametrize("bearing", [20.0, 110.0, 255.0])
def test_shapes_at_declination_80_are_right_in_both_frames(bearing):
    """A galaxy 0.7 degrees off-centre, its long axis at 30 degrees from North through East."""
    uvw, centre = vla("b", dec=80.0, samples=3)
    middle = SkyCoord(centre.ra * units.rad, centre.dec * units.rad)
    place = middle.directional_offset_by(bearing * units.deg, 0.7 * units.deg)
    tip = place.directional_offset_by(30 * units.deg, 5 * units.arcsec)
    wcs = WCS(naxis=2)
    wcs.wcs.ctype = ["RA---SIN", "DEC--SIN"]
    wcs.wcs.crval = np.degrees([centre.ra, centre.dec])
    wcs.wcs.cdelt = [1.0, 1.0]
    (l, l_tip), (m, m_tip) = np.radians(
        wcs.wcs_world2pix([place.ra.deg, tip.ra.deg], [place.dec.deg, tip.dec.deg], 1)
    )
    e = 0.4 * np.exp(2j * np.arctan2(m_tip - m, l_tip - l))
    sky = galaxies(l, m, 1e-2, 2 * ARCSEC, e)
    catalogue = catalogue_of_sky(sky, centre, np.array([place.ra.rad]), np.array([place.dec.rad]))
    method = replace(METHOD, field_radius=np.radians(1.0))
    row = measured(observe(sky, uvw, centre), catalogue, method=method).shapes[0]
    assert row["flag"] == "ok"
    # measured 7e-7
    assert abs(row["e1"] + 1j * row["e2"] - e) < 2e-5
    # measured 2e-3 degrees: the foreshortening; the (l, m) frame taken for the sky's: 1.5 to 3.8
    assert row["position_angle"] == pytest.approx(30, abs=0.01)
    assert row["l"] == pytest.approx(l, abs=1e-12)
    assert row["m"] == pytest.approx(m, abs=1e-12)
    # TreeCorr's axes: g1 + i g2 = conj(e in axes local East and North)
    g = 0.4 * np.exp(-2j * np.radians(60))
    assert abs(row["g1"] + 1j * row["g2"] - g) < 2e-4


def test_a_catalogue_off_by_an_arcsecond_is_corrected_by_the_offset(field):
    near = field.catalogue.select(np.array([0, 1, 2, 3, 5]))
    l, m, _ = near.directions(field.observation.phase_centre)
    first = np.arange(len(l)) == 0
    off = replace(near, ra=None, dec=None, l=l - 0.8 * ARCSEC * first, m=m + 0.5 * ARCSEC * first)
    row = measured(field.observation, off).shapes[0]
    assert row["flag"] == "ok"
    # its neighbours are not in this catalogue, and the noise is there: measured 0.02
    assert row["dl"] == pytest.approx(0.8, abs=0.2)
    assert row["dm"] == pytest.approx(-0.5, abs=0.2)


@SOURCES_LEFT
def test_the_phase_centre_of_the_observation_is_that_of_the_directions(field):
    moved = replace(field.observation, phase_centre=PhaseCentre(1.0 + 1e-3, np.radians(40.0)))
    with pytest.warns(NothingMeasuredWarning, match="off_position"):
        table = measured(moved, field.catalogue.select(np.array([0]))).shapes
    assert table["l"][0] == pytest.approx(-1e-3 * np.cos(np.radians(40)), rel=1e-4)


class StopError(Exception):
    """The work has begun."""


@pytest.mark.parametrize("extraction", [ConvergedExtraction(), PaperExtraction()])
def test_warnings_about_the_data_come_before_the_work(field, monkeypatch, extraction):
    def begin(*_args, **_more):
        raise StopError

    monkeypatch.setattr(type(extraction), "extract", begin)
    heard = []
    blocks = [
        replace(block, uvw=-block.uvw, stokes_i=block.stokes_i.copy())
        for block in field.observation.blocks
    ]
    blocks[0].stokes_i[1, 1] = np.nan
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        with pytest.raises(StopError):
            measured(
                replace(field.observation, blocks=tuple(blocks)),
                field.catalogue,
                method=replace(METHOD, extraction=extraction),
                progress=lambda *x: heard.append(x),
            )
    assert heard == []
    assert [warning.category for warning in told] == [DataWarning] * 2
    assert "1 of 4212 visibilities are NaN or infinite" in str(told[0].message)
    assert "if UVW is taken with the opposite sign" in str(told[1].message)


def test_a_check_of_the_data_that_fails_is_told_and_changes_nothing(field, shapes, monkeypatch):
    def fail(*_args):
        raise ZeroDivisionError("one\nand two")

    checked = {
        "weight_warnings": "the weights",
        "sign_warnings": "the sign of UVW",
        "flux_warnings": "the unit of the catalogue's fluxes",
        "noise_warnings": "the noise",
    }
    for name in checked:
        monkeypatch.setattr(DataChecks, name, fail)
    with pytest.warns(DataWarning) as told:
        found = measured(field.observation, field.catalogue).shapes
    assert [str(warning.message).partition(";")[0] for warning in told] == [
        f"{what} could not be checked (ZeroDivisionError: one and two)" for what in checked.values()
    ]
    for name in shapes.colnames:
        np.testing.assert_array_equal(found[name], shapes[name])


class Untouchable:
    """An observation that must not be read."""

    phase_centre = PhaseCentre(0.0, 0.0)

    def chunks(self):
        raise AssertionError("the observation was read")


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        (
            {"keep": "moment"},
            "'moment' is not a known estimator; the known names are mean, moments, bayesian, metacal",
        ),
        ({"keep": ("moments", "spin")}, "'spin' is not a known estimator"),
        ({"keep": "absent:Mine"}, "the estimator 'absent:Mine' cannot be imported"),
        (
            {"keep": "moments", "method": replace(METHOD, extraction=PaperExtraction())},
            "PaperExtraction keeps no statistics",
        ),
    ],
)
def test_what_is_wrong_is_refused_before_the_observation_is_read(field, wrong, message):
    with pytest.raises(InputError, match=message):
        measured(Untouchable(), field.catalogue, **wrong)


@SOURCES_LEFT
def test_the_mean_needs_nothing_kept(field):
    """It may be asked for with every extraction."""
    few = field.catalogue.select(np.array(GOOD))
    method = replace(METHOD, extraction=PaperExtraction())
    found = measured(field.observation, few, keep="mean", method=method)
    assert found.statistics is None
