"""Averages as a Measurement Set."""

import numpy as np
import pytest
from casacore import tables

from uvshear.averaging.averager import Group
from uvshear.averaging.cell_table import Averages
from uvshear.averaging.cells import Cells
from uvshear.averaging.dish_pairs import DishPairs
from uvshear.averaging.sub_bands import SubBand
from uvshear.constants import SPEED_OF_LIGHT
from uvshear.errors import InputError
from uvshear.geometry.directions import PhaseCentre
from uvshear.interferometer.averaged_rows import AveragedRows
from uvshear.interferometer.samples import Samples
from uvshear.io.measurement_set import averages_writer
from uvshear.io.measurement_set.averages_writer import AveragedField, new_averages
from uvshear.io.measurement_set.observation import MeasurementSet
from uvshear.io.observations import inspect

BANDS = (SubBand(217), SubBand(220))
ABOUT = AveragedField(
    PhaseCentre(0.3, -0.5),
    PhaseCentre(0.3, -0.501),
    DishPairs.from_diameters([np.array([13.5, 15.0, 15.0])])[0],
    Cells(33.0, 1e4, 0.46),
)


def _averages(rows: int, seed: int, band: SubBand) -> Averages:
    rng = np.random.default_rng(seed)
    return Averages(
        uvw=rng.uniform(-4000, 4000, (rows, 3)),
        stokes_i=(rng.normal(size=rows) + 1j * rng.normal(size=rows)).astype(np.complex64),
        weights=rng.uniform(1e6, 1e8, rows),
        time=5e9 + rng.uniform(0, 3600, rows),
        interval=rng.choice([8.0, 10.0], rows),
        rows=AveragedRows(
            band.frequency * rng.uniform(0.93, 1.07, rows),
            rng.uniform(1e5, 1e6, rows),
            rng.uniform(0, 30, (rows, 6)),
            rng.uniform(0, 900, (rows, 15)),
            np.ones(3),
        ),
    )


CONTENT = (
    (Group(BANDS[0], 0), _averages(70, 1, BANDS[0])),
    (Group(BANDS[1], 1), _averages(50, 2, BANDS[1])),
    (Group(BANDS[0], 3), _averages(30, 3, BANDS[0])),
)


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    target = tmp_path_factory.mktemp("averages") / "compact.ms"
    with pytest.MonkeyPatch.context() as patch, new_averages(target, ABOUT) as writer:
        patch.setattr(averages_writer, "ROWS_AT_A_TIME", 32)
        for group, averages in CONTENT:
            writer.add(group, averages)
        writer.finish("a test")
    return target


def test_what_is_read_is_what_was_written(path):
    observation = MeasurementSet(path)
    assert observation.phase_centre == ABOUT.phase_centre
    assert observation.pointing_direction() == ABOUT.pointing
    chunks = list(observation.chunks())
    for band in BANDS:
        found = [chunk for chunk in chunks if chunk.frequency[0] == band.frequency]
        expected = [averages for group, averages in CONTENT if group.band == band]
        for name in ("uvw", "stokes_i", "weights"):
            read = np.concatenate([np.atleast_2d(getattr(chunk, name).T).T for chunk in found])
            written = np.concatenate([getattr(averages, name) for averages in expected])
            np.testing.assert_allclose(read.squeeze(), written, rtol=1e-6)
        for name in ("frequency", "width", "second", "fourth"):
            read = np.concatenate([getattr(chunk.averages, name) for chunk in found])
            written = np.concatenate([getattr(averages.rows, name) for averages in expected])
            np.testing.assert_allclose(read, written, rtol=1e-6)
        interval = np.concatenate([chunk.integrations.interval for chunk in found])
        np.testing.assert_array_equal(
            interval, np.concatenate([averages.interval for averages in expected])
        )


def test_samples_have_baselines_and_moments_in_wavelengths_and_their_own_frequency(path):
    chunk = next(MeasurementSet(path).chunks())
    samples = Samples.from_visibilities(chunk, 0, np.inf)
    scale = chunk.frequency[0] / SPEED_OF_LIGHT
    np.testing.assert_allclose(samples.uvw, chunk.uvw * scale)
    np.testing.assert_allclose(samples.scatter[:, :6], chunk.averages.second * scale**2, rtol=1e-6)
    np.testing.assert_allclose(samples.scatter[:, 6:], chunk.averages.fourth * scale**4, rtol=1e-6)
    np.testing.assert_array_equal(samples.frequency, chunk.averages.frequency)
    np.testing.assert_allclose(samples.bandwidth, chunk.averages.width, rtol=1e-6)


def test_two_antennas_stand_for_each_kind_of_dish(path):
    observation = MeasurementSet(path)
    np.testing.assert_array_equal(observation.dish_diameters(), [13.5, 13.5, 15.0, 15.0])
    with tables.table(str(path), ack=False) as main:
        antennas = np.column_stack([main.getcol("ANTENNA1"), main.getcol("ANTENNA2")])
    found = [np.unique(part, axis=0).tolist() for part in np.split(antennas, [70, 120])]
    assert found == [[[0, 1]], [[0, 3]], [[2, 3]]]


def test_all_that_a_measurement_set_must_have_is_there(path):
    with tables.table(str(path), ack=False) as main:
        assert main.nrows() == 150
        assert set(tables.required_ms_desc("MAIN")) - {"_define_hypercolumn_", "_keywords_"} <= {
            *main.colnames(),
            "_private_keywords_",
        }
        for name in ("ANTENNA", "FIELD", "SPECTRAL_WINDOW", "POLARIZATION", "DATA_DESCRIPTION"):
            assert tables.table(main.getkeyword(name), ack=False).nrows() > 0
        assert main.getkeyword(averages_writer.KEYWORD) == {"UV": 33.0, "W": 1e4}


def test_info_says_that_the_rows_are_averages(path):
    (content,) = inspect(path).fields
    assert content.has_averages
    assert content.uvw_agrees is None
    assert not content.warnings


def test_an_error_leaves_nothing(tmp_path):
    def fail() -> None:
        with new_averages(tmp_path / "compact.ms", ABOUT) as writer:
            writer.add(*CONTENT[0])
            raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        fail()
    assert not list(tmp_path.iterdir())


def test_another_output_is_not_replaced_unless_asked_for(path):
    with pytest.raises(InputError, match="exists"), new_averages(path, ABOUT):
        pass
