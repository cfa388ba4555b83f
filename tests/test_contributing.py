"""The examples of CONTRIBUTING are what they say, and the package works with them."""

import importlib
import re
from pathlib import Path

import numpy as np
import pytest

import uvshear

TEXT = (Path(__file__).parents[1] / "CONTRIBUTING.md").read_text(encoding="utf-8")
EXAMPLES = dict(re.findall(r"```python\n# (\w+)\.py\n(.*?)```", TEXT, re.S))


@pytest.fixture
def example(tmp_path, monkeypatch):
    """Import an example from a file of its own."""
    for name, code in EXAMPLES.items():
        (tmp_path / f"{name}.py").write_text(code, encoding="utf-8")
    monkeypatch.syspath_prepend(tmp_path)
    return importlib.import_module


def test_each_kind_of_extension_has_an_example():
    assert set(EXAMPLES) == {"moffat", "gaussian_beam", "trimmed", "timed", "npz_reader"}


def test_the_profile_has_unit_flux_and_falls(example):
    profile = example("moffat").Moffat()
    assert isinstance(profile, uvshear.Profile)
    values = profile.envelope(np.array([0.0, 1.0, 4.0]))
    np.testing.assert_allclose(values, np.exp([0, -1, -2]))


def test_the_primary_beam_has_half_its_power_at_half_its_width(example):
    from uvshear.interferometer.beam_registry import primary_beam_named

    example("gaussian_beam")
    beam = primary_beam_named("gaussian_beam:gaussian", np.full(3, 13.5), (0.0, 0.0))
    assert beam.voltage(np.array([0.5]))[0] ** 2 == pytest.approx(0.5)


def test_the_estimator_undoes_a_shear_of_ring_galaxies(example):
    """Twelve orientations of one ellipticity behind a shear of 0.01: the third order, 3e-6, is left."""
    from uvshear.estimators import Sample, estimate_sample_shear
    from uvshear.geometry.ellipticity import add_shear

    shear = 0.008 - 0.006j
    intrinsic = 0.4 * np.exp(2j * np.pi * np.arange(12) / 12)
    e = add_shear(intrinsic, shear)
    sample = Sample({"e1": e.real, "e2": e.imag, "flux": np.full(12, 5e-5)}, np.zeros(12))
    found = estimate_sample_shear(example("trimmed").Trimmed(), sample)
    # the sky frame has the opposite sign of the second component
    assert found.g1 == pytest.approx(shear.real, abs=1e-5)
    assert found.g2 == pytest.approx(-shear.imag, abs=1e-5)


def test_the_extraction_is_found_by_name_and_is_one(example):
    assert isinstance(example("timed").Timed(), uvshear.Extraction)


def test_the_reader_opens_what_was_saved(example, tmp_path):
    from uvshear.io.reading import Reading

    rng = np.random.default_rng(1)
    arrays = {
        "uvw": rng.normal(size=(5, 3)),
        "frequency": np.array([1e9]),
        "stokes_i": np.ones((5, 1), complex),
        "weights": np.ones((5, 1)),
        "phase_centre": np.array([0.1, -0.5]),
    }
    np.savez(tmp_path / "FIELD.npz", **arrays)
    reader = example("npz_reader").NpzReader()
    assert reader.recognises(tmp_path / "FIELD.npz")
    observation = reader.open(tmp_path / "FIELD.npz", Reading())
    (block,) = observation.chunks()
    np.testing.assert_array_equal(block.uvw, arrays["uvw"])
    assert observation.phase_centre.dec == -0.5
