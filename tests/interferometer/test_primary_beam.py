"""Primary beams, against astropy's Airy disc and their own widths."""

import numpy as np
import pytest
from astropy.modeling.models import AiryDisk2D

from tests.interferometer.baselines import FREQUENCY, PAIRS, L, M, samples
from uvshear.constants import SPEED_OF_LIGHT
from uvshear.errors import InputError
from uvshear.interferometer.primary_beam import AiryBeam, CosineCubedBeam, CosineTaperBeam

ANTENNAS = 2 * PAIRS
DISHES = np.full(ANTENNAS, 13.5)


def test_the_airy_beam_is_astropys():
    wavelength = SPEED_OF_LIGHT / FREQUENCY
    distance = np.hypot(np.arcsin(L), np.arcsin(M))
    disc = AiryDisk2D(
        amplitude=1.0, x_0=0.0, y_0=0.0, radius=1.2196698912665045 * wavelength / 13.5
    )
    got = AiryBeam.from_diameters(DISHES).factor(samples(), L, M)
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
    assert beam.factor(samples(), 0.0, 0.0) == pytest.approx(1.0)
    half = np.sin(beam.width[0] / FREQUENCY / 2)
    assert beam.factor(samples(), half, 0.0) == pytest.approx(0.5, abs=2e-4)
    # a beam is narrower at a higher frequency
    higher = samples(frequency=np.full(PAIRS, 1.5 * FREQUENCY))
    np.testing.assert_array_less(beam.factor(higher, half, 0.0), 0.3)


def test_unlike_dishes_multiply_their_voltages():
    diameters = np.where(np.arange(ANTENNAS) < PAIRS, 13.5, 15.0)
    mixed = AiryBeam.from_diameters(diameters).factor(samples(), L, M)
    small, large = (
        AiryBeam.from_diameters(np.full(ANTENNAS, diameter)).factor(samples(), L, M)
        for diameter in (13.5, 15.0)
    )
    np.testing.assert_allclose(mixed, np.sqrt(small * large))


def test_unlike_dishes_need_known_antennas():
    beam = AiryBeam.from_diameters(np.where(np.arange(ANTENNAS) < PAIRS, 13.5, 15.0))
    unknown = samples(antennas=np.full((PAIRS, 2), -1, np.int16))
    with pytest.raises(InputError, match="the data contain other antennas"):
        beam.factor(unknown, L, M)


def test_the_cosine_cubed_beam_is_as_wide_as_that_of_lit_discs():
    np.testing.assert_array_equal(
        CosineCubedBeam.from_diameters(DISHES).width, AiryBeam.from_diameters(DISHES).width
    )


def test_a_beam_is_one_where_the_dishes_point():
    beam = AiryBeam.from_diameters(DISHES, pointing=(L, M))
    assert beam.factor(samples(), L, M) == pytest.approx(1.0)
    assert beam.factor(samples(), 0.0, 0.0).max() < 0.7


@pytest.mark.parametrize("unknown", [0.0, np.nan])
def test_a_diameter_that_is_not_given_is_named(unknown):
    diameters = np.array([13.5, unknown, 15.0])
    with pytest.raises(InputError, match="dish of antenna 1 is not known"):
        AiryBeam.from_diameters(diameters)


@pytest.mark.parametrize("diameters", [DISHES, np.where(np.arange(ANTENNAS) % 3, 13.5, 15.0)])
def test_the_samples_of_one_channel_have_the_factors_that_they_have_among_others(diameters):
    beam = AiryBeam.from_diameters(diameters)
    one = np.full(PAIRS, FREQUENCY)
    two = np.where(np.arange(PAIRS) < PAIRS - 1, FREQUENCY, 1.1 * FREQUENCY)
    alone, among = (beam.factor(samples(frequency=frequency), L, M) for frequency in (one, two))
    assert alone[-1] > among[-1] > 0
    np.testing.assert_allclose(alone[:-1], among[:-1], rtol=1e-13)
