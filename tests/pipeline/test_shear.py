"""Estimation of a shear from a measurement."""

import json

import numpy as np
import pytest

from uvshear.errors import InputError
from uvshear.estimators import Moments
from uvshear.estimators.shear_estimate import ShearConditions
from uvshear.io.bias_records import read_bias
from uvshear.pipeline.shear import as_measurement, estimate_shear


def test_a_measurement_its_table_and_its_file_have_one_shear(kept, tmp_path):
    path = tmp_path / "shapes.fits"
    kept.write(path)
    expected = estimate_shear(kept)
    for given in (kept.shapes, path, str(path)):
        assert estimate_shear(given).numbers() == pytest.approx(expected.numbers())


def test_an_estimator_its_class_and_its_name_have_one_shear(kept):
    expected = estimate_shear(kept, "moments").numbers()
    assert estimate_shear(kept, Moments()).numbers() == expected
    assert estimate_shear(kept, Moments).numbers() == expected
    assert estimate_shear(kept, "mean").estimator == "mean"


def test_errors_are_those_of_the_patches(kept):
    """Four sources are left out one by one, or in two halves of the field."""
    single, halves = (estimate_shear(kept, patches=patches) for patches in (None, 2))
    assert halves.g1 == single.g1
    assert halves.g1_err != single.g1_err
    assert estimate_shear(kept, patches=4).g1_err == pytest.approx(single.g1_err)
    with pytest.raises(InputError, match="5 patches of the sky for 4 sources"):
        estimate_shear(kept, patches=5)


def test_cuts_and_masks_choose_the_sources(kept):
    assert estimate_shear(kept).n == 4
    assert estimate_shear(kept, flux_min=0.9e-3).n == 2
    assert estimate_shear(kept, where=np.arange(7) < 3).n == 2
    with pytest.raises(InputError, match="2 or more are needed"):
        estimate_shear(kept, snr_min=1e9)


def test_a_table_alone_has_no_statistics(kept):
    assert as_measurement(kept.shapes).statistics is None
    with pytest.raises(InputError, match="measure again with --keep moments"):
        estimate_shear(kept.shapes, "moments")


def test_a_bias_is_removed_from_memory_or_from_its_file(kept, tmp_path):
    record = {"m1": 0.1, "m2": -0.2, "c1": 1e-3, "c2": 2e-3, "snr_min": 0.0, "frame": "sky"}
    record |= {f"{name}_err": 0.0 for name in ("m1", "m2", "c1", "c2")} | {"estimator": "mean"}
    path = tmp_path / "bias.json"
    path.write_text(json.dumps(record))
    raw, corrected = estimate_shear(kept), estimate_shear(kept, correction=path)
    assert corrected.g1 == pytest.approx((raw.g1 - 1e-3) / 1.1)
    assert corrected.g2 == pytest.approx((raw.g2 - 2e-3) / 0.8)
    with pytest.raises(InputError, match="estimator = mean, but the shear is estimated with"):
        estimate_shear(kept, "moments", correction=str(path))
    assert (raw.correction, corrected.correction) == (None, str(path))
    assert estimate_shear(kept, correction=read_bias(path)).g1 == corrected.g1


def test_the_conditions_of_a_shear_are_known(kept):
    found = estimate_shear(kept, flux_min=0.9e-3)
    assert found.conditions == ShearConditions("mean", flux_min=0.9e-3)
    assert found.seed is None
