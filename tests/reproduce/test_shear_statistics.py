import numpy as np
import pytest

from tests.reproduce.surveys import sample_of
from uvshear.reproduce.shape_sample import FLAGS
from uvshear.reproduce.shear_statistics import mean_bias
from uvshear.shapes.measurement import FitFlag

SHEARS = (0.04 + 0j, 0.04j, -0.04 + 0j, -0.04j)


def _sample(galaxies: int, m: complex, c: complex, scatter: float, seed: int = 1):
    """Ellipticities whose components are (1 + m) g + c, with a scatter that a galaxy keeps behind all shears."""
    rng = np.random.default_rng(seed)
    galaxy = np.repeat(np.arange(galaxies), len(SHEARS))
    shear = np.tile(np.arange(len(SHEARS)), galaxies)
    g = np.array(SHEARS)[shear]
    own = scatter * (rng.normal(size=galaxies) + 1j * rng.normal(size=galaxies))
    noise = scatter * (rng.normal(size=len(galaxy)) + 1j * rng.normal(size=len(galaxy)))
    e = (1 + m.real) * g.real + 1j * (1 + m.imag) * g.imag + c + own[galaxy] + noise
    return sample_of(e, galaxy=galaxy, shear=shear)


def test_m_and_c_are_found():
    bias = mean_bias(_sample(5, -0.1 - 0.2j, 0.003 + 0.001j, 0.0), SHEARS)
    assert [part.value for part in bias.m] == pytest.approx([-0.1, -0.2])
    assert [part.value for part in bias.c] == pytest.approx([0.003, 0.001])
    assert bias.galaxies == 5


def test_errors_are_those_of_many_repetitions():
    found = [mean_bias(_sample(60, 0j, 0j, 0.1, seed), SHEARS) for seed in range(200)]
    shears = np.array([bias.shears for bias in found])
    assert np.std(shears.real, axis=0).mean() == pytest.approx(
        found[0].errors.real.mean(), rel=0.25
    )
    for what in ("m", "c"):
        for part in (0, 1):
            values = [getattr(bias, what)[part].value for bias in found]
            errors = [getattr(bias, what)[part].error for bias in found]
            assert np.std(values) == pytest.approx(np.mean(errors), rel=0.15)


def test_without_a_shear_there_is_only_c():
    bias = mean_bias(sample_of([0.1, 0.2 + 0.1j]), (0j,))
    assert np.isnan(bias.m[0].value)
    assert bias.c[0].value == pytest.approx(0.15)


def test_without_galaxies_there_are_no_numbers():
    sample = sample_of([0.1, 0.2])
    bias = mean_bias(sample.select(sample.flux > 1), SHEARS)
    assert bias.galaxies == 0
    assert np.isnan([*(part.value for part in bias.m), *(part.error for part in bias.c)]).all()


def test_a_failed_fit_has_no_weight():
    flag = np.array([0, FLAGS.index(FitFlag.NO_PEAK), 0])
    sample = sample_of([0.1, complex(np.nan, np.nan), 0.3], flag=flag)
    assert mean_bias(sample, (0j,)).c[0].value == pytest.approx(0.2)
