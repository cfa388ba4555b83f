"""Ellipticity and size of a point spread function, from its quadrupole moments and from its main lobe."""

import math
from dataclasses import dataclass
from typing import Final

import numpy as np
from scipy.ndimage import label
from scipy.optimize import least_squares

from uvshear.constants import ARCSEC
from uvshear.errors import InputError
from uvshear.typing import Array, Float

WEIGHT_SIGMA: Final = 3 * ARCSEC
"""Width of the weight that reproduces the sizes R of Rivi & Miller 2018, section 5 [rad]."""

MOST_ROUNDS: Final = 500

FEWEST_PIXELS: Final = 9
"""Smallest number of pixels of a main lobe that can be fitted."""


@dataclass(frozen=True)
class PsfShape:
    """Shape of a point spread function.

    Parameters
    ----------
    ellipticity
        e1 + i e2, |e| = (a-b)/(a+b), in the (l, m) frame.
    size
        R = Q_ll + Q_mm [rad^2].
    weight_sigma
        Width of the Gaussian weight, det(covariance)^(1/4) [rad].
    """

    ellipticity: complex
    size: float
    weight_sigma: float


def measure_psf(
    image: Float[Array, "l m"], pixel: float, weight_sigma: float = WEIGHT_SIGMA
) -> PsfShape:
    r"""Measure quadrupole moments with a Gaussian weight that has the ellipticity of the PSF itself.

    .. math::
        Q_{ij} &= \frac{\sum I W x_i x_j}{\sum I W},\quad
        W = e^{-x^T C^{-1} x / 2},\quad C = \sigma^2 Q / \sqrt{\det Q} \\
        e &= \frac{Q_{ll} - Q_{mm} + 2 i Q_{lm}}{Q_{ll} + Q_{mm} + 2 \sqrt{\det Q}},\quad
        R = Q_{ll} + Q_{mm}

    Parameters
    ----------
    image
        Centred: ``image[i, j]`` at l = (i - size/2) pixel, m = (j - size/2) pixel.
    pixel
        Width of a pixel [rad].
    weight_sigma
        Width sigma of the weight [rad].

    References
    ----------
    Rivi & Miller 2018, section 5 (unnumbered), after Schneider 2006; the adaptive weight,
    Bernstein & Jarvis 2002, AJ 123, 583, section 3.

    Notes
    -----
    The weight's area is fixed: if it were adapted as well, it would not converge for the natural PSF of an
    interferometer, whose plateau is wider than any weight.
    """
    offset = (np.arange(len(image)) - len(image) // 2) * pixel
    l, m = offset[:, None], offset[None, :]
    covariance = np.eye(2) * weight_sigma**2
    for _ in range(MOST_ROUNDS):
        inverse = np.linalg.inv(covariance)
        exponent = inverse[0, 0] * l**2 + 2 * inverse[0, 1] * l * m + inverse[1, 1] * m**2
        weighted = image * np.exp(-exponent / 2)
        mass = float(weighted.sum())
        q_ll = float((weighted * l**2).sum()) / mass
        q_mm = float((weighted * m**2).sum()) / mass
        q_lm = float((weighted * l * m).sum()) / mass
        determinant = q_ll * q_mm - q_lm**2
        if not (mass > 0 and q_ll > 0 and determinant > 0):
            raise InputError(
                "the second moments of the PSF are not positive with a Gaussian weight of sigma"
                f" {weight_sigma / ARCSEC:g} arcsec; use a narrower weight"
            )
        root = math.sqrt(determinant)
        adapted = weight_sigma**2 / root * np.array([[q_ll, q_lm], [q_lm, q_mm]])
        change = float(np.max(np.abs(adapted - covariance))) / weight_sigma**2
        covariance = adapted
        if change < 1e-7:
            break
    return PsfShape(ellipticity_of(q_ll, q_lm, q_mm), q_ll + q_mm, weight_sigma)


@dataclass(frozen=True)
class MainLobe:
    """Gaussian fitted to the main lobe of a point spread function.

    Parameters
    ----------
    ellipticity
        e1 + i e2, in the (l, m) frame.
    fwhm
        Full width at half maximum, the geometric mean of both axes [rad].
    """

    ellipticity: complex
    fwhm: float


def fit_main_lobe(image: Float[Array, "l m"], pixel: float) -> MainLobe:
    """Fit a Gaussian of height 1 by least squares where the lobe is above half of its peak.

    Parameters
    ----------
    image
        Image as in :func:`measure_psf`, 1 at its centre.
    """
    centre = len(image) // 2
    regions, _ = label(image > 0.5)
    inside = (regions == regions[centre, centre]) & (image > 0.5)
    edge = np.concatenate([inside[0], inside[-1], inside[:, 0], inside[:, -1]])
    offset = np.arange(len(image)) - centre
    l, m = (axis[inside].astype(float) for axis in np.meshgrid(offset, offset, indexing="ij"))
    squares, values = np.stack([l * l, 2 * l * m, m * m]), image[inside]
    is_there = inside[centre, centre] and not edge.any() and len(values) >= FEWEST_PIXELS
    if is_there:
        start = np.linalg.lstsq(squares.T, -np.log(values), rcond=None)[0]
        form = least_squares(lambda form: np.exp(-form @ squares) - values, start).x
        is_there = form[0] > 0 and form[0] * form[2] > (1 + 1e-9) * form[1] ** 2
    if not is_there:
        raise InputError(
            f"the main lobe of the PSF is not resolved by an image {len(image)} pixels across with pixels of"
            f" {pixel / ARCSEC:g} arcsec, or does not fit into it; change --pixel-arcsec, or enlarge the image by a"
            " larger --weight-sigma-arcsec"
        )
    covariance = np.linalg.inv(2 * form[[0, 1, 1, 2]].reshape(2, 2)) * pixel**2
    q_ll, q_lm, q_mm = covariance[[0, 0, 1], [0, 1, 1]].tolist()
    area = math.sqrt(q_ll * q_mm - q_lm**2)
    return MainLobe(ellipticity_of(q_ll, q_lm, q_mm), math.sqrt(8 * math.log(2) * area))


def ellipticity_of(q_ll: float, q_lm: float, q_mm: float) -> complex:
    """Ellipticity of quadrupole moments, as in :func:`measure_psf`."""
    root = math.sqrt(q_ll * q_mm - q_lm**2)
    return complex(q_ll - q_mm, 2 * q_lm) / (q_ll + q_mm + 2 * root)
