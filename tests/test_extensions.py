"""Parts of a user's own, one file each outside the package, in every command and from Python.

The files lie in ``tests/extensions``. They are found as MODULE:NAME with PYTHONPATH, and by the entry points of an
installed package.
"""

import json
import math
import os
import subprocess
import sys
from importlib import import_module, invalidate_caches
from pathlib import Path

import numpy as np
import pytest

import uvshear
from tests.skies import galaxies
from uvshear.bias import opposite_shears
from uvshear.constants import ARCMIN, ARCSEC
from uvshear.estimators.estimate import estimate_sample_shear
from uvshear.galaxy import DiscEllipticityPrior
from uvshear.geometry.ellipticity import add_shear
from uvshear.interferometer.beam_registry import primary_beam_named
from uvshear.io.catalogue import catalogue_from_galaxies
from uvshear.io.readers import Reading
from uvshear.shapes import source_facet
from uvshear.shapes.shape import measure_shape

# Bright sources far from the phase centre change between the few integrations of these tests.
pytestmark = pytest.mark.filterwarnings("ignore::uvshear.errors.DataWarning")

FILES = Path(__file__).parent / "extensions"
ENTRY_POINTS = """
[uvshear.profiles]
double-gaussian = double_gaussian:DoubleGaussian
[uvshear.primary_beams]
gaussian-beam = gaussian_beam:gaussian
[uvshear.estimators]
trimmed-mean = trimmed_mean:TrimmedMean
[uvshear.readers]
npz = npz_reader:NpzReader
[uvshear.extractions]
timed = timed:Timed
"""

CENTRE = uvshear.PhaseCentre(1.0, math.radians(40.0))
DIAMETER = 25.0
COUNT = 6
RNG = np.random.default_rng(2)
ANGLE = 2 * np.pi * np.arange(COUNT) / COUNT
SKY = galaxies(
    l=9 * ARCMIN * np.cos(ANGLE),
    m=9 * ARCMIN * np.sin(ANGLE),
    flux=np.full(COUNT, 2e-3),
    alpha=np.full(COUNT, 2.0) * ARCSEC,
    e=0.3 * np.exp(2j * np.pi * RNG.uniform(size=COUNT)),
)
"""Galaxies where the primary beam leaves 70 per cent of their flux."""


@pytest.fixture(scope="module")
def extensions(tmp_path_factory):
    """Folders for the path: the files themselves, and what an installed package would have beside them."""
    installed = tmp_path_factory.mktemp("installed")
    information = installed / "my_extensions-1.0.dist-info"
    information.mkdir()
    (information / "METADATA").write_text(
        "Metadata-Version: 2.1\nName: my-extensions\nVersion: 1.0\n"
    )
    (information / "entry_points.txt").write_text(ENTRY_POINTS)
    with pytest.MonkeyPatch.context() as patch:
        for folder in (FILES, installed):
            patch.syspath_prepend(folder)
        invalidate_caches()
        yield (str(FILES), str(installed))


@pytest.fixture(scope="module")
def field(extensions, tmp_path_factory):
    """A field of six bright galaxies observed with the VLA, in a file of the reader's format; and its catalogue."""
    folder = tmp_path_factory.mktemp("field")
    beam = primary_beam_named("gaussian_beam:gaussian", np.full(27, DIAMETER))
    plan = uvshear.ObservingPlan(
        uvshear.load_layout("vla-b"),
        uvshear.Track.from_clock(CENTRE, ((-7200.0, 7200.0),), 1200.0),
        uvshear.Channels.from_band(1.3e9, 1.5e9, 2),
        primary_beam=beam,
    )
    profile = import_module("double_gaussian").DoubleGaussian()
    catalogue = catalogue_from_galaxies(SKY, CENTRE)
    observation = uvshear.simulate(
        catalogue, plan, noise=uvshear.GalaxyNoise(2e-3, 400.0), profile=profile, seed=3
    )
    blocks = list(observation.chunks())
    np.savez(
        folder / "FIELD.npz",
        uvw=np.concatenate([block.uvw for block in blocks]),
        frequency=blocks[0].frequency,
        stokes_i=np.concatenate([block.stokes_i for block in blocks]),
        weights=np.concatenate([block.weights for block in blocks]),
        phase_centre=np.array([CENTRE.ra, CENTRE.dec]),
        diameters=np.full(27, DIAMETER),
    )
    uvshear.write_catalogue(folder / "CAT.fits", catalogue)
    return folder


def _measured(field):
    """Measure with objects, from Python."""
    beam = primary_beam_named("gaussian_beam:gaussian", np.full(27, DIAMETER))
    model = uvshear.Model(
        profile=import_module("double_gaussian").DoubleGaussian(), primary_beam=beam, smears=False
    )
    reader = import_module("npz_reader").NpzReader()
    return uvshear.measure(
        uvshear.open_observation(field / "FIELD.npz", Reading(reader=reader)),
        field / "CAT.fits",
        model=model,
        method=uvshear.Method(extraction=import_module("timed").Timed()),
    )


@pytest.fixture(scope="module")
def measurement(field):
    return _measured(field)


def _command(extensions, *words):
    """Run a command in a process of its own, with the folders on its path."""
    run = subprocess.run(
        [sys.executable, "-m", "uvshear", *map(str, words)],
        env={**os.environ, "PYTHONPATH": os.pathsep.join([*extensions, *sys.path])},
        capture_output=True,
        text=True,
        check=False,
    )
    assert run.returncode == 0, run.stderr
    return run.stdout


def test_python_measures_with_a_profile_a_beam_an_extraction_and_a_reader(measurement):
    shapes = measurement.shapes
    assert set(shapes["flag"]) == {"ok"}
    # within the errors; without the beam fluxes would be 30 per cent off, of another profile sizes twice that
    np.testing.assert_allclose(shapes["flux_fit"], 2000, rtol=0.03)
    np.testing.assert_allclose(shapes["scale_length"], 2.0, rtol=0.03)
    np.testing.assert_allclose(shapes["e1"], SKY.ellipticity.real, atol=0.02)
    np.testing.assert_allclose(shapes["e2"], SKY.ellipticity.imag, atol=0.02)
    assert measurement.record["seconds"] > 0


NAMES = {
    "entry points": ("double-gaussian", "gaussian-beam", "trimmed-mean", "timed"),
    "modules": (
        "double_gaussian:DoubleGaussian",
        "gaussian_beam:gaussian",
        "trimmed_mean:TrimmedMean",
        "timed:Timed",
    ),
}


def test_the_command_line_measures_and_finds_the_shear_with_them(
    extensions, field, measurement, tmp_path
):
    """Names of modules are in the measurement, those of entry points in the shear; the reader has only the latter."""
    profile, beam, estimator, extraction = NAMES["modules"]
    shapes = tmp_path / "SHAPES.fits"
    words = ("--profile", profile, "--primary-beam", beam, "--extraction", extraction)
    catalogue = ("--catalogue", field / "CAT.fits", "--no-smearing", "--threads", "1")
    _command(extensions, "measure", field / "FIELD.npz", *catalogue, *words, "-o", shapes)
    read = uvshear.read_measurement(shapes)
    for name in ("e1", "e2", "flux_fit", "scale_length"):
        np.testing.assert_allclose(read.shapes[name], measurement.shapes[name], rtol=1e-5)
    assert read.record["seconds"] > 0

    expected = uvshear.estimate_shear(measurement, import_module("trimmed_mean").TrimmedMean())
    for name in (estimator, NAMES["entry points"][2]):
        told = tmp_path / f"{name}.json"
        _command(extensions, "shear", shapes, "--estimator", name, "-o", told)
        record = json.loads(told.read_text())
        assert record["estimator"] == "trimmed-mean"
        assert record["g1"] == pytest.approx(expected.g1, rel=1e-4)
        assert record["g1_err"] == pytest.approx(expected.g1_err, rel=1e-4)


def _survey(flux_min, **values):
    plan = uvshear.ObservingPlan(
        uvshear.load_layout("ska-mid-aa4"),
        uvshear.Track.from_clock(
            uvshear.PhaseCentre(0.0, math.radians(-30.0)), ((-14400.0, 14400.0),), 3600.0
        ),
        uvshear.Channels.from_band(950e6, 1190e6, 1),
    )
    return uvshear.Survey(plan, flux_min=flux_min, **values)


def test_the_bias_of_an_estimator_of_ones_own_is_that_of_the_command(extensions, tmp_path):
    profile, _, estimator, _ = NAMES["entry points"]
    output = tmp_path / "BIAS.json"
    sky = ("--galaxies", 100, "--flux-min-ujy", 150, "--snr-min", 0, "--shear", 0.05, "--seed", 2)
    track = ("--integration-s", 3600, "--threads", 1)
    names = ("--estimator", estimator, "--profile", profile)
    _command(extensions, "bias", *names, *sky, *track, "-o", output)
    record = json.loads(output.read_text())
    assert record["estimator"] == "trimmed-mean"
    assert 2 <= record["n"] < 30

    survey = _survey(150e-6, profile=import_module("double_gaussian").DoubleGaussian())
    found = uvshear.estimate_bias("trimmed-mean", galaxies=100, shear=0.05, seed=2, survey=survey)
    assert record["m1"] == pytest.approx(found.m[0], rel=1e-9)
    assert record["c2"] == pytest.approx(found.c[1], rel=1e-9)


def _without_response(base):
    """Return the estimator that takes the weights of the sources which it keeps for its response."""

    class Plain(base):
        def terms(self, sample, about):
            modulus = np.hypot(sample["e1"], sample["e2"])
            kept = sample["weight"] * self.trimmed(modulus) / modulus
            value = super().terms(sample, about).value
            return uvshear.Terms(value, kept[:, None, None] * np.eye(2))

    return Plain()


@pytest.mark.parametrize("shear", [0.02 + 0.01j, -0.02j])
def test_the_response_of_the_trimmed_mean_knows_what_crosses_the_limit(extensions, shear):
    """Rings of perfect shapes behind a shear, which is lost in part without the response."""
    trimmed = import_module("trimmed_mean").TrimmedMean
    rng = np.random.default_rng(5)
    modulus = DiscEllipticityPrior().draw_modulus(20_000, rng)
    first = np.exp(2j * np.pi * rng.uniform(size=20_000))
    ring = np.exp(0.5j * np.pi * np.arange(4))[:, None] * first
    e = add_shear((modulus * ring).ravel(), shear.conjugate())
    sample = uvshear.Sample(
        {"e1": e.real, "e2": e.imag, "weight": np.ones(len(e))}, np.zeros(len(e))
    )
    found = estimate_sample_shear(trimmed(), sample)
    # the third order in the shear: measured 0.002
    assert abs(found.shear / shear - 1) < 5e-3
    lost = estimate_sample_shear(_without_response(trimmed), sample)
    assert abs(lost.shear / shear) < 0.8


def test_the_bias_of_the_trimmed_mean_is_small_with_its_response_alone(extensions, monkeypatch):
    """Bright galaxies alone in the beam: the whole path from facets to m. Shapes are the same for both."""
    shapes: dict[bytes, object] = {}

    def measured_once(facet, prior, profile):
        key = facet.correlation.tobytes()
        if key not in shapes:
            shapes[key] = measure_shape(facet, prior, profile)
        return shapes[key]

    monkeypatch.setattr(source_facet, "measure_shape", measured_once)
    trimmed = import_module("trimmed_mean").TrimmedMean
    survey = _survey(100e-6, noise=uvshear.GalaxyNoise(10e-6, 40.0))
    options = {"galaxies": 150, "shear": opposite_shears(0.03), "seed": 4, "survey": survey}
    right = uvshear.estimate_bias(trimmed(), **options)
    wrong = uvshear.estimate_bias(_without_response(trimmed), **options)
    # 0.009 for a hundred perfect shapes; the loss is 0.27
    assert np.all(np.abs(right.m) < 0.08)
    assert np.all(wrong.m < -0.15)
