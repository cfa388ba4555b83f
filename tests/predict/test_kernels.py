"""Kernels of the prediction against numpy."""

import numpy as np
import pytest

from uvshear.predict import kernels

UVW = np.random.default_rng(3).uniform(-3e4, 3e4, (3, 50))
PER_METRE = 4.7
SLOPES = np.array([[0.01, -0.02], [0.0, 0.03]])
FORMS = np.array([[3e-12, 1e-12, 2e-12], [1e-12, 0.0, 1e-12]])
LMN1 = np.array([[1e-3, 2e-3, -3e-6], [-4e-3, 0.0, -8e-6]])


@pytest.mark.parametrize(("dtype", "allowed"), [(np.float64, 1e-11), (np.float32, 1e-4)])
def test_the_argument_of_a_profile_is_a_form_of_the_shifted_baseline(dtype, allowed):
    q = np.empty((2, 50), dtype)
    kernels.profile_arguments(UVW.astype(dtype), PER_METRE, SLOPES, FORMS, q)
    for got, (x, y), (a, b, c) in zip(q, SLOPES, FORMS, strict=True):
        u, v = PER_METRE * (UVW[0] - x * UVW[2]), PER_METRE * (UVW[1] - y * UVW[2])
        expected = 4 * np.pi**2 * (a * u * u + b * u * v + c * v * v)
        np.testing.assert_allclose(got, expected, rtol=allowed)


@pytest.mark.parametrize(
    ("kernel", "dtype", "allowed"),
    [
        (kernels.add_sources, np.float64, 1e-9),
        (kernels.add_sources_single, np.float32, 3e-6),
    ],
)
@pytest.mark.parametrize("rows", [50, 2 * kernels.ROWS, 2 * kernels.ROWS + 7])
def test_sources_are_added_with_their_phases(kernel, dtype, allowed, rows):
    uvw = np.random.default_rng(3).uniform(-3e4, 3e4, (3, rows))
    real, imaginary = np.ones(rows), np.zeros(rows)
    envelope = np.stack([np.linspace(0, 1, rows), np.linspace(1, 0.5, rows)]).astype(dtype)
    flux = np.array([2.0, 0.7])
    kernel(uvw, PER_METRE, LMN1, flux, envelope, real, imaginary)
    turns = PER_METRE * (LMN1 @ uvw)
    expected = 1 + np.sum(flux[:, None] * envelope * np.exp(2j * np.pi * turns), axis=0)
    np.testing.assert_allclose(real + 1j * imaginary, expected, rtol=0, atol=allowed)


def test_planes_have_the_forms_the_taper_and_the_phases_of_their_axes():
    u, v, reach = np.linspace(-1, 1, 6), np.linspace(0, 1, 4), np.array([4, 2, 0, 1, 3, 4])
    within = np.arange(4) < reach[:, None]
    forms = np.array([[2.0, -0.5, 1.5], [1.0, 0.3, 0.7]])
    q, spectra = np.empty((2, 14)), np.full((2, 6, 4), np.nan, complex)
    kernels.plane_arguments(u, v, reach, forms, q)
    a, b, c = forms.T[:, :, None, None]
    expected = a * u[:, None] ** 2 + b * u[:, None] * v + c * v**2
    np.testing.assert_allclose(q, expected[:, within], atol=1e-14)
    taper = np.linspace(1, 0.5, 14)
    along_u, along_v = np.exp(1j * np.outer([1, 3], u)), np.exp(2j * np.outer([1, -1], v))
    kernels.plane_spectra(np.exp(-q), taper, reach, along_u, along_v, spectra)
    whole = np.zeros((6, 4))
    whole[within] = taper
    expected = whole * np.exp(-expected) * along_u[:, :, None] * along_v[:, None]
    np.testing.assert_allclose(spectra, expected, atol=1e-14)


def test_phases_along_an_axis_are_those_of_an_offset_with_the_origin_at_the_centre():
    offsets, size = np.array([0.3, -0.2]), 8
    k = np.fft.fftfreq(size).astype(np.float32)
    phases = np.empty((2, size), np.complex64)
    kernels.axis_phases(offsets, k, phases)
    from_the_corner = offsets[:, None] + size // 2
    np.testing.assert_allclose(phases, np.exp(-2j * np.pi * from_the_corner * k), atol=1e-6)


def test_stamps_are_added_at_their_corners():
    rng = np.random.default_rng(2)
    stamps, image = rng.normal(size=(3, 4, 4)), np.ones((12, 10))
    corners, flux = np.array([[0, 0], [2, 3], [8, 6]]), np.array([1.0, -2.0, 0.5])
    expected = image.copy()
    for stamp, (i, j), scale in zip(stamps, corners, flux, strict=True):
        expected[i : i + 4, j : j + 4] += scale * stamp
    kernels.add_stamps(stamps, flux, corners, image)
    np.testing.assert_allclose(image, expected, atol=1e-14)


def test_a_change_is_the_difference_times_the_beam_and_has_the_power_of_the_whole_plane():
    rng = np.random.default_rng(4)
    reach = np.array([5, 4, 1, 0, 1, 4, 5, 5])
    within = np.arange(5) < reach[:, None]
    taper, beam = rng.uniform(0, 1, within.sum()), rng.standard_normal((8, 5))
    envelopes = rng.uniform(0, 1, (2, len(taper)))
    along_u, along_v = (
        np.exp(1j * rng.uniform(0, 6, (2, 8))),
        np.exp(1j * rng.uniform(0, 6, (2, 5))),
    )
    spectrum = np.full((8, 5), np.nan, complex)
    new, old = zip(envelopes, along_u, along_v, strict=True)
    power = kernels.plane_change(new, old, taper, reach, beam, spectrum)
    sources = np.zeros((2, 8, 5), complex)
    sources[:, within] = envelopes * taper
    sources *= along_u[:, :, None] * along_v[:, None, :]
    change = sources[0] - sources[1]
    counted = np.array([1, 2, 2, 2, 1]) * beam * np.abs(change) ** 2
    assert power == pytest.approx(counted.sum(), rel=1e-6)
    np.testing.assert_allclose(spectrum, beam * change, atol=1e-14)


def test_the_power_of_a_change_does_not_depend_on_where_arrays_lie():
    """Where the loop that sums also writes, its last bits depend on the order of the arrays in memory."""
    rng = np.random.default_rng(0)
    reach = np.array([177] * 90 + [120] * 100 + [177] * 90 + [40] * 72)
    cells = int(reach.sum())
    shapes = [cells, cells, cells, (352, 2), (177, 2), (352, 2), (177, 2), (352, 177)]
    arrays = [rng.normal(size=shape).astype(np.float32) for shape in shapes]
    arrays = [x.view(np.complex64)[:, 0] if x.shape[-1] == 2 else x for x in arrays]
    arrays.append(np.zeros((352, 177), np.complex64))
    powers = set()
    for _ in range(40):
        arena, start, placed = np.empty(2_000_000, np.uint8), 0, {}
        for k in rng.permutation(len(arrays)).tolist():
            part = arena[start : start + arrays[k].nbytes].view(arrays[k].dtype)
            placed[k] = part.reshape(arrays[k].shape)
            placed[k][...] = arrays[k]
            start += -(-arrays[k].nbytes // 16) * 16
        taper, one, other, *axes, beam, spectrum = (placed[k] for k in range(len(arrays)))
        new, old = (one, *axes[:2]), (other, *axes[2:])
        powers.add(float(kernels.plane_change(new, old, taper, reach, beam, spectrum)))
    assert len(powers) == 1
