"""MSv4 stores read as observations, compared with the Measurement Set that they were made from."""

import pickle
from dataclasses import replace

import numpy as np
import pytest
import xarray as xr
from casacore import tables

from tests.io.measurement_set.varied_sets import Window, write_varied
from tests.io.measurement_sets import (
    PHASE_CENTRE,
    averaged_by_baseline,
    change,
    simulated,
    with_rows,
    written,
)
from tests.io.msv4.rows import assert_same, rows_of
from tests.io.msv4_stores import FIELDS, tree_of, write_tree
from uvshear.constants import ARCSEC
from uvshear.errors import InputError
from uvshear.interferometer.accumulate import show
from uvshear.interferometer.count_samples import SampleCountsAccumulator
from uvshear.interferometer.first_pass import first_pass
from uvshear.interferometer.spectral_window import Channels
from uvshear.interferometer.visibilities import Observation
from uvshear.io.measurement_set.observation import MeasurementSet
from uvshear.io.msv4.observation import Msv4Store
from uvshear.io.observations import open_observation
from uvshear.io.reading import Reading


def counts_of(observation):
    accumulator = SampleCountsAccumulator()
    show(observation.unchecked_chunks(), [accumulator])
    return accumulator.result()


@pytest.mark.parametrize("options", [{}, {"zarr_format": 2}, {"is_consolidated": False}])
def test_a_store_has_the_visibilities_of_its_set_to_the_bit(original, write, options):
    store, ms = Msv4Store(write(**options)), MeasurementSet(original)
    assert isinstance(store, Observation)
    assert_same(store, ms)
    assert store.phase_centre == ms.phase_centre
    assert store.pointing_direction() == ms.pointing_direction()
    np.testing.assert_array_equal(store.dish_diameters(), ms.dish_diameters())
    assert store.header.extent == ms.header.extent
    assert store.uvw_agrees() is ms.uvw_agrees() is True
    assert store.notices() == ms.notices() == ()
    assert store.expected_samples() == ms.expected_samples() > 0
    assert counts_of(store) == counts_of(ms)
    np.testing.assert_array_equal(store.spectral_windows[0].width, ms.spectral_windows[0].width)


def test_averages_of_a_simulation_have_their_band_and_time(tmp_path):
    ms = written(tmp_path, is_averaged=True)
    store = Msv4Store(write_tree(tree_of(ms), tmp_path / "store"))
    chunk = next(store.chunks())
    np.testing.assert_array_equal(chunk.width, 60e6)
    np.testing.assert_array_equal(chunk.integrations.interval, 60.0)
    assert_same(store, MeasurementSet(ms))


def test_flags_nan_and_weights_are_counted_as_in_the_set(tmp_path):
    ms = written(tmp_path)
    with tables.table(str(ms), readonly=False, ack=False) as main:
        flags, values = main.getcol("FLAG"), main.getcol("DATA")
        weights, uvw = main.getcol("WEIGHT_SPECTRUM"), main.getcol("UVW")
        flags[0, 1, 0] = True
        values[2, 3, 1] = np.nan
        weights[3, 0, 0] = np.nan
        weights[4, 0, 1] = -1
        uvw[5] = np.nan  # not padding: the row has an exposure
        main.putcol("FLAG", flags)
        main.putcol("DATA", values)
        main.putcol("WEIGHT_SPECTRUM", weights)
        main.putcol("UVW", uvw)
        main.putcell("FLAG_ROW", 7, True)
    store = Msv4Store(write_tree(tree_of(ms), tmp_path / "store"))
    counts = counts_of(store)
    assert counts == counts_of(MeasurementSet(ms))
    assert (counts.rows, counts.flagged, counts.non_finite) == (1680, 5, 2)
    assert first_pass(store).qualities[0].counts.impossible_uvw == 4
    assert_same(replace(store, heeds_flags=False), MeasurementSet(ms, heeds_flags=False))


def test_baselines_that_are_missing_at_some_times_are_no_rows(tmp_path):
    ms = with_rows(written(tmp_path), np.random.default_rng(2).choice(1680, 780, replace=False))
    tree = tree_of(ms)
    assert np.isnan(tree["field_0"]["UVW"].values).any()
    store = Msv4Store(write_tree(tree, tmp_path / "store"))
    assert counts_of(store) == counts_of(MeasurementSet(ms))
    assert counts_of(store).rows == 780
    assert_same(store, MeasurementSet(ms))
    # xarray-ms flags what it pads.
    tree["field_0"]["FLAG"] = tree["field_0"]["FLAG"] | np.isnan(tree["field_0"]["VISIBILITY"].real)
    assert_same(Msv4Store(write_tree(tree, tmp_path / "flagged")), MeasurementSet(ms))


def test_baseline_dependent_averages_keep_their_times(tmp_path):
    """Short baselines are averaged over twice the time of the others, and have times of their own."""
    ms = averaged_by_baseline(tmp_path)
    tree = tree_of(ms)
    assert tree["field_0"].sizes["time"] == 90
    assert_same(Msv4Store(write_tree(tree, tmp_path / "store")), MeasurementSet(ms))
    intervals = rows_of(Msv4Store(tmp_path / "store"))["interval"]
    assert set(intervals.tolist()) == {60.0, 120.0}


def test_autocorrelations_are_left_out_and_counted(tmp_path):
    ms = written(tmp_path)
    change(ms, "ANTENNA2", 0, rows=slice(0, 1))  # 0-0 instead of 0-1 at the first time
    store = Msv4Store(write_tree(tree_of(ms), tmp_path / "store"))
    assert counts_of(store).autocorrelations == 1
    assert_same(store, MeasurementSet(ms))


@pytest.fixture
def varied(tmp_path):
    """Two windows of four correlations, rows sorted by baseline, three scans."""
    coverage = simulated().coverage
    rng = np.random.default_rng(1)
    windows = [
        Window(Channels.from_band(low, high, count), rng.normal(size=(len(coverage), count)) + 0j)
        for low, high, count in ((1.0e9, 1.1e9, 3), (1.2e9, 1.3e9, 2))
    ]
    return write_varied(tmp_path / "varied.ms", coverage, windows, by_baseline=True, scans=3)


def with_processor(ms):
    with tables.table(f"{ms}::PROCESSOR", readonly=False, ack=False) as table:
        table.addrows(1)
        table.putcell("SUB_TYPE", 0, "SIMULATOR")
    return ms


def test_windows_and_correlations_are_those_of_the_set(tmp_path, varied):
    tree = tree_of(with_processor(varied))
    assert [name for name in tree if name.count("_") == 1] == ["field_0", "field_1"]
    store = Msv4Store(write_tree(tree, tmp_path / "store"))
    assert [len(one) for one in store.spectral_windows] == [3, 2]
    assert_same(store, MeasurementSet(varied))
    assert_same(replace(store, scans=(1, 3)), MeasurementSet(varied, scans=(1, 3)))
    with pytest.raises(InputError, match="no rows of scan 4; the scans with rows are 1, 2, 3"):
        replace(store, scans=(2, 4))


def test_axes_may_be_in_another_order_and_correlations_too(original, tree, write):
    turned = tree["field_0"].isel(polarization=[1, 0], frequency=[3, 2, 1, 0])
    order = ("polarization", "baseline_id", "frequency", "time")
    for name in ("VISIBILITY", "WEIGHT", "FLAG"):
        turned[name] = turned[name].transpose(*order)
    turned["UVW"] = turned["UVW"].transpose("uvw_label", "baseline_id", "time")
    tree["field_0"] = turned
    store, ms = rows_of(Msv4Store(write())), rows_of(MeasurementSet(original))
    np.testing.assert_array_equal(store["stokes_i"][:, ::-1], ms["stokes_i"])
    np.testing.assert_array_equal(store["weights"][:, ::-1], ms["weights"])
    np.testing.assert_array_equal(store["uvw"], ms["uvw"])


def test_weights_and_flags_may_lack_axes(original, tree, write):
    partition = tree["field_0"]
    partition["WEIGHT"] = partition["WEIGHT"].isel(frequency=0)
    del partition["FLAG"]
    found = next(Msv4Store(write()).chunks())
    np.testing.assert_array_equal(found.weights, np.repeat(found.weights[:, :1], 4, axis=1))
    expected = next(MeasurementSet(original).chunks())
    np.testing.assert_array_equal(found.weights[:, 0], expected.weights[:, 0])


def test_bits_of_flags_all_count(tree, write):
    flags = np.zeros(tree["field_0"]["FLAG"].shape, np.uint8)
    flags[0, 0, 0, 0], flags[0, 1, 0, 0] = 1, 64
    tree["field_0"]["FLAG"] = (tree["field_0"]["FLAG"].dims, flags)
    assert counts_of(Msv4Store(write())).flagged == 2


def test_sigma_stands_in_for_weights_that_are_not_filled(original, tree, write):
    partition = tree["field_0"]
    partition["SIGMA_SPECTRUM"] = 1 / np.sqrt(partition["WEIGHT"])
    partition["WEIGHT"] = 0 * partition["WEIGHT"]
    store = Msv4Store(write())
    assert store.notices() == (
        "WEIGHT has no value above zero; the weights are 1/SIGMA_SPECTRUM^2",
    )
    expected = rows_of(MeasurementSet(original))["weights"]
    np.testing.assert_allclose(rows_of(store)["weights"], expected, rtol=1e-6)


def test_weights_that_are_not_filled_are_refused(tree, write):
    tree["field_0"]["WEIGHT"] = 0 * tree["field_0"]["WEIGHT"]
    with pytest.raises(InputError, match=r"no positive weights in WEIGHT; it must hold 1/sigma\^2"):
        Msv4Store(write())


def test_a_time_of_0_beside_averaged_channels_is_the_nominal_time(tree, write):
    tree["field_0"].attrs["processor_info"] = {"type": "CORRELATOR", "sub_type": ""}
    store = Msv4Store(write())
    chunk = next(store.chunks())
    np.testing.assert_array_equal(chunk.width, 60e6)
    np.testing.assert_array_equal(chunk.integrations.interval, 60.0)
    (notice,) = store.notices()
    assert notice.startswith("EFFECTIVE_INTEGRATION_TIME is 0 although the channels are averages")


@pytest.mark.parametrize("lacking", [0.0, -60.0, np.nan, np.inf])
def test_times_that_cannot_be_are_the_nominal_time(tree, write, lacking):
    tree["field_0"].attrs["processor_info"] = {"type": "CORRELATOR", "sub_type": ""}
    times = tree["field_0"]["EFFECTIVE_INTEGRATION_TIME"]
    values = np.full(times.shape, 20.0)
    values[0, 0] = lacking
    tree["field_0"]["EFFECTIVE_INTEGRATION_TIME"] = (times.dims, values)
    interval = next(Msv4Store(write()).chunks()).integrations.interval
    np.testing.assert_array_equal(np.sort(interval)[-2:], [20.0, 60.0])


def test_oddities_of_channels_are_told_as_those_of_a_set(tmp_path, tree, write):
    ms = written(tmp_path)
    frequency = tree["field_0"]["frequency"].values.copy()
    frequency[2] = frequency[1] + 1e6
    tree["field_0"]["frequency"] = ("frequency", frequency, tree["field_0"]["frequency"].attrs)
    with tables.table(f"{ms}::SPECTRAL_WINDOW", readonly=False, ack=False) as windows:
        windows.putcell("CHAN_FREQ", 0, frequency)
    (told,), (of_set,) = Msv4Store(write()).notices(), MeasurementSet(ms).notices()
    assert told.removeprefix("field_0: ") == of_set.removeprefix("DATA_DESC_ID 0: ")
    assert told.startswith("field_0: channels overlap")


def test_a_hand_that_alone_makes_stokes_i_is_told(tree, write):
    tree["field_0"] = tree["field_0"].isel(polarization=[0])
    (told,) = Msv4Store(write()).notices()
    assert told == "field_0: XX alone is taken as Stokes I, as there is no other parallel hand"


def test_averages_without_any_time_are_told_of(tree, write):
    del tree["field_0"].attrs["processor_info"]
    del tree["field_0"]["time"].attrs["integration_time"]
    store = Msv4Store(write())
    np.testing.assert_array_equal(next(store.chunks()).integrations.interval, 0.0)
    (notice,) = store.notices()
    assert notice.endswith("integration_time is above 0; smearing in time is not in the model")


def test_a_store_without_effective_times_has_nominal_ones(tree, write):
    del tree["field_0"]["EFFECTIVE_INTEGRATION_TIME"]
    chunk = next(Msv4Store(write()).chunks())
    np.testing.assert_array_equal(chunk.integrations.interval, 60.0)


def test_blocks_are_as_small_as_the_memory_and_can_be_kept(original, store):
    small = Msv4Store(store, memory=32_000)
    kept = list(small.chunks())
    assert max(map(len, kept)) == 100
    assert len(kept) >= 17
    assert_same(small, MeasurementSet(original))
    again = list(small.chunks())
    for one, other in zip(kept, again, strict=True):
        np.testing.assert_array_equal(one.stokes_i, other.stokes_i)


def test_it_pickles_while_it_is_read(store):
    opened = Msv4Store(store)
    next(opened.chunks())
    assert_same(pickle.loads(pickle.dumps(opened)), opened)


def test_uvw_can_be_reversed(store):
    opened = Msv4Store(store, conjugates=True)
    assert opened.uvw_agrees() is False
    np.testing.assert_array_equal(next(opened.chunks()).uvw, -next(Msv4Store(store).chunks()).uvw)


# Columns


@pytest.fixture
def modelled(tree):
    """A store with the columns of a calibrated set."""
    partition = tree["field_0"]
    for name, factor in (("VISIBILITY_CORRECTED", 2.0), ("VISIBILITY_MODEL", 0.5)):
        partition[name] = (factor * partition["VISIBILITY"]).astype("c8")
        group = name.rpartition("_")[2].lower()
        base = partition.attrs["data_groups"]["base"]
        partition.attrs["data_groups"][group] = base | {"correlated_data": name}
    return tree


@pytest.mark.usefixtures("modelled")
@pytest.mark.parametrize("column", ["CORRECTED_DATA", "VISIBILITY_CORRECTED", "corrected"])
def test_a_column_is_named_as_in_the_store_or_as_in_the_set(original, write, column):
    found = rows_of(Msv4Store(write(), column=column))["stokes_i"]
    np.testing.assert_array_equal(found, 2 * rows_of(MeasurementSet(original))["stokes_i"])


@pytest.mark.usefixtures("modelled")
def test_a_model_is_subtracted(original, write):
    found = rows_of(Msv4Store(write(), subtracted="MODEL_DATA"))["stokes_i"]
    expected = 0.5 * rows_of(MeasurementSet(original))["stokes_i"]
    np.testing.assert_allclose(found, expected, rtol=1e-6)


@pytest.mark.usefixtures("modelled")
@pytest.mark.parametrize(
    ("options", "message"),
    [
        (
            {"column": "CORRECTED"},
            "no variable CORRECTED; the variables that hold visibilities are",
        ),
        ({"column": "WEIGHT"}, "variable WEIGHT holds float32, not complex visibilities"),
        ({"subtracted": "MODEL"}, "no variable MODEL; "),
        ({"subtracted": "VISIBILITY"}, "DATA would be subtracted from itself"),
    ],
)
def test_a_column_that_is_no_column_is_refused(write, options, message):
    with pytest.raises(InputError, match=message):
        Msv4Store(write(), **options)


# Fields and several inputs


def test_a_field_is_chosen_as_in_the_set(tmp_path):
    ms = written(tmp_path)
    change(ms, "FIELD_ID", 1, rows=slice(0, 280))
    with tables.table(f"{ms}::FIELD", readonly=False, ack=False) as fields:
        fields.addrows(1)
        fields.putcell("NAME", 1, "calibrator")
        fields.putcell("PHASE_DIR", 1, fields.getcell("PHASE_DIR", 0) + 0.01)
    store = write_tree(tree_of(ms), tmp_path / "store")
    for wanted in ("calibrator", 1, "1"):
        assert_same(Msv4Store(store, field=wanted), MeasurementSet(ms, field=wanted))
    assert Msv4Store(store, field="calibrator_1").phase_centre.ra == PHASE_CENTRE.ra + 0.01
    messages = []
    for kind, path in ((Msv4Store, store), (MeasurementSet, ms)):
        for wanted in (None, "target", 2):
            with pytest.raises(InputError) as caught:
                kind(path, field=wanted)
            messages.append(str(caught.value).replace(str(path), "PATH"))
    assert messages[:3] == messages[3:]


def test_names_with_one_phase_centre_are_one_field(tmp_path):
    ms = written(tmp_path)
    change(ms, "FIELD_ID", 1, rows=slice(0, 280))
    with tables.table(f"{ms}::FIELD", readonly=False, ack=False) as fields:
        fields.addrows(1)
        for name in ("NAME", "PHASE_DIR"):
            fields.putcell(name, 1, fields.getcell(name, 0))
    store = Msv4Store(write_tree(tree_of(ms), tmp_path / "store"))
    assert_same(store, MeasurementSet(ms))
    (notice,) = store.notices()
    assert notice.startswith("fields simulated_0, simulated_1 have one name, simulated, and one")


def test_a_set_and_a_store_are_one_observation(original, store):
    joint = open_observation([original, store])
    assert len(joint.parts) == 2
    assert first_pass(joint).summary.rows == 2 * 1680


def test_another_phase_centre_is_refused_by_name(original, tree, write):
    direction = tree[f"field_0/{FIELDS}"]["FIELD_PHASE_CENTER_DIRECTION"]
    direction[:] = direction + np.array([0, ARCSEC])
    path = write()
    with pytest.raises(InputError, match=f"{path}: its phase centre is 1 arcsec from that of"):
        open_observation([original, path])


def test_a_group_of_visibilities_can_be_opened_itself(original, store):
    assert_same(open_observation(store / "field_0", Reading()), MeasurementSet(original))


# What cannot be used


def test_all_flagged_is_refused_at_the_end(tree, write):
    tree["field_0"]["FLAG"] = xr.ones_like(tree["field_0"]["FLAG"])
    with pytest.raises(InputError, match="all visibilities are flagged; there is nothing"):
        list(Msv4Store(write()).chunks())


def test_autocorrelations_alone_are_refused_at_the_end(tree, write):
    partition = tree["field_0"]
    partition["baseline_antenna2_name"] = partition["baseline_antenna1_name"]
    with pytest.raises(InputError, match="there are only autocorrelations in the field"):
        list(Msv4Store(write()).chunks())
