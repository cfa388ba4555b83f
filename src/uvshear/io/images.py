"""Images in FITS files, with the coordinates that viewers and source finders expect."""

from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType

import numpy as np
from astropy.io import fits

from uvshear.diagnostics.residual_image import DirtyAndResidual, root_mean_square
from uvshear.errors import InputError
from uvshear.geometry.directions import PhaseCentre
from uvshear.imaging import ImageGrid
from uvshear.io.outputs import new_file
from uvshear.typing import Array, Float


def check_image_name(path: Path) -> None:
    """Refuse a name without the extension of FITS."""
    if path.suffix.lower() != ".fits":
        raise InputError(f"{path}: an image is written as FITS; give a name that ends in .fits")


def write_residual_image(
    path: Path | str,
    images: DirtyAndResidual,
    phase_centre: PhaseCentre,
    metadata: Mapping[str, str] = MappingProxyType({}),
    *,
    overwrite: bool = False,
) -> None:
    """Write the residual image as primary HDU and the dirty image as HDU ``DIRTY``, completely or not at all.

    Parameters
    ----------
    metadata
        Record of the command (``io.provenance``): keys of at most eight letters, with values in ASCII.
    """
    path = Path(path)
    check_image_name(path)
    primary, dirty = (
        kind(fits_order(image), header=_header(images, image, phase_centre, metadata))
        for kind, image in ((fits.PrimaryHDU, images.residual), (fits.ImageHDU, images.dirty))
    )
    primary.header["EXTNAME"] = "RESIDUAL"
    dirty.header["EXTNAME"] = "DIRTY"
    with new_file(path, overwrite=overwrite) as temporary:
        fits.HDUList([primary, dirty]).writeto(temporary)


def fits_order(image: Float[Array, "l m"]) -> Float[Array, "stokes frequency m l"]:
    """Image in the order of FITS: its first axis, the last of numpy, is right ascension and grows to the West."""
    return np.ascontiguousarray(image[::-1].T, dtype=np.float32)[None, None]


def celestial(grid: ImageGrid, phase_centre: PhaseCentre) -> dict[str, str | float]:
    """Keywords for the coordinates of an image in :func:`fits_order`, orthographic about the phase centre."""
    pixel = float(np.degrees(grid.pixel))
    middle = grid.size // 2
    return {
        "CTYPE1": "RA---SIN",
        "CRVAL1": float(np.degrees(phase_centre.ra)),
        "CDELT1": -pixel,
        "CRPIX1": float(grid.size - middle),
        "CUNIT1": "deg",
        "CTYPE2": "DEC--SIN",
        "CRVAL2": float(np.degrees(phase_centre.dec)),
        "CDELT2": pixel,
        "CRPIX2": float(middle + 1),
        "CUNIT2": "deg",
        "RADESYS": "ICRS",
    }


def _header(
    images: DirtyAndResidual,
    image: Float[Array, "l m"],
    phase_centre: PhaseCentre,
    metadata: Mapping[str, str],
) -> fits.Header:
    header = fits.Header()
    header["BUNIT"] = "Jy/beam"
    header["BTYPE"] = "Intensity"
    header.update(celestial(images.grid, phase_centre))
    header["CTYPE3"], header["CRVAL3"] = "FREQ", images.frequency
    header["CDELT3"], header["CRPIX3"], header["CUNIT3"] = 1.0, 1.0, "Hz"
    header["SPECSYS"] = "TOPOCENT"
    header["CTYPE4"], header["CRVAL4"] = "STOKES", 1.0
    header["CDELT4"], header["CRPIX4"] = 1.0, 1.0
    header["WSUM"] = (images.weight, "sum of the natural weights [Jy^-2]")
    header["NOISE"] = (images.noise, "thermal, 1/sqrt(WSUM) [Jy/beam]")
    header["RMS"] = (root_mean_square(image), "of this image [Jy/beam]")
    header["NVIS"] = (images.samples, "visibilities imaged")
    header["UVMIN"] = (images.uv_range.minimum, "shortest baseline imaged [wavelengths]")
    header["UVMAX"] = (images.uv_range.maximum, "longest baseline imaged [wavelengths]")
    for name, text in metadata.items():
        header[name.upper()] = text
    for line in (
        "Natural weights, divided by WSUM: a point source of S Jy peaks at S.",
        "RESIDUAL: all models subtracted from the visibilities. DIRTY: nothing subtracted.",
        "Baselines beyond UVMAX, which the pixels are too coarse to represent, are left out.",
    ):
        header["COMMENT"] = line
    return header
