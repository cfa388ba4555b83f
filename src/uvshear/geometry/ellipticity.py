"""Effects of shear, rotation and a change of axes on an ellipse with e = e1 + i e2, |e| = (a-b)/(a+b) < 1.

In the (l, m) frame an ellipse with e1 > 0 is long along l, and one with e2 > 0 along l = m (docs/conventions.md). The
formulas are elementwise; arrays may have any shapes that broadcast.
"""

import numpy as np

from uvshear.typing import Array, Complex, Float


def add_shear(
    e: Complex[Array, "..."], g: complex | Complex[Array, "..."]
) -> Complex[Array, "..."]:
    r"""Ellipticity of a galaxy of ellipticity e behind the reduced shear g.

    .. math:: e' = \frac{e + g}{1 + g^* e}

    Parameters
    ----------
    e
        Intrinsic ellipticity.
    g
        Reduced shear in the same frame, abs(g) < 1.

    References
    ----------
    Rivi & Miller 2018, section 5 (unnumbered), after Seitz & Schneider 1997.
    """
    return (e + g) / (1 + np.conj(g) * e)


def sheared_scale_length(
    scale_length: Float[Array, "..."], e: Complex[Array, "..."], e_sheared: Complex[Array, "..."]
) -> Float[Array, "..."]:
    r"""Scale length of a galaxy whose ellipticity a shear has changed.

    .. math:: \alpha' = \alpha \sqrt{\frac{1 - |e'|^2}{1 - |e|^2}}

    The isophote of radius alpha has the area pi alpha^2 / (1 - abs(e)^2), where the divisor is det A of
    :func:`quadratic_form`, and a shear of unit magnification preserves areas. Rivi & Miller 2018 leave alpha unchanged,
    which is not a linear map of the sky.

    Parameters
    ----------
    scale_length
        alpha at ellipticity ``e`` [rad].
    e, e_sheared
        Ellipticity before the shear, and after it, from :func:`add_shear`.

    Notes
    -----
    A lens of convergence kappa also magnifies, by mu = 1/((1-kappa)^2 (1-abs(g)^2)), which multiplies alpha by sqrt(mu)
    and the flux by mu. ``shear`` of GalSim has unit magnification, and ``lens`` has mu.
    """
    return scale_length * np.sqrt((1 - _square(e_sheared)) / (1 - _square(e)))


def quadratic_form(
    e: Complex[Array, "..."], scale_length: Float[Array, "..."]
) -> tuple[Float[Array, "..."], Float[Array, "..."], Float[Array, "..."]]:
    r"""Coefficients (a, b, c) of the ellipse in the uv plane [rad^2].

    .. math::
        \alpha^2 |A^{-T} k|^2 &= a u^2 + b u v + c v^2,\quad
        A = \begin{pmatrix} 1-e_1 & -e_2 \\ -e_2 & 1+e_1 \end{pmatrix} \\
        (a, b, c) &= \frac{\alpha^2}{(1-|e|^2)^2}
        \left(1 + |e|^2 + 2 e_1,\ 4 e_2,\ 1 + |e|^2 - 2 e_1\right)

    A profile is a function of q, which is 4 pi^2 times this form.

    Parameters
    ----------
    e
        Ellipticity in the (l, m) frame.
    scale_length
        alpha [rad].

    References
    ----------
    Rivi & Miller 2018, eq. 1 and 2.
    """
    square = _square(e)
    scale = (scale_length / (1 - square)) ** 2
    return scale * (1 + square + 2 * e.real), scale * 4 * e.imag, scale * (1 + square - 2 * e.real)


def quadratic_form_of(e: complex, scale_length: float) -> Float[Array, " 3"]:
    """Coefficients (a, b, c) of :func:`quadratic_form` for one galaxy, in a tenth of the time."""
    square = e.real * e.real + e.imag * e.imag
    scale = (scale_length / (1 - square)) ** 2
    return np.array(
        (
            scale * (1 + square + 2 * e.real),
            scale * 4 * e.imag,
            scale * (1 + square - 2 * e.real),
        )
    )


def quadratic_form_derivatives(e: complex, scale_length: float) -> Float[Array, "3 3"]:
    """Differentiate (a, b, c) of one galaxy with respect to e1, e2 and ln alpha, one row each [rad^2]."""
    e1, e2 = e.real, e.imag
    rest = 1 - e1 * e1 - e2 * e2
    scale = (scale_length / rest) ** 2
    a, b, c = quadratic_form_of(e, scale_length).tolist()
    by_e1, by_e2 = 4 * e1 / rest, 4 * e2 / rest
    return np.array(
        (
            (by_e1 * a + scale * (2 * e1 + 2), by_e1 * b, by_e1 * c + scale * (2 * e1 - 2)),
            (by_e2 * a + scale * 2 * e2, by_e2 * b + scale * 4, by_e2 * c + scale * 2 * e2),
            (2 * a, 2 * b, 2 * c),
        )
    )


def rotate(e: Complex[Array, "..."], angle: float | Float[Array, "..."]) -> Complex[Array, "..."]:
    r"""Ellipticity of a galaxy that is turned by an angle from l towards m.

    .. math:: e' = e\,e^{2 i \phi}

    Parameters
    ----------
    e
        Ellipticity before the rotation.
    angle
        Angle phi [rad].
    """
    return e * np.exp(2j * angle)


def to_local_north(
    e: Complex[Array, "..."], psi: float | Float[Array, "..."]
) -> Complex[Array, "..."]:
    r"""Ellipticity relative to local East and local North, given that in the (l, m) frame.

    .. math:: e_\mathrm{local} = e\,e^{2 i \psi}

    Parameters
    ----------
    e
        Ellipticity in the (l, m) frame of the phase centre.
    psi
        Angle of local North, from :func:`uvshear.geometry.directions.local_north` [rad].
    """
    return e * np.exp(2j * psi)


def position_angle(e_local: Complex[Array, "..."]) -> Float[Array, "..."]:
    r"""Angle of the long axis from local North through East, in [0, pi) [rad].

    .. math:: \mathrm{PA} = \frac{\pi}{2} - \frac{1}{2}\arg e_\mathrm{local} \mod \pi

    Parameters
    ----------
    e_local
        Ellipticity relative to local East and North, from :func:`to_local_north`.
    """
    return np.mod(np.pi / 2 - np.angle(e_local) / 2, np.pi)


def lensing_components(
    e_local: Complex[Array, "..."],
) -> tuple[Float[Array, "..."], Float[Array, "..."]]:
    """Components (g1, g2) in the convention of lensing catalogues and TreeCorr for RA and Dec.

    g1 = e1 and g2 = -e2: seen from inside the sphere, East is to the left, which mirrors the diagonals and leaves the
    axes (tested with TreeCorr 5.1).

    Parameters
    ----------
    e_local
        Ellipticity or shear relative to local East and North, from :func:`to_local_north`.
    """
    return e_local.real, -e_local.imag


def to_field_frame(
    g: Complex[Array, "..."], psi: float | Float[Array, "..."]
) -> Complex[Array, "..."]:
    r"""Ellipticity or shear in the (l, m) frame of a field, from that in the frame of lensing catalogues.

    .. math:: e = g^*\,e^{-2 i \psi}

    This is the inverse of :func:`to_local_north` followed by :func:`lensing_components`: g1 + i g2 refers to local
    North, which is TreeCorr's convention for RA and Dec, and e1 + i e2 to the axes l and m of the phase centre.

    Parameters
    ----------
    g
        g1 + i g2 in the sky frame.
    psi
        Angle of local North, from :func:`uvshear.geometry.directions.local_north` [rad].
    """
    return np.conj(g) * np.exp(-2j * psi)


def _square(e: Complex[Array, "..."]) -> Float[Array, "..."]:
    return e.real**2 + e.imag**2
