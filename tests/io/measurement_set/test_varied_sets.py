"""The same visibilities however they are stored give the same shapes."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from casacore.tables import makearrcoldesc, makecoldesc, maketabdesc, table

from tests.io.measurement_set.varied_sets import CIRCULAR, LINEAR, Window, write_varied
from tests.io.measurement_sets import real_set
from tests.skies import galaxies
from uvshear.constants import ARCSEC
from uvshear.errors import InputError
from uvshear.execution import Resources, in_threads
from uvshear.extraction import Model
from uvshear.galaxy import CatalogueSize
from uvshear.geometry.directions import PhaseCentre
from uvshear.interferometer.coverage import Track, synthesise
from uvshear.interferometer.layout import load_layout
from uvshear.interferometer.spectral_window import Channels
from uvshear.io.catalogue import catalogue_from_galaxies
from uvshear.io.measurement_set.observation import MeasurementSet
from uvshear.io.observations import inspect, open_observation
from uvshear.io.reading import Reading
from uvshear.pipeline.measure import measure
from uvshear.predict import predict_visibilities

# The visibilities have no noise, and weights that claim some.
pytestmark = pytest.mark.filterwarnings("ignore::uvshear.errors.DataWarning")

CENTRE = PhaseCentre(1.0, -0.5)
BAND = Channels.from_band(1.0e9, 1.256e9, 256)
COVERAGE = synthesise(load_layout("vla-b"), Track.from_clock(CENTRE, ((-900.0, 900.0),), 600.0))
SKY = galaxies(
    l=np.array([1e-3, -6e-4]),
    m=np.array([8e-4, 3e-4]),
    flux=np.array([1e-1, 2e-1]),
    alpha=np.array([2.5, 3.0]) * ARCSEC,
    e=np.array([0.3 - 0.2j, 0.1 + 0.3j]),
)
STOKES_I = predict_visibilities(SKY, COVERAGE.uvw, BAND.frequency, executor=in_threads(2))


def _windows(count):
    parts = np.array_split(np.arange(len(BAND)), count)
    return [
        Window(Channels(BAND.frequency[part], BAND.width[part]), STOKES_I[:, part])
        for part in parts
    ]


def _shapes(path, reading=None):
    return _measured(open_observation(path, reading))


def _measured(observation):
    """Ellipticities of the galaxies, an element each."""
    measurement = measure(
        observation,
        catalogue_from_galaxies(SKY, CENTRE),
        model=Model(size=CatalogueSize()),
        resources=Resources(in_threads(2)),
    )
    return np.stack([measurement.shapes["e1"], measurement.shapes["e2"]], axis=-1)


@pytest.fixture(scope="module")
def usual(tmp_path_factory):
    """One window, two linear correlations, rows sorted by time."""
    path = write_varied(
        tmp_path_factory.mktemp("usual") / "usual.ms", COVERAGE, _windows(1), correlations=(9, 12)
    )
    return _shapes(path)


def test_the_usual_set_gives_the_shapes_that_went_in(usual):
    truth = np.stack([SKY.ellipticity.real, SKY.ellipticity.imag], axis=-1)
    np.testing.assert_allclose(usual, truth, atol=2e-3)


@pytest.mark.parametrize(
    "how",
    [
        {"windows": 4, "correlations": CIRCULAR},
        {"windows": 1, "correlations": LINEAR, "by_baseline": True},
        {"windows": 2, "correlations": (5, 8), "by_baseline": True},
    ],
    ids=["four windows of 64, circular, four", "by baseline, linear, four", "two windows, two"],
)
def test_the_storage_of_visibilities_does_not_matter(usual, tmp_path, how):
    windows = _windows(how["windows"])
    stored = {name: value for name, value in how.items() if name != "windows"}
    path = write_varied(tmp_path / "varied.ms", COVERAGE, windows, **stored)
    assert len(MeasurementSet(path).spectral_windows) == len(windows)
    np.testing.assert_allclose(_shapes(path), usual, atol=1e-4)


def test_windows_in_files_of_their_own_are_one_observation(usual, tmp_path):
    paths = [
        write_varied(tmp_path / f"{k}.ms", COVERAGE, [window], correlations=CIRCULAR)
        for k, window in enumerate(_windows(2))
    ]
    np.testing.assert_allclose(_measured(open_observation(paths)), usual, atol=1e-4)


def _rows(path, **reading):
    return sum(len(chunk) for chunk in MeasurementSet(path, **reading).chunks())


@pytest.fixture
def scanned(tmp_path):
    return write_varied(
        tmp_path / "scans.ms", COVERAGE, _windows(64)[:1], correlations=(9, 12), scans=3
    )


def test_scans_are_chosen(scanned):
    whole = len(COVERAGE)
    assert _rows(scanned) == whole
    assert _rows(scanned, scans=(2,)) == whole // 3
    assert _rows(scanned, scans=(1, 3)) == whole - whole // 3
    with pytest.raises(InputError, match="no rows of scan 7; the scans with rows are 1, 2, 3"):
        MeasurementSet(scanned, scans=(1, 7))


def test_the_other_sign_of_uvw_is_taken_where_it_is_asked_for(scanned):
    (stored,) = MeasurementSet(scanned).chunks()
    (turned,) = MeasurementSet(scanned, conjugates=True).chunks()
    np.testing.assert_array_equal(turned.uvw, -stored.uvw)
    np.testing.assert_array_equal(turned.stokes_i, stored.stokes_i)
    assert inspect(scanned).fields[0].uvw_agrees is True
    assert inspect(scanned, Reading(conjugates=True)).fields[0].uvw_agrees is False


def test_the_oskar_set_agrees_with_its_antennas_once_turned(tmp_path: Path):
    path = real_set(tmp_path, "tOSKAR.in_MS.tgz")
    assert inspect(path).fields[0].uvw_agrees is False
    assert inspect(path, Reading(conjugates=True)).fields[0].uvw_agrees is True


def test_a_model_is_taken_from_the_visibilities(usual, tmp_path):
    """Sources of no catalogue, in MODEL_DATA: with them in the data as well shapes are what they were."""
    path = write_varied(tmp_path / "model.ms", COVERAGE, _windows(1), correlations=(9, 12))
    far = replace(SKY, l=SKY.l + 8e-4, flux=3 * SKY.flux)
    stokes_i = predict_visibilities(far, COVERAGE.uvw, BAND.frequency)
    model = np.repeat(stokes_i[..., None], 2, axis=-1)
    with table(str(path), readonly=False, ack=False) as main:
        description = main.getcoldesc("DATA")
        main.addcols(maketabdesc(makecoldesc("MODEL_DATA", description)))
        main.putcol("MODEL_DATA", model)
        main.putcol("DATA", main.getcol("DATA") + model)
    np.testing.assert_allclose(_shapes(path, Reading(subtracted="MODEL_DATA")), usual, atol=1e-4)
    assert np.abs(_shapes(path) - usual).max() > 1e-3


def test_a_model_that_is_not_there_is_named(tmp_path):
    path = write_varied(tmp_path / "model.ms", COVERAGE, _windows(1), correlations=(9, 12))
    with pytest.raises(
        InputError, match="no column MODEL_DATA; the columns that hold visibilities are DATA"
    ):
        open_observation(path, Reading(subtracted="MODEL_DATA"))


def test_a_model_that_does_not_fit_is_refused(tmp_path):
    path = write_varied(tmp_path / "model.ms", COVERAGE, _windows(1), correlations=(9, 12))
    with pytest.raises(InputError, match="column DATA would be subtracted from itself"):
        open_observation(path, Reading(subtracted="DATA"))
    with table(str(path), readonly=False, ack=False) as main:
        column = makearrcoldesc("MODEL_DATA", 0j, ndim=2, valuetype="complex")
        main.addcols(maketabdesc(column))
        main.putcell("MODEL_DATA", 0, np.zeros((3, 2), complex))
    with pytest.raises(InputError, match=r"MODEL_DATA has \(3, 2\) .* they must be the same"):
        open_observation(path, Reading(subtracted="MODEL_DATA"))
