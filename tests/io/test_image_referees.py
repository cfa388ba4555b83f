"""wsclean and PyBDSF see the simulated sky where, as bright, and as elongated as it was put."""

import math
import os
import shutil
import subprocess
import sys
import textwrap

import numpy as np
import pytest
from astropy.io import fits
from astropy.table import Table
from astropy.wcs import WCS

from uvshear.constants import ARCSEC
from uvshear.diagnostics.psf import point_spread_function
from uvshear.execution import in_threads
from uvshear.galaxy import Exponential, Galaxies
from uvshear.geometry.directions import PhaseCentre
from uvshear.imaging import ImageGrid
from uvshear.interferometer.averaged_rows import FOURTH, SECOND, permutations_of
from uvshear.interferometer.coverage import Track, synthesise
from uvshear.interferometer.layout import load_layout
from uvshear.interferometer.noise import ScaledNoise
from uvshear.interferometer.samples import Samples
from uvshear.interferometer.spectral_window import Channels
from uvshear.interferometer.weighting import (
    Briggs,
    GaussianTaper,
    TukeyTaper,
    Uniform,
    weighted,
)
from uvshear.io.measurement_set.writer import write_measurement_set
from uvshear.io.observations import open_observation
from uvshear.pipeline.average import average
from uvshear.simulation.observation import SimulatedObservation

pytestmark = pytest.mark.referee

PHASE_CENTRE = PhaseCentre(math.radians(150.0), math.radians(-30.0))
PIXEL = 1.0 * ARCSEC
SIZE = 1024
BEAM = 7.0


def _galaxies(l, m, flux, scale_length, ellipticity):
    return Galaxies(
        l=np.array(l),
        m=np.array(m),
        flux=np.array(flux),
        scale_length=np.array(scale_length),
        ellipticity=np.array(ellipticity, dtype=complex),
        spectral_index=np.zeros(len(l)),
    )


def _image(directory, galaxies, *options):
    """Simulate eight hours of SKA-Mid AA2 and let wsclean image them; the restored image."""
    wsclean = shutil.which("wsclean")
    assert wsclean is not None, "wsclean is missing: make test-referees installs it"
    track = Track.from_clock(PHASE_CENTRE, ((-4 * 3600.0, 4 * 3600.0),), 240.0)
    path = directory / "field.ms"
    observation = SimulatedObservation(
        coverage=synthesise(load_layout("ska-mid-aa2"), track),
        channels=Channels.from_band(1.3e9, 1.5e9, 2),
        galaxies=galaxies,
        profile=Exponential(),
        noise=ScaledNoise(1e-4),
        seed=5,
    )
    write_measurement_set(path, observation)
    command = [wsclean, "-quiet", "-j", "2", "-no-update-model-required", "-use-wgridder"]
    command += ["-name", "image"]
    subprocess.run([*command, *options, path.name], cwd=directory, check=True, timeout=600)
    return directory / "image-image.fits"


@pytest.fixture(scope="module")
def point_image(tmp_path_factory):
    """Image of two sources to the North-East and one to the South, on pixel centres."""
    galaxies = _galaxies(
        l=[200 * PIXEL, 100 * PIXEL, 0.0],
        m=[100 * PIXEL, 300 * PIXEL, -250 * PIXEL],
        flux=[5e-3, 3e-3, 2e-3],
        scale_length=[0.0, 0.0, 0.0],
        ellipticity=[0, 0, 0],
    )
    path = _image(
        tmp_path_factory.mktemp("points"),
        galaxies,
        *("-weight", "briggs", "0", "-niter", "2000", "-mgain", "0.8", "-auto-threshold", "3"),
        *("-size", str(SIZE), str(SIZE), "-scale", "1asec", "-maxuvw-m", "20000"),
    )
    return galaxies, path


def _direction(l, m):
    """Right ascension and declination of (l, m) by turning a vector: no formula of the package."""
    ra, dec = PHASE_CENTRE.ra, PHASE_CENTRE.dec
    east = np.array([-np.sin(ra), np.cos(ra), 0])
    north = np.array([-np.sin(dec) * np.cos(ra), -np.sin(dec) * np.sin(ra), np.cos(dec)])
    towards = np.cross(east, north)
    x, y, z = l * east + m * north + math.sqrt(1 - l * l - m * m) * towards
    return math.degrees(math.atan2(y, x)) % 360, math.degrees(math.asin(z))


def test_sources_appear_in_their_directions(point_image):
    galaxies, path = point_image
    image = fits.getdata(path)[0, 0]
    wcs = WCS(fits.getheader(path), fix=False).celestial
    for l, m, flux in zip(galaxies.l, galaxies.m, galaxies.flux, strict=True):
        ra, dec = _direction(l, m)
        x, y = (float(pixel) for pixel in wcs.world_to_pixel_values(ra, dec))
        rows, columns = round(y) + np.arange(-8, 9), round(x) + np.arange(-8, 9)
        stamp = image[np.ix_(rows, columns)]
        peak_row, peak_column = np.unravel_index(np.argmax(stamp), stamp.shape)
        # the sources lie on pixels, the mirror image lies elsewhere
        assert (rows[peak_row], columns[peak_column]) == (round(y), round(x))
        assert stamp.max() == pytest.approx(flux, rel=0.01)


def test_east_is_left_and_north_is_up(point_image):
    _, path = point_image
    image = fits.getdata(path)[0, 0]
    row, column = np.unravel_index(np.argmax(image), image.shape)
    assert (row, column) == (SIZE // 2 + 100, SIZE // 2 - 200)
    header = fits.getheader(path)
    ra, dec = WCS(header, fix=False).celestial.pixel_to_world_values(column, row)
    assert ra > 150
    assert dec > -30


WEIGHTED_SIZE = 512
PADDED = 616  # 1.2 times that: the image that wsclean makes, and counts its cells by
LONGEST = 1e5  # pixels carry no longer ones, which wsclean leaves out and ours would alias


@pytest.mark.parametrize(
    ("options", "weightings"),
    [
        (("-weight", "natural"), ()),
        (("-weight", "uniform"), (Uniform(PADDED * PIXEL),)),
        (
            ("-weight", "briggs", "0.5", "-taper-gaussian", "4asec"),
            (Briggs(0.5, PADDED * PIXEL), GaussianTaper(4 * ARCSEC)),
        ),
        (
            ("-weight", "natural", "-taper-tukey", "60000"),
            (TukeyTaper(longest=LONGEST, fall=60000.0),),
        ),
    ],
    ids=["natural", "uniform", "briggs-taper", "tukey"],
)
def test_weights_are_wsclean_s(tmp_path, options, weightings):
    nobody = _galaxies([0.0], [0.0], [1e-3], [0.0], [0])
    size = ("-size", str(WEIGHTED_SIZE), str(WEIGHTED_SIZE), "-scale", "1asec")
    _image(tmp_path, nobody, "-maxuv-l", str(LONGEST), *options, *size, "-make-psf-only")
    theirs = fits.getdata(tmp_path / "image-psf.fits")[0, 0]
    cut = TukeyTaper(longest=LONGEST)
    observation = weighted(open_observation([tmp_path / "field.ms"]), (cut, *weightings))
    ours = point_spread_function(
        observation, ImageGrid(WEIGHTED_SIZE, PIXEL), executor=in_threads(2)
    )
    # columns of theirs are along -l; both have their centre at size/2
    theirs = theirs[1:, :0:-1].T
    # 0.02 and more with cells of another size, or a robustness 0.05 off
    assert np.max(np.abs(ours[1:, 1:] - theirs)) < 4e-3
    assert np.ptp(ours) > 0.9


SHAPES = [(0.35, 0.0), (0.0, 0.35), (0.0, -0.35), (-0.25, 0.25)]


def test_position_angles_are_pybdsf_s(tmp_path):
    galaxies = _galaxies(
        l=[150 * PIXEL, -150 * PIXEL, 150 * PIXEL, -150 * PIXEL],
        m=[150 * PIXEL, 150 * PIXEL, -150 * PIXEL, -150 * PIXEL],
        flux=[0.02] * 4,
        scale_length=[6 * ARCSEC] * 4,
        ellipticity=[complex(*shape) for shape in SHAPES],
    )
    path = _image(
        tmp_path,
        galaxies,
        *("-weight", "briggs", "0", "-taper-gaussian", f"{BEAM}asec", "-multiscale"),
        *("-niter", "2000", "-mgain", "0.7", "-auto-threshold", "3"),
        *("-size", "400", "400", "-scale", "1.5asec"),
    )
    catalogue = tmp_path / "sources.fits"
    script = textwrap.dedent(
        f"""
        import bdsf
        image = bdsf.process_image({str(path)!r}, thresh_isl=5, thresh_pix=7, ncores=1, quiet=True,
                                   group_by_isl=True)
        image.write_catalog(outfile={str(catalogue)!r}, format="fits", catalog_type="srl",
                            clobber=True)
        """
    )
    subprocess.run(
        [sys.executable, "-c", script],
        check=True,
        cwd=tmp_path,
        timeout=600,
        env=os.environ | {"MPLBACKEND": "Agg"},
    )
    sources = Table.read(catalogue)
    assert len(sources) == len(SHAPES)
    for index, (e1, e2) in enumerate(SHAPES):
        ra, dec = _direction(galaxies.l[index], galaxies.m[index])
        distance = np.hypot((sources["RA"] - ra) * math.cos(PHASE_CENTRE.dec), sources["DEC"] - dec)
        source = sources[int(np.argmin(distance))]
        assert distance.min() * 3600 < 0.1
        assert source["Total_flux"] == pytest.approx(0.02, rel=0.01)
        # measured 0.03 degrees; theta runs from East (l) to North (m), the position angle from North to East
        theta = math.degrees(math.atan2(e2, e1)) / 2
        difference = (source["DC_PA"] - (90 - theta) + 90) % 180 - 90
        assert abs(difference) < 0.5, (e1, e2, source["DC_PA"])
        # |e| = (a - b)/(a + b): 0.35 is an axis ratio of 0.48
        ratio = source["DC_Min"] / source["DC_Maj"]
        modulus = math.hypot(e1, e2)
        assert ratio == pytest.approx((1 - modulus) / (1 + modulus), abs=0.01)


def _dirty(path, *options):
    """Return wsclean's dirty image of a set with natural weights, or its PSF."""
    wsclean = shutil.which("wsclean")
    assert wsclean is not None, "wsclean is missing: make test-referees installs it"
    command = [wsclean, "-quiet", "-j", "2", "-no-update-model-required", "-use-wgridder"]
    command += ["-wgridder-accuracy", "1e-5", "-weight", "natural", "-name", path.stem, "-reorder"]
    command += ["-size", "512", "512", "-scale", "2asec", *options, path.name]
    subprocess.run(command, cwd=path.parent, check=True, timeout=600)
    kind = "psf" if "-make-psf-only" in options else "dirty"
    return fits.getdata(path.with_name(f"{path.stem}-{kind}.fits"))[0, 0].astype(float)


def test_averages_show_a_point_where_it_was_and_as_faint_as_their_loss_tells(tmp_path):
    track = Track.from_clock(PHASE_CENTRE, ((-3600.0, 3600.0),), 60.0)
    place = np.array([200, -150]) * 2 * ARCSEC
    path, compact = tmp_path / "field.ms", tmp_path / "compact.ms"
    observation = SimulatedObservation(
        coverage=synthesise(load_layout("meerkat"), track),
        channels=Channels.from_band(1.3e9, 1.5e9, 8),
        galaxies=_galaxies([place[0]], [place[1]], [1.0], [0.0], [0]),
        profile=Exponential(),
        noise=ScaledNoise(1e-2),
        seed=None,
    )
    write_measurement_set(path, observation)
    averaged = average(path, compact, field_arcmin=16.7)
    assert averaged.rows < averaged.samples / 4
    direction = np.array([*place, math.sqrt(1 - place @ place) - 1])
    lost = weights = 0.0
    for seen in open_observation(compact).chunks():
        samples = Samples.from_visibilities(seen, 0.0, math.inf)
        places = [*SECOND, *FOURTH]
        form = [permutations_of(one) * np.prod(2 * np.pi * direction[list(one)]) for one in places]
        lost += float(samples.weights @ (1 - np.exp(-samples.scatter.astype(float) @ form / 2)))
        weights += float(samples.weights.sum())
    loss = lost / weights
    assert loss > 3e-3  # three times what the images may differ by
    images = [_dirty(one, "-niter", "0") for one in (path, compact)]
    row, column = 256 + round(place[1] / (2 * ARCSEC)), 256 - round(place[0] / (2 * ARCSEC))
    for image in images:
        assert np.unravel_index(np.argmax(image), image.shape) == (row, column)
    before, after = (image[row, column] for image in images)
    assert after / before == pytest.approx(1 - loss, abs=1e-3)
    beams = [_dirty(one, "-make-psf-only") for one in (path, compact)]
    np.testing.assert_allclose(beams[1], beams[0], rtol=0, atol=1e-3)
