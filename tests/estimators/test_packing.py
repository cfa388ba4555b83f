"""Likelihoods packed and unpacked."""

from dataclasses import replace

import numpy as np
import pytest

from tests.estimators.test_evidence import POPULATION, Toy
from uvshear.estimators import Bayesian
from uvshear.estimators.evidence import gradient_and_curvature
from uvshear.estimators.packing import PACKED, is_whole, pack, unpack
from uvshear.estimators.sample import Sample

TOYS = [Toy(0.3 - 0.2j, 0.25), Toy(-0.1 + 0.05j, 0.08), Toy(0.6 + 0.3j, 0.4)]


def _with_fluxes(toy):
    """Fluxes that grow with the size, as a fit finds them."""
    constant = toy.on_lattice()
    away = constant.log_scale_length - constant.log_scale_length.mean()
    return replace(
        constant,
        log_likelihood=constant.log_likelihood - 3.0,
        flux=2e-5 * np.exp(0.6 * away) * (1 + 0.1 * np.abs(constant.ellipticity) ** 2),
        flux_variance=(1.5e-6) ** 2 * np.exp(0.8 * away),
    )


@pytest.mark.parametrize("toy", TOYS)
def test_what_is_unpacked_says_the_same_of_the_shear(toy):
    likelihood = _with_fluxes(toy)
    packed = pack(likelihood)
    assert tuple(packed) == PACKED
    again = unpack(packed)
    assert len(again.point) == len(likelihood.point)
    q, h = gradient_and_curvature(likelihood, POPULATION, 0.02 + 0.01j)
    got_q, got_h = gradient_and_curvature(again, POPULATION, 0.02 + 0.01j)
    scale = np.sqrt(np.trace(h) / 2)
    np.testing.assert_allclose(got_q, q, rtol=0, atol=3e-3 * scale)
    np.testing.assert_allclose(got_h, h, rtol=0, atol=5e-3 * scale**2)


def test_packed_it_takes_a_few_kilobytes():
    likelihood = _with_fluxes(TOYS[0])
    size = sum(array.nbytes for array in pack(likelihood).values())
    # of the broadest; the average galaxy has 1500 points
    assert len(likelihood.point) > 2000
    assert size < 3.2 * len(likelihood.point) + 500


def test_fluxes_are_those_of_a_polynomial_of_the_fourth_degree():
    """A flux that is one comes back to the rounding of its coefficients; the lattice is narrow along one axis."""
    likelihood = TOYS[1].on_lattice()
    thin = likelihood.point[:, 1] > -2
    x, y, z = (likelihood.point[thin] - likelihood.point[thin].mean(axis=0)).T / 4
    polynomial = 1 + 0.1 * x - 0.2 * y * z + 0.05 * x**2 * z - 0.01 * y**4
    flux = 2e-5 * (polynomial + 2 * np.abs(polynomial).max())
    given = replace(
        likelihood,
        point=likelihood.point[thin],
        log_likelihood=likelihood.log_likelihood[thin],
        flux=flux,
        flux_variance=1e-12 * np.exp(polynomial),
    )
    again = unpack(pack(given))
    order = np.lexsort(given.point.T[::-1])
    np.testing.assert_array_equal(again.point, given.point[order])
    np.testing.assert_allclose(again.flux, flux[order], rtol=3e-6)
    np.testing.assert_allclose(again.flux_variance, given.flux_variance[order], rtol=3e-5)


def _with(name, value, place=1):
    packed = {part: np.array(array) for part, array in pack(TOYS[0].on_lattice()).items()}
    packed[name][place] = value
    return packed


@pytest.mark.parametrize("toy", TOYS)
def test_what_was_packed_is_whole(toy):
    assert is_whole(pack(_with_fluxes(toy)))


@pytest.mark.parametrize(
    ("name", "value", "place"),
    [
        ("lattice", np.nan, 4),
        ("lattice", 1e30, 0),
        ("lattice", 7.0, 1),
        ("lattice", 0.1, 5),
        ("lattice", 0.0, slice(None)),
        ("columns", 0, 3),
        ("columns", -3, 3),
        ("columns", 32767, 3),
        ("columns", 32767, 0),
        ("log_likelihood", -7, 0),
        ("log_likelihood", 32767, 0),
        ("log_likelihood", 5, slice(None)),
        ("flux_terms", np.inf, 0),
        ("flux_terms", 1e20, 3),
        ("variance_terms", np.nan, 34),
        ("variance_terms", 700.0, 0),
    ],
)
def test_numbers_out_of_their_ranges_are_damage(name, value, place):
    assert not is_whole(_with(name, value, place))


@pytest.mark.parametrize("name", PACKED)
def test_arrays_of_other_lengths_and_kinds_are_damage(name):
    whole = pack(TOYS[0].on_lattice())
    array = whole[name]
    for other in (array[:0], array[:-1], np.append(array, array[-1]), array[None], array == 0):
        assert not is_whole({**whole, name: other})
    assert not is_whole({**whole, name: np.array("text")})


def test_a_likelihood_without_one_of_its_arrays_is_damaged():
    whole = pack(TOYS[0].on_lattice())
    rows = [whole, {name: array[:0] for name, array in whole.items()}, {**whole}]
    rows[2]["variance_terms"] = whole["variance_terms"][:0]
    columns = {name: np.empty(3, object) for name in PACKED}
    for k, row in enumerate(rows):
        for name in PACKED:
            columns[name][k] = row[name]
    sample = Sample(columns, np.zeros(3))
    assert Bayesian().damaged(sample).tolist() == [False, False, True]
