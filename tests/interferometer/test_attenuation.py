"""Smearing and primary beams: against averages over finer channels and times, and against astropy's Airy disc."""

import numpy as np
import pytest
from astropy.modeling.models import AiryDisk2D

from uvshear.constants import SPEED_OF_LIGHT
from uvshear.errors import InputError
from uvshear.geometry.directions import n_minus_one
from uvshear.interferometer.attenuation import BandwidthSmearing, CombinedAttenuation, TimeSmearing
from uvshear.interferometer.coverage import EARTH_ROTATION, antenna_uvw
from uvshear.interferometer.primary_beam import AiryBeam, CosineCubedBeam, CosineTaperBeam
from uvshear.interferometer.samples import Samples

DECLINATION = np.radians(-30.0)
FREQUENCY, WIDTH, INTERVAL = 1.07e9, 1e6, 8.0
L, M = np.sin(np.radians(0.4)), np.sin(np.radians(-0.3))
PAIRS = 60


def _antennas():
    """Up to 20 km from each other, near SKA-Mid's place on the Earth."""
    rng = np.random.default_rng(1)
    centre = np.array([5109.0e3, 2006.6e3, -3239.0e3])
    return centre + rng.uniform(-10e3, 10e3, (2 * PAIRS, 3))


def _baselines(hour_angle):
    """[m], (pair, hour angle, 3)."""
    places = antenna_uvw(_antennas(), hour_angle, DECLINATION)
    return np.swapaxes(places[:, :PAIRS] - places[:, PAIRS:], 0, 1)


def _samples(**changed):
    uvw = _baselines(np.array([0.4]))[:, 0] * (FREQUENCY / SPEED_OF_LIGHT)
    columns = {
        "uvw": uvw,
        "stokes_i": np.zeros(PAIRS, np.complex64),
        "weights": np.ones(PAIRS, np.float32),
        "frequency": np.full(PAIRS, FREQUENCY),
        "bandwidth": np.full(PAIRS, WIDTH, np.float32),
        "interval": np.full(PAIRS, INTERVAL, np.float32),
        "antennas": np.column_stack([np.arange(PAIRS), np.arange(PAIRS) + PAIRS]).astype(np.int16),
    }
    return Samples(**columns | changed)


def _averaged(*, over_channel, over_time):
    """Point's visibility averaged over 41 x 41 frequencies and times, over that in the middle."""
    x = (np.arange(41) + 0.5) / 41 - 0.5
    hours = 0.4 + EARTH_ROTATION * INTERVAL * (x if over_time else np.zeros(1))
    frequency = FREQUENCY + WIDTH * (x if over_channel else np.zeros(1))
    direction = np.array([L, M, float(n_minus_one(np.array([L]), np.array([M]))[0])])
    delay = _baselines(hours) @ direction / SPEED_OF_LIGHT
    middle = _baselines(np.array([0.4])) @ direction / SPEED_OF_LIGHT * FREQUENCY
    turns = delay[..., None] * frequency - middle[..., None]
    return np.exp(2j * np.pi * turns).mean(axis=(1, 2))


@pytest.mark.parametrize(
    ("attenuation", "over"),
    [
        (BandwidthSmearing(), {"over_channel": True, "over_time": False}),
        (TimeSmearing(DECLINATION), {"over_channel": False, "over_time": True}),
        (
            CombinedAttenuation((BandwidthSmearing(), TimeSmearing(DECLINATION))),
            {"over_channel": True, "over_time": True},
        ),
    ],
)
def test_smearing_is_the_average_over_channel_and_integration(attenuation, over):
    exact = _averaged(**over)
    factor = attenuation.factor(_samples(), L, M)
    assert factor.min() < 0.9
    # measured 2e-4 (both; the sum of the 41 x 41 is itself 1e-4 off); a sign of the rotation wrong: 0.5
    np.testing.assert_allclose(factor, exact.real, atol=6e-4)
    np.testing.assert_allclose(exact.imag, 0, atol=2e-3)


def test_nothing_is_smeared_at_the_phase_centre_or_where_widths_are_not_known():
    both = CombinedAttenuation((BandwidthSmearing(), TimeSmearing(DECLINATION)))
    nothing = np.zeros(PAIRS, np.float32)
    np.testing.assert_array_equal(both.factor(_samples(), 0.0, 0.0), 1.0)
    unknown = _samples(bandwidth=nothing, interval=nothing)
    np.testing.assert_array_equal(both.factor(unknown, L, M), 1.0)


ANTENNAS = 2 * PAIRS
DISHES = np.full(ANTENNAS, 13.5)


def test_the_airy_beam_is_astropys():
    wavelength = SPEED_OF_LIGHT / FREQUENCY
    distance = np.hypot(np.arcsin(L), np.arcsin(M))
    disc = AiryDisk2D(
        amplitude=1.0, x_0=0.0, y_0=0.0, radius=1.2196698912665045 * wavelength / 13.5
    )
    got = AiryBeam.from_diameters(DISHES).factor(_samples(), L, M)
    np.testing.assert_allclose(got, disc(distance, 0.0), rtol=1e-4)


@pytest.mark.parametrize(
    "beam",
    [
        AiryBeam.from_diameters(DISHES),
        CosineCubedBeam(np.full(ANTENNAS, 1.2e7)),
        CosineTaperBeam.meerkat(),
    ],
    ids=lambda beam: type(beam).__name__,
)
def test_a_beam_is_one_on_its_axis_and_a_half_at_half_its_width(beam):
    assert beam.factor(_samples(), 0.0, 0.0) == pytest.approx(1.0)
    half = np.sin(beam.width[0] / FREQUENCY / 2)
    assert beam.factor(_samples(), half, 0.0) == pytest.approx(0.5, abs=2e-4)
    # a beam is narrower at a higher frequency
    higher = _samples(frequency=np.full(PAIRS, 1.5 * FREQUENCY))
    np.testing.assert_array_less(beam.factor(higher, half, 0.0), 0.3)


def test_unlike_dishes_multiply_their_voltages():
    diameters = np.where(np.arange(ANTENNAS) < PAIRS, 13.5, 15.0)
    mixed = AiryBeam.from_diameters(diameters).factor(_samples(), L, M)
    small, large = (
        AiryBeam.from_diameters(np.full(ANTENNAS, diameter)).factor(_samples(), L, M)
        for diameter in (13.5, 15.0)
    )
    np.testing.assert_allclose(mixed, np.sqrt(small * large))


def test_unlike_dishes_need_known_antennas():
    beam = AiryBeam.from_diameters(np.where(np.arange(ANTENNAS) < PAIRS, 13.5, 15.0))
    unknown = _samples(antennas=np.full((PAIRS, 2), -1, np.int16))
    with pytest.raises(InputError, match="dishes differ"):
        beam.factor(unknown, L, M)
