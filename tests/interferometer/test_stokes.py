"""Stokes I from correlations."""

import numpy as np
import pytest

from uvshear.errors import InputError
from uvshear.interferometer.stokes import Hands, parallel_hands, stokes_i


def _hands(p, q, w_p=1.0, w_q=1.0, flags=(False, False)):
    return stokes_i(
        np.array([[[p, q]]], dtype=np.complex64),
        np.array([[[w_p, w_q]]], dtype=np.float32),
        np.array([[flags]]),
    )


@pytest.mark.parametrize(
    ("types", "hands"),
    [
        ([9, 10, 11, 12], (0, 3)),
        ([5, 6, 7, 8], (0, 3)),
        ([9, 12], (0, 1)),
        ([8, 5], (1, 0)),
        ([5], (0,)),
        ([12], (0,)),
        ([1], (0,)),
        ([1, 2, 3, 4], (0,)),
    ],
)
def test_the_hands_that_make_stokes_i_are_found(types, hands):
    assert parallel_hands(types) == hands


def test_crossed_hands_alone_are_an_error():
    with pytest.raises(
        InputError, match=r"\[10, 11\] do not give Stokes I; I .1., or at least one of XX and YY"
    ):
        parallel_hands([10, 11])


@pytest.mark.parametrize("types", [[2, 10, 11, 12], [9, 10, 11, 9], [5, 12], [0, 9], [1, 9, 12]])
def test_types_that_contradict_one_another_are_an_error(types):
    with pytest.raises(InputError, match="cannot be those of one observation"):
        parallel_hands(types)


def test_stokes_i_is_the_mean_of_the_hands():
    combined = _hands(1 + 2j, 3 - 4j)
    assert combined.visibilities[0, 0] == 2 - 1j


def test_the_weight_of_stokes_i_is_the_inverse_variance_of_the_mean():
    rng = np.random.default_rng(1)
    sigma = np.array([0.5, 2.0])
    noise = rng.normal(size=(200_000, 1, 2)) * sigma
    combined = stokes_i(
        noise + 0j, np.broadcast_to(sigma**-2, noise.shape), np.zeros(noise.shape, bool)
    )
    # 200 000 draws give the variance to 0.3 %; the sum of the weights would be 4.5 times off
    assert np.var(combined.visibilities.real) * combined.weights[0, 0] == pytest.approx(1, rel=0.01)


def test_a_flagged_hand_flags_the_visibility():
    for flags in ((True, False), (False, True), (True, True)):
        combined = _hands(1, 1, flags=flags)
        assert combined.weights[0, 0] == 0
        assert combined.non_finite == combined.non_positive == 0


@pytest.mark.parametrize("bad", [np.nan, np.inf, complex(0, np.nan)])
def test_a_non_finite_datum_has_no_weight_and_is_counted(bad):
    combined = _hands(bad, 1)
    assert combined.weights[0, 0] == 0
    assert combined.visibilities[0, 0] == 0
    assert (combined.non_finite, combined.non_positive) == (1, 0)
    assert _hands(bad, 1, flags=(True, False)).non_finite == 0


@pytest.mark.parametrize(
    ("weight", "counts"), [(0.0, (0, 1)), (-1.0, (0, 1)), (np.nan, (1, 0)), (np.inf, (1, 0))]
)
def test_an_unusable_weight_is_counted(weight, counts):
    for weights in ((weight, 1.0), (1.0, weight)):
        combined = _hands(1, 1, *weights)
        assert combined.weights[0, 0] == 0
        assert (combined.non_finite, combined.non_positive) == counts


def test_a_single_hand_stands_for_stokes_i():
    combined = stokes_i(
        np.array([[[3 + 1j]]]), np.array([[[5.0]]]), np.zeros((1, 1, 1), dtype=bool)
    )
    assert combined.visibilities[0, 0] == 3 + 1j
    assert combined.weights[0, 0] == 5


def test_the_input_is_left_alone():
    correlations = np.full((2, 1, 1), np.nan, dtype=np.complex64)
    stokes_i(correlations, np.ones((2, 1, 1)), np.zeros((2, 1, 1), dtype=bool))
    assert np.isnan(correlations).all()


def test_hands_know_their_receptors():
    assert Hands.LINEAR.receptors == ("X", "Y")
    assert Hands.CIRCULAR.receptors == ("R", "L")
