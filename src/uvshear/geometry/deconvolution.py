r"""Width of a source without the beam, from a Gaussian that was fitted to an image.

The full widths at half maximum a, b at the position angle p stand for the matrix

.. math:: C = a^2\,u u^T + b^2\,v v^T,\quad u = (\cos p, \sin p),\quad v = (-\sin p, \cos p)

in the axes North and East. Matrices add in a convolution, so that the source has C of the fit less C of the beam. The
errors of its eigenvalues are propagated from those of a, b and p to first order.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from uvshear.typing import Array, Float

RESOLVED = 2.0
"""A source is resolved if the square of its long axis is positive by more than this many standard errors."""

SHORTEST = 0.5
"""Smallest ratio of the axes that is believed, because the short one is often not resolved."""


@dataclass(frozen=True)
class FittedGaussians:
    """Gaussians fitted to an image: full widths at half maximum and position angles [rad].

    Parameters
    ----------
    major, minor
        Axes.
    angle
        Position angle of the long axis, from North through East.
    major_err, minor_err, angle_err
        Standard errors; 0 where they are not known.
    """

    major: Float[Array, " source"]
    minor: Float[Array, " source"]
    angle: Float[Array, " source"]
    major_err: Float[Array, " source"]
    minor_err: Float[Array, " source"]
    angle_err: Float[Array, " source"]

    @property
    def matrix(self) -> Float[Array, "source 2 2"]:
        """The matrix C [rad^2]."""
        return matrix_of(self.major, self.minor, self.angle)

    @property
    def steps(self) -> Float[Array, "parameter source 2 2"]:
        """Changes of C by one standard error of each parameter [rad^2]."""
        along, across = _axes(self.angle)
        turned = _outer(along, across) + _outer(across, along)
        factors = (
            2 * self.major * self.major_err,
            2 * self.minor * self.minor_err,
            (self.major**2 - self.minor**2) * self.angle_err,
        )
        matrices = (_outer(along, along), _outer(across, across), turned)
        return np.stack([f[:, None, None] * m for f, m in zip(factors, matrices, strict=True)])


class Widths(NamedTuple):
    """Widths without the beam: geometric means of the two full widths at half maximum [rad].

    Parameters
    ----------
    width
        Width; of a source that is not resolved, an upper limit.
    err
        Standard error of the width to first order; 0 where it is not known.
    is_resolved
        Whether the width is more than an upper limit.
    """

    width: Float[Array, " source"]
    err: Float[Array, " source"]
    is_resolved: Array


def matrix_of(
    major: Float[Array, " source"],
    minor: Float[Array, " source"],
    angle: Float[Array, " source"],
) -> Float[Array, "source 2 2"]:
    """Return the matrix C [rad^2] of axes and position angles [rad]."""
    along, across = _axes(angle)
    return (major**2)[:, None, None] * _outer(along, along) + (minor**2)[:, None, None] * _outer(
        across, across
    )


def deconvolved_widths(fitted: FittedGaussians, beam: Float[Array, "source 2 2"]) -> Widths:
    """Return the widths of sources from fitted Gaussians and the matrix C of the beam at each [rad^2].

    The short axis counts as at least half of the long one. A source that is not resolved is smaller than
    sqrt(max(x, 0) + 2 s), where x is the square of the long axis and s its standard error; without errors of the fit,
    it is smaller than the beam.
    """
    values, vectors = np.linalg.eigh(fitted.matrix - beam)
    short, long = values.T
    # The first-order change of an eigenvalue is the change of the matrix along its eigenvector.
    changes = np.einsum("sik,psij,sjk->psk", vectors, fitted.steps, vectors)
    long_err = np.sqrt(np.sum(changes[..., 1] ** 2, axis=0))
    is_resolved = (long > 0) & (long >= RESOLVED * long_err)
    limit = np.maximum(long, 0.0) + RESOLVED * long_err
    hidden_by_beam = np.sqrt(np.maximum(np.linalg.det(beam), 0.0))
    limit = np.where(long_err > 0, limit, hidden_by_beam)

    positive = np.where(is_resolved, long, 1.0)
    floor = SHORTEST**2 * positive
    follows = short <= floor  # the short axis is then half of the long one
    shown = np.where(follows, floor, short)
    relative = changes[..., 1] / positive
    relative_short = np.where(follows, relative, changes[..., 0] / shown)
    width = (positive * shown) ** 0.25
    err = width * np.sqrt(np.sum((relative + relative_short) ** 2, axis=0)) / 4
    return Widths(
        np.where(is_resolved, width, np.sqrt(limit)),
        np.where(is_resolved, err, 0.0),
        is_resolved,
    )


def _axes(angle: Float[Array, " source"]) -> tuple[Array, Array]:
    """Return unit vectors along and across a position angle, in the axes North and East."""
    cosine, sine = np.cos(angle), np.sin(angle)
    return np.stack([cosine, sine], axis=-1), np.stack([-sine, cosine], axis=-1)


def _outer(first: Array, second: Array) -> Float[Array, "source 2 2"]:
    return first[:, :, None] * second[:, None, :]
