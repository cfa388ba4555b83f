"""Visibilities of a galaxy of given parameters on uv cells, and their derivatives with respect to the parameters."""

import math
from dataclasses import dataclass, replace

import numpy as np

from uvshear.galaxy import Profile
from uvshear.geometry.ellipticity import quadratic_form_derivatives, quadratic_form_of
from uvshear.shapes import kernels
from uvshear.shapes.measurement import GalaxyFit
from uvshear.typing import Array, Complex, Float

PARAMETERS = 6
"""Number of parameters of a galaxy: flux, e1, e2, ln alpha, l, m."""

LARGEST_ELLIPTICITY = 0.95
"""Largest modulus of e that a step may lead to."""

_LARGEST_STEP_OF_SIZE = 0.7
"""Largest step in ln alpha."""


@dataclass(frozen=True)
class Template:
    """Galaxies on the cells of a uv plane.

    Parameters
    ----------
    uv
        Centres of the cells [wavelengths].
    profile
        Brightness profile.
    origin
        Position relative to the centre of the plane from which the offsets of galaxies are counted [rad].
    """

    uv: Float[Array, "cell 2"]
    profile: Profile
    origin: tuple[float, float] = (0.0, 0.0)

    def model(self, fit: GalaxyFit) -> Complex[Array, " cell"]:
        """Visibilities of a galaxy [Jy]."""
        return self._phase(fit) * (np.float32(fit.flux) * self._envelope(fit))

    def responses(self, fit: GalaxyFit) -> Complex[Array, "6 cell"]:
        """Differentiate the visibilities with respect to flux [1], e1, e2, ln alpha [Jy], and l, m [Jy/rad].

        For a point source those with respect to e1, e2 and ln alpha are zero.
        """
        out = np.empty((PARAMETERS, len(self.uv)), np.complex64)
        self.write_responses(fit, out)
        return out

    def write_responses(self, fit: GalaxyFit, out: Complex[Array, "6 cell"]) -> None:
        """Write what :meth:`responses` returns."""
        form = 4 * math.pi**2 * quadratic_form_of(fit.ellipticity, fit.scale_length)
        q = _argument(self.uv, form)
        slope = self.profile.envelope_slope(q) if fit.scale_length > 0 else np.zeros_like(q)
        by_shape = 4 * math.pi**2 * quadratic_form_derivatives(fit.ellipticity, fit.scale_length)
        kernels.respond(
            self.uv, self._phase(fit), self.profile.envelope(q), slope, by_shape, fit.flux, out
        )

    def _envelope(self, fit: GalaxyFit) -> Float[Array, " cell"]:
        form = 4 * math.pi**2 * quadratic_form_of(fit.ellipticity, fit.scale_length)
        return self.profile.envelope(_argument(self.uv, form))

    def _phase(self, fit: GalaxyFit) -> Complex[Array, " cell"]:
        phase = np.empty(len(self.uv), np.complex64)
        x, y = (self.origin[axis] + float(fit.offset[axis]) for axis in (0, 1))
        kernels.turn(self.uv, x, y, phase)
        return phase


def moved(fit: GalaxyFit, step: Float[Array, " 6"]) -> GalaxyFit:
    """Galaxy after a step in its parameters, kept within the disc of ellipticities; ``snr`` is unchanged."""
    e = fit.ellipticity + complex(step[1], step[2])
    if abs(e) > LARGEST_ELLIPTICITY:
        e *= LARGEST_ELLIPTICITY / abs(e)
    size = float(np.clip(step[3], -_LARGEST_STEP_OF_SIZE, _LARGEST_STEP_OF_SIZE))
    return replace(
        fit,
        flux=fit.flux + float(step[0]),
        ellipticity=e,
        scale_length=fit.scale_length * math.exp(size),
        offset=fit.offset + step[4:6],
    )


def difference(new: GalaxyFit, old: GalaxyFit) -> Float[Array, " 6"]:
    """Step in the parameters that leads from ``old`` to ``new``."""
    e = new.ellipticity - old.ellipticity
    size = math.log(new.scale_length / old.scale_length) if old.scale_length > 0 else 0.0
    return np.array([new.flux - old.flux, e.real, e.imag, size, *(new.offset - old.offset)])


def _argument(uv: Float[Array, "cell 2"], form: Float[Array, " 3"]) -> Float[Array, " cell"]:
    q = np.empty(len(uv), np.float32)
    kernels.argument(uv, form, q)
    return q
