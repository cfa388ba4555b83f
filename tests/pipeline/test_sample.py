"""The sources of a measurement that an estimator is given."""

import numpy as np
import pytest

from uvshear.errors import InputError
from uvshear.estimators import Mean, Metacal, Moments
from uvshear.geometry.directions import local_north
from uvshear.pipeline.sample import sample_of, selected


def test_a_sample_has_the_columns_of_its_estimator_in_si(kept):
    sample = sample_of(kept, Mean())
    assert set(sample.columns) == {"e1", "e2", "weight", "flux"}
    np.testing.assert_allclose(sample["flux"], np.asarray(kept.shapes["flux"]) * 1e-6)
    assert set(sample_of(kept, Moments()).columns) == {"flux", *Moments.columns}


def test_local_north_is_that_of_each_source(field, kept):
    sample = sample_of(kept, Mean())
    l, m = (np.asarray(kept.shapes[name]) for name in "lm")
    np.testing.assert_allclose(
        sample.local_north, local_north(field.observation.phase_centre, l, m)
    )


def test_statistics_that_were_not_kept_are_asked_for(kept):
    with pytest.raises(InputError, match="measure again with --keep metacal"):
        sample_of(kept, Metacal())


def test_cuts_leave_out_what_is_flagged_and_what_is_faint(kept):
    shapes = kept.shapes
    is_ok = shapes["flag"] == "ok"
    assert selected(shapes).tolist() == is_ok.tolist()
    middle = float(np.median(shapes["snr"][is_ok]))
    assert selected(shapes, snr_min=middle).sum() == 2
    assert selected(shapes, flux_min=0.9e-3).tolist() == (is_ok & (shapes["flux"] > 900)).tolist()
    where = np.arange(len(shapes)) < 3
    assert selected(shapes, where=where).tolist() == (is_ok & where).tolist()


@pytest.mark.parametrize("where", [np.ones(3, bool), np.ones(7), np.arange(2)])
def test_a_mask_of_another_kind_is_refused(kept, where):
    with pytest.raises(InputError, match="where: 7 booleans are needed, one for each row"):
        selected(kept.shapes, where=where)


def test_sources_of_low_significance_stay_and_a_cut_by_detection_is_the_user_s(kept):
    """They are left to the estimator; the mean of ellipticities has a weight of zero for them."""
    shapes = kept.shapes.copy()
    is_ok = shapes["flag"] == "ok"
    flags = np.array(shapes["flag"]).astype("U16")
    first, second = np.flatnonzero(is_ok)[:2]
    flags[first], flags[second] = "not_detected", "unresolved"
    shapes["flag"] = flags
    assert selected(shapes).tolist() == is_ok.tolist()
    least = float(np.median(shapes["detection"][is_ok]))
    assert selected(shapes, detection_min=least).sum() == np.sum(
        shapes["detection"][is_ok] >= least
    )
