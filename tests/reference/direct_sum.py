"""The measurement equation summed over the sky: slow, obvious, and ignorant of any Fourier transform.

DATA = sum S exp(+2 pi i [u l + v m + w (n-1)]). An extended galaxy is its brightness over (l, m), sampled finely
and summed with the exact phase of every sample: no envelope, no expansion of w.
"""

import numpy as np

SPEED_OF_LIGHT = 299_792_458.0


def point_sources(l, m, flux, uvw, frequency):
    """Visibilities (row, chan) of point sources; ``flux`` is (source,) or (source, chan) [Jy]."""
    l, m = np.atleast_1d(l), np.atleast_1d(m)
    flux = np.broadcast_to(np.reshape(flux, (len(l), -1)), (len(l), len(frequency)))
    n = np.sqrt(1 - l**2 - m**2)
    vis = np.zeros((len(uvw), len(frequency)), complex)
    for chan, nu in enumerate(frequency):
        u, v, w = uvw.T * nu / SPEED_OF_LIGHT
        for s in range(len(l)):
            vis[:, chan] += flux[s, chan] * np.exp(
                2j * np.pi * (u * l[s] + v * m[s] + w * (n[s] - 1))
            )
    return vis


def brightness_samples(e, alpha, kind="exponential", radii=300, angles=256):
    """Offsets (l, m) over a galaxy of unit flux, and the flux at each.

    With y = A x / alpha the brightness is exp(-|y|) or exp(-|y|^2/2): Gauss-Legendre in |y|, equal angles.
    """
    reach = {"exponential": 36.0, "gaussian": 9.0}[kind]
    nodes, weights = np.polynomial.legendre.leggauss(radii)
    r, dr = (nodes + 1) * reach / 2, weights * reach / 2
    profile = {"exponential": np.exp(-r), "gaussian": np.exp(-(r**2) / 2)}[kind]
    theta = 2 * np.pi * np.arange(angles) / angles
    y = np.stack([np.outer(r, np.cos(theta)), np.outer(r, np.sin(theta))]).reshape(2, -1)
    shape = np.array([[1 - e.real, -e.imag], [-e.imag, 1 + e.real]])
    x = alpha * np.linalg.solve(shape, y)
    flux = np.repeat(profile * r * dr / angles, angles)
    return x[0], x[1], flux  # the integral of r exp(-r), and of r exp(-r^2/2), is 1


def galaxy(l, m, flux, e, alpha, uvw, frequency, kind="exponential", **sampling):
    """Visibilities (row, chan) of one galaxy from its brightness in the (l, m) plane."""
    dl, dm, share = brightness_samples(e, alpha, kind, **sampling)
    lx, mx = l + dl, m + dm
    n_minus_one = np.sqrt(1 - lx**2 - mx**2) - 1
    vis = np.empty((len(uvw), len(frequency)), complex)
    for chan, nu in enumerate(frequency):
        for row, (u, v, w) in enumerate(uvw * nu / SPEED_OF_LIGHT):
            vis[row, chan] = flux * np.sum(
                share * np.exp(2j * np.pi * (u * lx + v * mx + w * n_minus_one))
            )
    return vis
