"""Reading Measurement Sets."""

import pickle
import resource
from dataclasses import replace

import numpy as np
import pytest
from casacore import tables

from tests.io.measurement_sets import PHASE_CENTRE, change, real_set, simulated, written
from uvshear.constants import SPEED_OF_LIGHT
from uvshear.errors import InputError
from uvshear.interferometer.accumulate import accumulate, show
from uvshear.interferometer.count_samples import SampleCountsAccumulator
from uvshear.interferometer.stokes import Hands
from uvshear.interferometer.summary import SummaryAccumulator
from uvshear.interferometer.visibilities import Observation
from uvshear.io.measurement_set.observation import MeasurementSet
from uvshear.io.measurement_set.writer import write_measurement_set


@pytest.fixture
def path(tmp_path):
    return written(tmp_path)


def _all(observation):
    """Stokes I, weights and UVW of everything."""
    chunks = list(observation.chunks())
    return tuple(
        np.concatenate([getattr(chunk, name) for chunk in chunks])
        for name in ("stokes_i", "weights", "uvw")
    )


def counts(measured):
    """Numbers of samples of everything in the set, including what ``chunks`` refuses."""
    accumulator = SampleCountsAccumulator()
    show(measured.unchecked_chunks(), [accumulator])
    return accumulator.result()


def _edit(path, subtable=""):
    return tables.table(str(path / subtable), readonly=False, ack=False)


def test_what_was_simulated_is_read(path):
    observation = simulated()
    measured = MeasurementSet(path)
    assert isinstance(measured, Observation)
    assert measured.phase_centre == PHASE_CENTRE
    for read, expected in zip(_all(measured), _all(observation), strict=True):
        np.testing.assert_allclose(read, expected, rtol=1e-6)
    np.testing.assert_array_equal(next(measured.chunks()).frequency, observation.channels.frequency)
    np.testing.assert_array_equal(measured.spectral_windows[0].width, observation.channels.width)


def test_the_number_of_samples_is_known_before_they_are_read(path):
    observation = MeasurementSet(path)
    read = sum(chunk.stokes_i.size for chunk in observation.unchecked_chunks())
    assert observation.expected_samples() == read


def test_chunks_can_be_read_again_and_kept(path):
    measured = MeasurementSet(path, memory=4096)
    first, second = list(measured.chunks()), list(measured.chunks())
    assert len(first) > 10
    for one, other in zip(first, second, strict=True):
        np.testing.assert_array_equal(one.stokes_i, other.stokes_i)
    # kept chunks are not overwritten by the buffers of later ones
    np.testing.assert_allclose(
        np.concatenate([chunk.stokes_i for chunk in first]), _all(simulated())[0], rtol=1e-6
    )


def test_it_pickles_without_an_open_table(path):
    measured = MeasurementSet(path)
    iterator = measured.chunks()
    next(iterator)
    again = pickle.loads(pickle.dumps(measured))
    for one, other in zip(_all(again), _all(measured), strict=True):
        np.testing.assert_array_equal(one, other)


def test_it_is_sent_with_its_whole_path(path, monkeypatch, tmp_path):
    monkeypatch.chdir(path.parent)
    message = pickle.dumps(MeasurementSet(path.name))
    monkeypatch.chdir(tmp_path)
    received = pickle.loads(message)
    assert received.path == path
    assert len(list(received.chunks())) > 0


def test_circular_hands_give_the_same(path, tmp_path):
    circular = tmp_path / "circular.ms"
    write_measurement_set(circular, simulated(), hands=Hands.CIRCULAR)
    for one, other in zip(_all(MeasurementSet(circular)), _all(MeasurementSet(path)), strict=True):
        np.testing.assert_array_equal(one, other)


def test_memory_does_not_grow_with_rows(path):
    assert MeasurementSet(path, memory=2**20).rows_per_chunk * 4 * 2 * 32 < 2**20
    assert max(len(chunk) for chunk in MeasurementSet(path, memory=32_000).chunks()) == 100


def test_buffers_are_what_is_held(tmp_path):
    """Reading 60 MB a hundred kilobytes at a time takes no 60 MB."""
    path = tmp_path / "long.ms"
    write_measurement_set(path, simulated(layout="ska-mid-aa2", channels=16))
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    for _ in MeasurementSet(path, memory=10**5).chunks():
        pass
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 20_000


# Flags and weights


def test_flags_flag_rows_and_nan_have_no_weight_and_are_counted(path):
    with _edit(path) as main:
        flags, values = main.getcol("FLAG"), main.getcol("DATA")
        weights = main.getcol("WEIGHT_SPECTRUM")
        flags[0, 1, 0] = True
        flags[1, 2] = True
        values[2, 3, 1] = np.nan
        values[1, 2, 0] = np.nan  # flagged: not counted
        weights[3, 0, 0] = 0
        weights[4, 0, 1] = -1
        main.putcol("FLAG", flags)
        main.putcol("DATA", values)
        main.putcol("WEIGHT_SPECTRUM", weights)
        main.putcell("FLAG_ROW", 7, True)
        main.putcell("FLAG_ROW", 8, False)
    measured = MeasurementSet(path)
    stokes_i, read, _ = _all(measured)
    expected = np.zeros(read.shape, dtype=bool)
    expected[[0, 1, 2, 3, 4], [1, 2, 3, 0, 0]] = True
    expected[7] = True
    np.testing.assert_array_equal(read == 0, expected)
    assert np.isfinite(stokes_i).all()
    summary = counts(measured)
    assert summary.rows == 1680
    assert summary.samples == 1680 * 4
    assert summary.flagged == 6
    assert summary.flagged_fraction == 6 / (1680 * 4)
    assert (summary.non_finite, summary.non_positive_weights) == (1, 2)
    assert summary.usable == 1680 * 4 - 9


def test_weights_fall_back_to_weight_then_sigma(path):
    expected = _all(MeasurementSet(path))[1]
    with _edit(path) as main:
        main.removecols("WEIGHT_SPECTRUM")
    assert MeasurementSet(path).header.weight_column == "WEIGHT"
    np.testing.assert_allclose(_all(MeasurementSet(path))[1], expected, rtol=1e-6)
    change(path, "WEIGHT", 0)
    assert MeasurementSet(path).header.weight_column == "SIGMA"
    np.testing.assert_allclose(_all(MeasurementSet(path))[1], expected, rtol=1e-6)
    change(path, "SIGMA", 0)
    with pytest.raises(InputError, match="no positive weights in WEIGHT_SPECTRUM, WEIGHT, SIGMA"):
        MeasurementSet(path)


def test_a_weight_spectrum_of_zeros_counts_as_not_filled(path):
    expected = _all(MeasurementSet(path))[1]
    change(path, "WEIGHT_SPECTRUM", 0)
    np.testing.assert_allclose(_all(MeasurementSet(path))[1], expected, rtol=1e-6)


def test_a_weight_spectrum_never_written_counts_as_not_filled(path):
    expected = _all(MeasurementSet(path))[1]
    with _edit(path) as main:
        main.removecols("WEIGHT_SPECTRUM")
        main.addcols(
            tables.maketabdesc(
                tables.makearrcoldesc("WEIGHT_SPECTRUM", 0.0, ndim=2, valuetype="float")
            )
        )
    np.testing.assert_allclose(_all(MeasurementSet(path))[1], expected, rtol=1e-6)


def test_autocorrelations_are_left_out(path):
    everything = _all(MeasurementSet(path))
    change(path, "ANTENNA2", 0, rows=slice(0, 7))  # baselines 0-1 to 0-7
    measured = MeasurementSet(path)
    for one, other in zip(_all(measured), everything, strict=True):
        np.testing.assert_array_equal(one, other[7:])
    assert counts(measured).autocorrelations == 7


def test_uvw_is_used_as_stored(path):
    with _edit(path) as main:
        main.putcol("UVW", -main.getcol("UVW"))
    np.testing.assert_array_equal(_all(MeasurementSet(path))[2], -simulated().coverage.uvw)


# Several columns, fields and spectral windows


def test_another_column_is_read(path):
    with _edit(path) as main:
        main.addcols(
            tables.maketabdesc(
                tables.makearrcoldesc("CORRECTED_DATA", 0j, ndim=2, valuetype="complex")
            )
        )
        main.putcol("CORRECTED_DATA", 2 * main.getcol("DATA"))
    corrected = _all(MeasurementSet(path, column="CORRECTED_DATA"))
    np.testing.assert_allclose(corrected[0], 2 * _all(MeasurementSet(path))[0])


def _add_field(path, rows):
    with _edit(path, "FIELD") as field:
        field.copyrows(field)
        field.putcell("NAME", 1, "other")
        direction = field.getcell("PHASE_DIR", 1)
        direction[0, 0] = 2.0
        field.putcell("PHASE_DIR", 1, direction)
    change(path, "FIELD_ID", 1, rows=rows)


@pytest.mark.parametrize("rows", [slice(0, None, 3), slice(100, 300)])
def test_one_of_several_fields_is_chosen_by_number_or_name(path, rows):
    everything = _all(MeasurementSet(path))
    _add_field(path, rows)
    with pytest.raises(InputError, match=r"several fields, 0 \(simulated\), 1 \(other\); choose"):
        MeasurementSet(path)
    for field in (1, "other"):
        other = MeasurementSet(path, field=field)
        assert other.phase_centre.ra == 2.0
        for one, expected in zip(_all(other), everything, strict=True):
            np.testing.assert_array_equal(one, expected[rows])
    with pytest.raises(
        InputError, match=r"no rows of field 5; the fields with rows are 0 \(simulated\), 1"
    ):
        MeasurementSet(path, field=5)


def test_fields_without_rows_do_not_matter(path):
    _add_field(path, slice(0, None))
    measured = MeasurementSet(path)
    assert measured.phase_centre.ra == 2.0
    assert len(_all(measured)[0]) == 1680


@pytest.mark.parametrize("memory", [2**28, 20_000])
@pytest.mark.parametrize("rows", [slice(0, None, 2), slice(1000, None)])
def test_each_chunk_has_one_spectral_window(path, rows, memory):
    everything = _all(MeasurementSet(path))
    with _edit(path, "SPECTRAL_WINDOW") as window:
        window.copyrows(window)
        window.putcell("CHAN_FREQ", 1, 2 * window.getcell("CHAN_FREQ", 1))
        window.putcell("CHAN_WIDTH", 1, -window.getcell("CHAN_WIDTH", 1))
    with _edit(path, "DATA_DESCRIPTION") as description:
        description.copyrows(description)
        description.putcell("SPECTRAL_WINDOW_ID", 1, 1)
    change(path, "DATA_DESC_ID", 1, rows=rows)
    found = {}
    for chunk in MeasurementSet(path, memory=memory).chunks():
        found.setdefault(chunk.frequency[0], []).append(chunk)
    first, second = sorted(found)
    assert second == 2 * first
    read = np.concatenate([chunk.stokes_i for chunk in found[second]])
    np.testing.assert_array_equal(read, everything[0][rows])
    assert sum(len(chunk) for chunk in found[first]) == 1680 - len(read)


# What is wrong is named


def test_a_lost_data_file_is_one_line(path):
    for part in path.glob("table.f*_TSM*"):
        part.unlink()
    with pytest.raises(InputError, match=r"field\.ms: .* cannot be read") as caught:
        list(MeasurementSet(path).chunks())
    assert "\n" not in str(caught.value)


def test_all_flagged_is_an_error(path):
    change(path, "FLAG", True)
    with pytest.raises(InputError, match=r"field\.ms: all visibilities are flagged"):
        list(MeasurementSet(path).chunks())
    assert counts(MeasurementSet(path)).flagged_fraction == 1


def test_all_nan_is_an_error(path):
    change(path, "DATA", np.nan)
    with pytest.raises(
        InputError, match=r"no visibility is usable: of 6720 visibilities, 0 are flagged, 6720"
    ):
        list(MeasurementSet(path).chunks())


def test_autocorrelations_alone_are_an_error(path):
    change(path, "ANTENNA1", 0)
    change(path, "ANTENNA2", 0)
    with pytest.raises(InputError, match="there are only autocorrelations in the field"):
        list(MeasurementSet(path).chunks())


def test_scans_of_another_field_are_named(path):
    with _edit(path) as main:
        later = (np.arange(main.nrows()) > 0).astype(np.int32)
        main.putcol("FIELD_ID", later)
        main.putcol("SCAN_NUMBER", 1 + 2 * later)
    with _edit(path, "FIELD") as fields:
        fields.copyrows(fields)
    with pytest.raises(InputError, match="there are no rows in scans 3 of the field"):
        list(MeasurementSet(path, field=0, scans=(3,)).chunks())


def _direct(path, rows=slice(None)):
    """Stokes I and weights, read in the plainest way."""
    with tables.table(str(path), ack=False) as main:
        values = main.getcol("DATA")[rows].astype(complex)
        weights = main.getcol("WEIGHT_SPECTRUM")[rows].astype(float)
        flags = main.getcol("FLAG")[rows] | main.getcol("FLAG_ROW")[rows][:, None, None]
        uvw = main.getcol("UVW")[rows]
    good = ~(flags[..., 0] | flags[..., 3]) & (weights[..., 0] > 0) & (weights[..., 3] > 0)
    stokes_i = (values[..., 0] + values[..., 3]) / 2
    with np.errstate(divide="ignore"):
        weight = 4 / (1 / weights[..., 0] + 1 / weights[..., 3])
    return np.where(good, stokes_i, 0), np.where(good, weight, 0), uvw


@pytest.mark.real
@pytest.mark.parametrize(
    ("archive", "samples", "types"),
    [
        ("day2_TDEM0003_10s_norx_1src_1spw.ms.tar.gz", (1360, 64), "circular"),
        ("tOSKAR.in_MS.tgz", (27000, 1), "linear"),
    ],
)
def test_a_real_set_is_read(tmp_path, archive, samples, types):
    path = real_set(tmp_path, archive)
    measured = MeasurementSet(path, memory=2**20)
    read = _all(measured)
    assert read[0].shape == samples
    for one, expected in zip(read, _direct(path), strict=True):
        np.testing.assert_allclose(one, expected, rtol=2e-6, atol=1e-12)
    summary = counts(measured)
    assert summary.usable == summary.samples == samples[0] * samples[1]


@pytest.mark.real
def test_a_real_meerkat_set_is_all_flagged(tmp_path):
    path = real_set(tmp_path, "tDish.MS.tgz")
    with pytest.raises(InputError, match="all visibilities are flagged"):
        list(MeasurementSet(path).chunks())


@pytest.mark.real
def test_a_real_meerkat_set_is_read_once_unflagged(tmp_path):
    path = real_set(tmp_path, "tDish.MS.tgz")
    change(path, "FLAG", False)
    change(path, "FLAG_ROW", False)
    measured = MeasurementSet(path)
    with tables.table(str(path), ack=False) as main:
        cross = np.flatnonzero(main.getcol("ANTENNA1") != main.getcol("ANTENNA2"))
    for one, expected in zip(_all(measured), _direct(path, cross), strict=True):
        np.testing.assert_allclose(one, expected, rtol=2e-6, atol=1e-6)
    assert counts(measured).autocorrelations == 310


def test_a_row_without_uvw_is_left_out_and_counted(tmp_path):
    path = written(tmp_path)
    expected = counts(MeasurementSet(path))
    change(path, "UVW", np.nan, rows=[5])
    assert counts(MeasurementSet(path)) == replace(
        expected, usable=expected.usable - 4, impossible_uvw=4
    )


def test_a_row_longer_than_its_baseline_or_the_array_is_left_out_and_counted(tmp_path):
    path = written(tmp_path)
    expected = counts(MeasurementSet(path))
    lengths = np.linalg.norm(np.concatenate([c.uvw for c in MeasurementSet(path).chunks()]), axis=1)
    with tables.table(str(path), ack=False) as main:
        own = np.linalg.norm(main.getcell("UVW", 5))
    assert own < 0.9 * lengths.max()
    for length, others in ((own, 0), (lengths.max(), 4), (1.05 * lengths.max(), 4)):
        change(path, "UVW", [0, length, 0], rows=[5])
        assert counts(MeasurementSet(path)).impossible_uvw == others
    (summary,) = accumulate(MeasurementSet(path), [SummaryAccumulator()])
    assert summary.samples == expected.usable - 4
    assert summary.longest <= lengths.max() * summary.frequency / SPEED_OF_LIGHT


def test_flags_can_be_left_unheeded(tmp_path):
    path = written(tmp_path)
    everything = counts(MeasurementSet(path)).usable
    change(path, "FLAG", True)
    with pytest.raises(InputError, match="all visibilities are flagged"):
        list(MeasurementSet(path).chunks())
    assert counts(MeasurementSet(path, heeds_flags=False)).usable == everything


def test_rows_carry_the_integration_that_they_were_averaged_over(tmp_path):
    coverage = simulated().coverage
    path = written(tmp_path, is_averaged=True)
    chunks = list(MeasurementSet(path, memory=2**14).chunks())
    taken = [chunk.integrations for chunk in chunks]
    assert len(taken) > 1
    antennas = np.concatenate([integrations.antennas for integrations in taken])
    np.testing.assert_array_equal(antennas[:, 0], coverage.antenna1)
    np.testing.assert_array_equal(antennas[:, 1], coverage.antenna2)
    times = np.concatenate([integrations.time for integrations in taken])
    np.testing.assert_allclose(times, coverage.time)
    assert all(np.all(integrations.interval == 60) for integrations in taken)
    np.testing.assert_allclose(chunks[0].width, simulated().channels.width)


def test_a_simulation_of_single_times_and_frequencies_was_not_averaged(tmp_path):
    (chunk, *_) = MeasurementSet(written(tmp_path)).chunks()
    assert not chunk.integrations.interval.any()
    assert not chunk.width.any()


def test_a_set_without_effective_bandwidths_is_averaged_over_its_channels(tmp_path):
    path = written(tmp_path)
    change(path, "EFFECTIVE_BW", np.nan, subtable="SPECTRAL_WINDOW")
    (chunk, *_) = MeasurementSet(path).chunks()
    np.testing.assert_allclose(chunk.width, simulated().channels.width)


def test_the_counts_of_chunks_add_up_to_those_of_the_set(tmp_path):
    path = written(tmp_path)
    change(path, "FLAG", True, rows=slice(0, 100))
    data = MeasurementSet(path, memory=2**14)
    (total,) = accumulate(data, [SampleCountsAccumulator()])
    assert total == counts(MeasurementSet(path))
    assert total.flagged == 400


def test_a_set_tells_its_dishes_and_where_they_pointed(tmp_path):
    data = MeasurementSet(written(tmp_path))
    np.testing.assert_array_equal(data.dish_diameters(), simulated().dish_diameters())
    assert data.pointing_direction() == PHASE_CENTRE


def test_a_time_that_is_none_is_that_of_the_centroid(tmp_path):
    path = written(tmp_path)
    expected = np.concatenate([seen.integrations.time for seen in MeasurementSet(path).chunks()])
    change(path, "TIME", np.nan, rows=slice(3, 5))
    found = np.concatenate([seen.integrations.time for seen in MeasurementSet(path).chunks()])
    np.testing.assert_array_equal(found, expected)
    change(path, "TIME_CENTROID", np.inf, rows=slice(4, 5))
    seen = next(iter(MeasurementSet(path).chunks()))
    assert np.flatnonzero(~np.isfinite(seen.integrations.time)).tolist() == [4]


def test_a_good_set_has_no_notices(tmp_path):
    data = MeasurementSet(written(tmp_path))
    assert data.notices() == ()
    assert data.origin().name == str(data.path)


def test_the_opposite_sign_of_uvw_is_no_notice(tmp_path):
    """It is usual for some telescopes (LOFAR, WSRT), whose visibilities have the opposite phase too."""
    path = written(tmp_path)
    with _edit(path) as main:
        main.putcol("UVW", -main.getcol("UVW"))
    data = MeasurementSet(path)
    assert data.uvw_agrees() is False
    assert data.notices() == ()


def test_the_two_hands_tell_the_noise(tmp_path):
    """As they do in the simulation that was written."""
    powers = [
        np.concatenate([seen.hand_powers for seen in data.chunks()])
        for data in (MeasurementSet(written(tmp_path)), simulated())
    ]
    np.testing.assert_allclose(*powers, rtol=1e-4)
    assert np.mean(powers[0]) == pytest.approx(2, rel=0.06)  # 4096 samples: 1.6 per cent


def test_weights_from_sigma_are_a_notice(tmp_path):
    path = written(tmp_path)
    for column in ("WEIGHT", "WEIGHT_SPECTRUM"):
        change(path, column, 0.0)
    assert MeasurementSet(path).notices() == (
        "WEIGHT has no value above zero; the weights are 1/SIGMA^2",
    )
