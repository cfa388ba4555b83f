"""Numbers that were kept, and may have been damaged since."""

import numpy as np
import pytest

from uvshear.errors import InputError
from uvshear.estimators import Metacal, Moments
from uvshear.estimators.kept_numbers import incomplete
from uvshear.estimators.sample import Sample


def _sample(estimator: Moments | Metacal) -> Sample:
    columns = {name: np.full(4, 1e-6) for name in estimator.columns}
    for values in columns.values():
        values[3] = np.nan
    return Sample(columns, np.zeros(4))


@pytest.mark.parametrize("estimator", [Moments(), Metacal()])
def test_all_numbers_or_none_are_kept(estimator: Moments | Metacal) -> None:
    assert not estimator.damaged(_sample(estimator)).any()
    for name in estimator.columns:
        for value in (np.nan, np.inf, -1e300):
            sample = _sample(estimator)
            sample[name][1] = value
            assert estimator.damaged(sample).tolist() == [False, True, False, False]


@pytest.mark.parametrize("name", ["m1_var", "m2_var"])
def test_no_variance_is_negative(name: str) -> None:
    sample = _sample(Moments())
    sample[name][2] = -1e-6
    assert Moments().damaged(sample).tolist() == [False, False, True, False]


@pytest.mark.parametrize(
    "values", [np.zeros((2, 3)), np.array([[1.0], [2.0, 3.0]], object), np.array(["a", "b"])]
)
def test_other_values_than_one_number_a_source_are_refused(values: np.ndarray) -> None:
    sample = Sample({"a": np.zeros(2), "b": values}, np.zeros(2))
    with pytest.raises(InputError, match="column 'b' has other values than one number"):
        incomplete(sample, ("a", "b"))
