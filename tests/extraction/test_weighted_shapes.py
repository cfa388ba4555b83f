"""Shapes from weights other than the natural ones."""

import math
from dataclasses import replace

import numpy as np
import pytest

import uvshear
from tests.extraction.fields import field_of
from uvshear.constants import ARCSEC, MICROJANSKY, SPEED_OF_LIGHT
from uvshear.diagnostics.weighting_loss import weighting_loss
from uvshear.errors import InputError
from uvshear.estimators.moments import Moments
from uvshear.execution import Resources, in_threads
from uvshear.extraction import ConvergedExtraction, MeasurementOptions, Method, Model
from uvshear.extraction.weighted_shapes import weigh
from uvshear.galaxy import (
    CatalogueSize,
    DiscEllipticityPrior,
    Galaxies,
    PowerLawFlux,
    SizeFluxRelation,
)
from uvshear.geometry.directions import PhaseCentre
from uvshear.interferometer.coverage import Track, synthesise
from uvshear.interferometer.layout import load_layout
from uvshear.interferometer.visibilities import Visibilities, VisibilitySet
from uvshear.interferometer.weighting import Briggs, GaussianTaper, RoundPsf, weighted
from uvshear.io.catalogue import catalogue_from_galaxies
from uvshear.predict import predict_visibilities
from uvshear.shapes.measurement import FitFlag
from uvshear.simulation.population import Population, draw_population
from uvshear.simulation.sky_region import SquareField

CENTRE = PhaseCentre(0.3, math.radians(10.0))
FREQUENCY = np.array([1.07e9])
OPTIONS = MeasurementOptions(resources=Resources(in_threads(2)))


def join(first: Galaxies, second: Galaxies) -> Galaxies:
    """Both lists, one after the other."""
    names = ("l", "m", "flux", "scale_length", "ellipticity", "spectral_index")
    return Galaxies(
        **{name: np.append(getattr(first, name), getattr(second, name)) for name in names}
    )


@pytest.fixture(scope="module")
def field():
    """Eighty galaxies at an SNR of 60 or so, far enough apart, 41 degrees from the zenith of SKA-Mid AA2."""
    rng = np.random.default_rng(12)
    population = Population(
        PowerLawFlux(minimum=90 * MICROJANSKY, maximum=110 * MICROJANSKY),
        SizeFluxRelation(),
        DiscEllipticityPrior(),
    )
    galaxies = draw_population(population, SquareField(math.radians(0.4)), number=80, rng=rng)
    track = Track.from_clock(CENTRE, ((-14400.0, 14400.0),), 3600.0)
    uvw = synthesise(load_layout("ska-mid-aa2"), track).uvw
    uvw = uvw[np.hypot(uvw[:, 0], uvw[:, 1]) * FREQUENCY[0] / SPEED_OF_LIGHT > 3e3]
    vis = predict_visibilities(galaxies, uvw, FREQUENCY)
    sigma = 100 * MICROJANSKY / 90 * math.sqrt(len(uvw))
    vis = vis + sigma * (rng.normal(size=vis.shape) + 1j * rng.normal(size=vis.shape))
    block = Visibilities(uvw, FREQUENCY, vis.astype(np.complex64), np.full(vis.shape, sigma**-2))
    return galaxies, VisibilitySet(CENTRE, (block,))


def _measured(field, *weightings):
    galaxies, observation = field
    catalogue = catalogue_from_galaxies(galaxies, CENTRE)
    method = Method(weightings=weightings)
    measured = uvshear.measure(observation, catalogue, method=method, resources=OPTIONS.resources)
    return measured.shapes


def _pull_width(galaxies, shapes):
    """Width of (measured - true)/error by its median, which outliers leave alone."""
    good = np.array(shapes["flag"]) == "ok"
    assert good.sum() > 70
    true = {"e1": galaxies.ellipticity.real, "e2": galaxies.ellipticity.imag}
    pulls = [((shapes[name] - true[name]) / shapes[f"{name}_err"])[good] for name in true]
    return 1.4826 * float(np.median(np.abs(np.concatenate(pulls))))


@pytest.fixture(scope="module")
def natural(field):
    return _measured(field)


@pytest.mark.long
def test_errors_are_as_right_as_those_of_natural_weights(field, natural):
    """Of 160 numbers and the same noise a width is good to 0.1; with Briggs weights as they are it is 0.4 or so."""
    briggs = _measured(field, Briggs(0.0, math.radians(0.2)))
    width = _pull_width(field[0], briggs)
    assert abs(width - _pull_width(field[0], natural)) < 0.3
    assert abs(width - 1) < 0.25


@pytest.mark.long
def test_a_taper_costs_precision_and_leaves_the_snr(field, natural):
    tapered = _measured(field, GaussianTaper(4 * ARCSEC))
    assert abs(_pull_width(field[0], tapered) - 1) < 0.25
    ratio = np.array(tapered["snr"] / natural["snr"])
    assert np.nanmedian(ratio) == pytest.approx(1, abs=0.02)
    errors = np.array(tapered["e1_err"] / natural["e1_err"])
    assert 1.05 < np.nanmedian(errors) < 1.4


def _options(*weightings):
    return MeasurementOptions(Model(size=CatalogueSize()), Method(weightings=weightings))


def test_points_have_no_part_in_the_typical_size(field):
    """The scale is that of the galaxies, whatever else is in the field."""
    galaxies, observation = field
    few = galaxies.select(np.arange(4))
    points = replace(few, l=few.l + 0.001, scale_length=np.zeros(4))
    scales = []
    for sky in (few, join(few, points)):
        options = _options(Briggs(0.0, 0.003))
        catalogue = catalogue_from_galaxies(sky, CENTRE)
        prepared = field_of(observation, catalogue, options)
        assert not np.any(prepared.flags == FitFlag.DUPLICATE)
        scales.append(weigh(observation, prepared, options)[0].scale)
    assert scales[1] == pytest.approx(scales[0], rel=1e-12)


def test_the_errors_of_each_galaxy_are_corrected_by_its_size(field):
    """The scale and the correction together are what the loss of a galaxy of that size asks for."""
    galaxies, observation = field
    taper = (GaussianTaper(4 * ARCSEC),)
    options = _options(*taper)
    catalogue = catalogue_from_galaxies(galaxies, CENTRE)
    prepared = field_of(observation, catalogue, options)
    seen, correction = weigh(observation, prepared, options)
    cells = weighted(observation, taper).map_baselines()
    losses = [
        weighting_loss(cells, float(size), OPTIONS.model.profile) for size in galaxies.scale_length
    ]
    wanted = np.array([1 / loss.variance_over_beam for loss in losses])
    assert np.ptp(wanted) > 0.3 * wanted.mean()
    np.testing.assert_allclose(seen.scale * correction, wanted, rtol=0.02)


@pytest.mark.long
def test_a_correction_widens_the_errors_of_e(field):
    galaxies, observation = field
    few = galaxies.select(np.arange(12))
    sources = catalogue_from_galaxies(few, CENTRE)
    prepared = field_of(observation, sources, OPTIONS)
    whole, less = (
        ConvergedExtraction()
        .extract(
            observation,
            replace(prepared, weight_correction=np.full(12, correction)),
            OPTIONS.setting,
        )
        .measurements
        for correction in (1.0, 0.5)
    )
    ratio = [less[k].covariance[0, 0] / whole[k].covariance[0, 0] for k in whole]
    assert np.median(ratio) == pytest.approx(2, abs=0.2)


def test_statistics_are_kept_of_natural_weights_alone():
    with pytest.raises(InputError, match="another weighting cannot be combined with them"):
        MeasurementOptions(method=Method(weightings=(RoundPsf(),)), keep=(Moments(),))
