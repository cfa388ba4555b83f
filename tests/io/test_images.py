"""Images in FITS files: a source stands where its right ascension and declination say."""

import numpy as np
import pytest
from astropy.coordinates import SkyCoord
from astropy.io import fits
from astropy.wcs import WCS

from tests.skies import galaxies, random_baselines
from uvshear.diagnostics.residual_image import residual_image
from uvshear.errors import InputError
from uvshear.galaxy import Exponential
from uvshear.geometry.directions import PhaseCentre
from uvshear.interferometer.summary import summarise
from uvshear.interferometer.visibilities import Visibilities, VisibilitySet
from uvshear.io.images import write_residual_image
from uvshear.predict import predict_visibilities

FREQUENCY = np.array([1.4e9])
CENTRE = SkyCoord(15.0, 60.0, unit="deg")
EAST_NORTH = SkyCoord(15.9, 60.3, unit="deg")
WEST = SkyCoord(13.8, 59.9, unit="deg")
SAID = {"version": "uvshear", "options": "word " * 40}


def _cosines(source):
    """Direction cosines from astropy's separation and position angle."""
    r, angle = np.sin(CENTRE.separation(source).rad), CENTRE.position_angle(source).rad
    return r * np.sin(angle), r * np.cos(angle)


@pytest.fixture(scope="module")
def images():
    """Two point sources in the data, one of them in the sky."""
    uvw = random_baselines(2000, 1e3)
    known, unknown = (galaxies(*_cosines(at), 1.0, alpha=0.0) for at in (WEST, EAST_NORTH))
    vis = sum(predict_visibilities(sky, uvw, FREQUENCY) for sky in (known, unknown))
    centre = PhaseCentre(CENTRE.ra.rad, CENTRE.dec.rad)
    block = Visibilities(uvw, FREQUENCY, vis, np.full(vis.shape, 4.0))
    observation = VisibilitySet(centre, (block,))
    summary = summarise(observation)
    return centre, residual_image(observation, known, Exponential(), summary=summary)


@pytest.fixture
def written(tmp_path, images):
    centre, both = images
    path = tmp_path / "residual.fits"
    write_residual_image(path, both, centre, SAID)
    return path


def test_sources_stand_at_their_right_ascension_and_declination(written):
    with fits.open(written) as hdus:
        assert [hdu.name for hdu in hdus] == ["RESIDUAL", "DIRTY"]
        for hdu, sources in ((hdus[0], [EAST_NORTH]), (hdus["DIRTY"], [EAST_NORTH, WEST])):
            image, wcs = hdu.data[0, 0], WCS(hdu.header).celestial
            for source in sources:
                x, y = wcs.world_to_pixel(source)
                near = image[round(float(y)) - 3 :, round(float(x)) - 3 :][:7, :7]
                row, column = np.unravel_index(near.argmax(), near.shape)
                # a pixel is 48 arcsec; CRPIX off by one moves one of the two coordinates by one
                assert abs(column - 3 + round(float(x)) - x) < 0.51
                assert abs(row - 3 + round(float(y)) - y) < 0.51
                assert near.max() > 0.8
        x, y = WCS(hdus[0].header).celestial.world_to_pixel(WEST)
        assert abs(hdus[0].data[0, 0][round(float(y)), round(float(x))]) < 0.2


def test_viewers_show_east_to_the_left(written):
    header = fits.getheader(written)
    assert (header["CTYPE1"], header["CTYPE2"]) == ("RA---SIN", "DEC--SIN")
    assert header["CDELT1"] < 0 < header["CDELT2"]
    x_east, y_east = WCS(header).celestial.world_to_pixel(EAST_NORTH)
    x_west, y_west = WCS(header).celestial.world_to_pixel(WEST)
    assert x_east < x_west
    assert y_east > y_west


def test_the_phase_centre_is_where_l_and_m_are_zero(written, images):
    _, both = images
    header = fits.getheader(written)
    x, y = WCS(header).celestial.world_to_pixel(CENTRE)
    middle = both.grid.size // 2
    with fits.open(written) as hdus:
        assert hdus[0].data[0, 0, round(float(y)), round(float(x))] == both.residual[middle, middle]
    np.testing.assert_allclose([x, y], [middle - 1, middle], atol=1e-6)


def test_the_header_says_what_the_image_is(written, images):
    _, both = images
    with fits.open(written) as hdus:
        for hdu, image in zip(hdus, (both.residual, both.dirty), strict=True):
            header = hdu.header
            assert (header["BUNIT"], header["BTYPE"]) == ("Jy/beam", "Intensity")
            assert (header["CTYPE3"], header["CRVAL3"]) == ("FREQ", 1.4e9)
            assert header["WSUM"] == pytest.approx(8000)
            assert header["NOISE"] == pytest.approx(8000**-0.5)
            assert header["RMS"] == pytest.approx(np.sqrt(np.mean(image**2)), rel=1e-5)
            assert header["UVMAX"] == both.uv_range.maximum
            assert header["NVIS"] == 2000
            assert header["OPTIONS"].strip() == SAID["options"].strip()
            assert hdu.data.shape == (1, 1, both.grid.size, both.grid.size)


def test_an_image_is_not_overwritten_unasked(tmp_path, images):
    centre, both = images
    path = tmp_path / "residual.fits"
    path.write_text("kept")
    with pytest.raises(InputError, match="exists already"):
        write_residual_image(path, both, centre, SAID)
    assert path.read_text() == "kept"
    write_residual_image(path, both, centre, SAID, overwrite=True)
    assert fits.getheader(path)["BUNIT"] == "Jy/beam"
    assert [p.name for p in tmp_path.iterdir()] == ["residual.fits"]


def test_another_extension_is_refused(tmp_path, images):
    centre, both = images
    with pytest.raises(InputError, match=r"give a name that ends in \.fits"):
        write_residual_image(tmp_path / "residual.jpg", both, centre, SAID)
    assert list(tmp_path.iterdir()) == []
