"""What every profile must satisfy, whoever wrote it."""

import galsim
import numpy as np

from uvshear.galaxy.profile import Profile
from uvshear.geometry.ellipticity import add_shear, quadratic_form, sheared_scale_length

EXACT = galsim.GSParams(kvalue_accuracy=1e-16, maxk_threshold=1e-12)

Q = np.concatenate([[0.0], np.geomspace(1e-4, 30, 400)])

RTOL = {np.float32: 3e-6, np.float64: 1e-13}
"""Relative error of a profile in one precision against itself in numpy's float64; measured 5e-7 and 0."""


def transform(profile, e, scale_length, uv):
    a, b, c = quadratic_form(np.array([e]), np.array([scale_length]))
    u, v = uv
    return profile.envelope(4 * np.pi**2 * (a * u**2 + b * u * v + c * v**2))


def galsim_transform(galaxy, uv):
    return np.array([galaxy.kValue(2 * np.pi * u, 2 * np.pi * v).real for u, v in uv.T])


def check_profile(profile: Profile) -> None:
    """Raise unless ``profile`` is normalised, falls, keeps its dtype and knows its own slope."""
    envelope = profile.envelope(Q)
    assert envelope[0] == 1
    assert np.all(np.diff(envelope) < 0)
    assert np.all(envelope > 0)
    slope = profile.envelope_slope(Q)
    step = 1e-5 * (1 + Q[1:])
    difference = (profile.envelope(Q[1:] + step) - profile.envelope(Q[1:] - step)) / (2 * step)
    # measured 4e-9 of the slope; a wrong power: 1
    np.testing.assert_allclose(slope[1:], difference, rtol=2e-8)
    numeric = Profile.envelope_slope(profile, Q)
    np.testing.assert_allclose(numeric, slope, rtol=3e-4)  # 1.3e-4 at q = 0, one-sided; else 4e-7
    for dtype in (np.float32, np.float64):
        check_dtype(profile, dtype, envelope, slope)


def check_dtype(profile, dtype, envelope, slope):
    q = Q.astype(dtype)
    for got, expected in ((profile.envelope(q), envelope), (profile.envelope_slope(q), slope)):
        assert got.dtype == dtype
        assert got is not q
        np.testing.assert_allclose(got, expected, rtol=RTOL[dtype], atol=0)
    np.testing.assert_array_equal(q, Q.astype(dtype))  # the input is left alone


def check_galsim(profile: Profile, circular: type[galsim.GSObject] | object) -> None:
    """Raise unless GalSim's ``circular(radius)``, sheared, has this transform to 1e-10."""
    uv = np.random.default_rng(1).uniform(-0.6, 0.6, (2, 60))
    for e in (0j, 0.4 + 0j, 0.4j, -0.2 - 0.5j, 0.3 + 0.7j):
        scale_length = 0.7
        reference = circular(scale_length / np.sqrt(1 - abs(e) ** 2)).shear(g1=e.real, g2=e.imag)
        np.testing.assert_allclose(
            transform(profile, e, scale_length, uv), galsim_transform(reference, uv), atol=1e-10
        )


def check_lensing(profile: Profile, circular: type[galsim.GSObject] | object) -> None:
    """Raise unless shear and magnification are the maps that GalSim makes of ``circular(radius)``."""
    uv = np.random.default_rng(2).uniform(-0.6, 0.6, (2, 60))
    for e in (0j, 0.4 + 0j, 0.2 - 0.5j):
        galaxy = circular(0.7 / np.sqrt(1 - abs(e) ** 2)).shear(g1=e.real, g2=e.imag)
        for g in (0.05 + 0j, 0.05j, -0.2 + 0.3j):
            sheared = add_shear(np.array([e]), g)
            alpha = sheared_scale_length(np.array([0.7]), np.array([e]), sheared)[0]
            got = transform(profile, sheared[0], alpha, uv)
            expected = galsim_transform(galaxy.shear(g1=g.real, g2=g.imag), uv)
            np.testing.assert_allclose(got, expected, atol=1e-10)  # at fixed alpha: 1e-2
            mu = 1.3
            got = mu * transform(profile, sheared[0], alpha * np.sqrt(mu), uv)
            expected = galsim_transform(galaxy.lens(g1=g.real, g2=g.imag, mu=mu), uv)
            np.testing.assert_allclose(got, expected, atol=1e-10)


def check_any_shape(profile: Profile) -> None:
    """Raise unless arrays of any shape keep it."""
    q = np.linspace(0, 3, 12)
    for function in (profile.envelope, profile.envelope_slope):
        np.testing.assert_array_equal(function(q.reshape(3, 4)), function(q).reshape(3, 4))
