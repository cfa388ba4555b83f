"""What estimators work out from facets: weights that are shared, and noise that is a source's own."""

import numpy as np
import pytest

from uvshear.bias.mock_facets import FacetSimulator
from uvshear.constants import ARCSEC
from uvshear.estimators.bayesian import Bayesian
from uvshear.estimators.metacal import Metacal
from uvshear.estimators.moments import Moments
from uvshear.galaxy import DiscEllipticityPrior, Exponential
from uvshear.imaging.cutout import cutout
from uvshear.shapes.measurement import GalaxyFit
from uvshear.shapes.prior import ShapePrior
from uvshear.shapes.source_facet import SourceFacet, noise_named


def _source(longest=100e3, *, name=(1, 2), unit=1.0, within=None):
    """A galaxy of SNR 300 or so; the array ends at ``longest``, the facet at ``within`` [wavelengths]."""
    width = 45 * ARCSEC
    cells = cutout(100, width / 100, 0.0, 100e3)
    distance = np.hypot(*cells.uv.T)
    power = cells.multiplicity * np.where(distance < longest, 1e11 * np.exp(-distance / 15e3), 0.0)
    noise = np.random.default_rng(4).standard_normal((2, len(power)))
    galaxy = GalaxyFit(5e-5, np.zeros(2), 0.3 - 0.1j, ARCSEC, 0.0)
    simulator = FacetSimulator(cells, power)
    facet = simulator.facet(galaxy, Exponential(), noise[0] + 1j * noise[1]).in_other_unit(unit)
    if within is not None:
        facet, cells = facet.within(within), cutout(cells.size, cells.pixel, 0.0, within)
    return SourceFacet(
        facet=facet,
        cells=cells,
        prior=ShapePrior(float(np.log(ARCSEC)), 0.3),
        flux=5e-5,
        profile=Exponential(),
        population=DiscEllipticityPrior(),
        draw_noise=noise_named(name, len(facet.power)),
    )


@pytest.mark.parametrize("estimator", [Moments, Metacal, Bayesian], ids=lambda kind: kind.__name__)
def test_weights_are_made_once_for_all_units_of_the_flux(estimator):
    """A source whose spectral index is its own has a facet in a unit of its own."""
    shared, other = estimator(), estimator()
    first = shared.statistic(_source())
    again = shared.statistic(_source(unit=1.3))
    fresh = other.statistic(_source(unit=1.3))
    for name, value in fresh.items():
        scale = np.abs(np.asarray(value)).max() + 1e-12
        np.testing.assert_allclose(again[name], value, atol=1e-5 * scale)
    if estimator is Moments:
        assert first["m1"] == pytest.approx(1.3 * again["m1"])
        assert first["m1_var"] == pytest.approx(1.3**2 * again["m1_var"])
        assert len(shared._functionals) == 1
    if estimator is Metacal:
        assert len(shared._beams) == 1


def test_sources_that_differ_in_long_baselines_share_weights():
    estimator = Moments()
    whole = estimator.statistic(_source())
    part = estimator.statistic(_source(within=92e3))
    # Moments reach 90 kilowavelengths, errors of the position a little more: to rounding they are the same.
    assert part["m1"] == pytest.approx(whole["m1"], rel=1e-4)


def test_sources_of_other_fields_have_other_noise():
    estimator = Metacal()
    here, there = (estimator.statistic(_source(name=(field, 7))) for field in (1, 2))
    assert here["mc1"] != there["mc1"]


def test_a_round_beam_is_no_wider_than_the_array():
    """MeerKAT's, of a bright galaxy; a beam as wide as SKA-Mid's has responses between -10 and 110 there."""
    estimator = Metacal()
    for number in range(3):
        kept = estimator.statistic(_source(25e3, name=(1, number)))
        response = np.array([kept["mc_r11"], kept["mc_r22"]])
        assert np.all((response > 5) & (response < 25))
        assert abs(kept["mc_r12"]) < 0.6 * response.min()
