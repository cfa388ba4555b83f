"""PyBDSF finds the sources of an image, and its lists of every format are one catalogue."""

import os
import subprocess
import sys
import textwrap
from dataclasses import replace

import numpy as np
import pytest
from astropy.io import fits
from scipy.ndimage import gaussian_filter

import uvshear
from uvshear.constants import ARCSEC
from uvshear.geometry.deconvolution import matrix_of
from uvshear.geometry.directions import PhaseCentre
from uvshear.interferometer.coverage import Track
from uvshear.interferometer.layout import load_layout
from uvshear.interferometer.noise import ScaledNoise
from uvshear.interferometer.plan import ObservingPlan
from uvshear.interferometer.spectral_window import Channels
from uvshear.io.catalogue import read_catalogue
from uvshear.io.measurement_set.writer import write_measurement_set
from uvshear.io.source_finders import FWHM_OF_SCALE_LENGTH

pytestmark = [pytest.mark.referee, pytest.mark.xdist_group("pybdsf")]

BEAM = (4.0, 3.0, 30.0)
SOURCES = [(0, 0, 0), (4, 2, 70), (6, 4, 120), (2, 1.5, 0), (3, 3, 0), (5, 3, 20)]
SPACING = 48


def _matrix(major, minor, degrees):
    return matrix_of(*(np.array([value], float) for value in (major, minor, np.radians(degrees))))[
        0
    ]


def _image(path):
    """Pixels of one arcsec with six sources of 1 to 3 mJy; the noise is 20 uJy/beam."""
    height, width = SPACING * 2, SPACING * 3
    rng = np.random.default_rng(1)
    image = gaussian_filter(rng.normal(size=(height, width)), 1.5)
    image *= 2e-5 / image.std()
    row, column = np.mgrid[:height, :width].astype(float)
    beam = _matrix(*BEAM)
    for k, source in enumerate(SOURCES):
        total = _matrix(*source) + beam
        north = row - SPACING * (k // 3 + 0.5) - rng.uniform(-1, 1)
        east = SPACING * (k % 3 + 0.5) + rng.uniform(-1, 1) - column
        inverse = np.linalg.inv(total)
        square = (
            inverse[0, 0] * north**2 + 2 * inverse[0, 1] * north * east + inverse[1, 1] * east**2
        )
        peak = (1 + k % 3) * 1e-3 * np.sqrt(np.linalg.det(beam) / np.linalg.det(total))
        image += peak * np.exp(-4 * np.log(2) * square)
    header = fits.Header()
    axes = (("RA---SIN", 60.0, -1 / 3600, width / 2), ("DEC--SIN", -30.0, 1 / 3600, height / 2))
    axes += (("FREQ", 1.3e9, 1e8, 1.0), ("STOKES", 1.0, 1.0, 1.0))
    for axis, values in enumerate(axes, 1):
        for name, value in zip(("CTYPE", "CRVAL", "CDELT", "CRPIX"), values, strict=True):
            header[f"{name}{axis}"] = value
    for name, value in zip(("BMAJ", "BMIN"), BEAM, strict=False):
        header[name] = value / 3600
    header["BPA"], header["EQUINOX"], header["BUNIT"] = BEAM[2], 2000.0, "JY/BEAM"
    fits.writeto(path, image[None, None].astype("f4"), header)


@pytest.fixture(scope="module")
def lists(tmp_path_factory):
    directory = tmp_path_factory.mktemp("pybdsf")
    _image(directory / "image.fits")
    script = textwrap.dedent(
        """
        import bdsf
        image = bdsf.process_image("image.fits", thresh_isl=3, thresh_pix=5, rms_map=False,
                                   mean_map="zero", ncores=1, quiet=True)
        for kind in ("srl", "gaul"):
            for format in ("fits", "ascii", "csv"):
                image.write_catalog(outfile=f"{kind}.{format}", format=format, catalog_type=kind, clobber=True)
        """
    )
    subprocess.run(
        [sys.executable, "-c", script],
        check=True,
        cwd=directory,
        timeout=600,
        env=os.environ | {"MPLBACKEND": "Agg"},
    )
    return directory


@pytest.mark.parametrize("kind", ["srl", "gaul"])
@pytest.mark.parametrize("format_", ["ascii", "csv"])
def test_lists_of_every_format_are_one_catalogue(lists, kind, format_):
    expected = read_catalogue(lists / f"{kind}.fits")
    found = read_catalogue(lists / f"{kind}.{format_}")
    assert len(expected) == len(SOURCES)
    assert found.identifier.tolist() == expected.identifier.tolist()
    for name in (
        "ra",
        "dec",
        "flux",
        "flux_err",
        "position_err",
        "scale_length",
        "scale_length_err",
    ):
        np.testing.assert_allclose(
            getattr(found, name), getattr(expected, name), rtol=1e-7, err_msg=name
        )


def test_sizes_and_their_errors_are_right(lists):
    found = read_catalogue(lists / "srl.fits")
    place = np.lexsort((-found.ra, np.round(np.degrees(found.dec) * 3600 / SPACING)))
    width = found.scale_length[place] * FWHM_OF_SCALE_LENGTH / ARCSEC
    err = found.scale_length_err[place] * FWHM_OF_SCALE_LENGTH / ARCSEC
    truth = np.array([np.sqrt(major * minor) for major, minor, _ in SOURCES])
    is_limit = np.isclose(err / width, np.sqrt(np.e - 1))
    assert is_limit.tolist() == [True] + [False] * 5
    pull = (width - truth)[1:] / err[1:]
    assert np.all(np.abs(pull) < 3.5)
    assert np.all(err[1:] < 0.12 * truth[1:])


@pytest.fixture(scope="module")
def observed(lists):
    """Visibilities of the galaxies that PyBDSF found, with ellipticities of their own."""
    found = read_catalogue(lists / "srl.fits")
    turns = np.exp(2j * np.pi * np.arange(len(found)) / len(found))
    sky = replace(found, ellipticity=0.3 * turns)
    centre = PhaseCentre(float(found.ra.mean()), float(found.dec.mean()))
    track = Track.from_clock(centre, ((-3600.0, 3600.0),), 120.0)
    plan = ObservingPlan(load_layout("vla-b"), track, Channels.from_band(1.25e9, 1.35e9, 2))
    path = lists / "field.ms"
    write_measurement_set(path, uvshear.simulate(sky, plan, noise=ScaledNoise(1e-3), seed=1))
    return path


@pytest.mark.parametrize("kind", ["srl", "gaul"])
def test_shapes_with_lists_of_every_format_are_the_same(lists, observed, kind):
    """The text lists have twelve digits; the cycles make 0.001 of the errors of a difference in the last one."""
    expected, *others = (
        uvshear.measure(observed, lists / f"{kind}.{format_}").shapes
        for format_ in ("fits", "ascii", "csv")
    )
    for found in others:
        assert found["id"].tolist() == expected["id"].tolist()
        assert found["flag"].tolist() == expected["flag"].tolist()
        for name in ("e1", "e2", "flux_fit", "scale_length"):
            error = expected[f"{name}_err"]
            assert np.all(np.abs(found[name] - expected[name]) <= 0.01 * error), name
            np.testing.assert_allclose(found[f"{name}_err"], error, rtol=0.01, err_msg=name)
