from dataclasses import replace

import numpy as np
import pytest

from tests.reproduce.surveys import small_survey
from uvshear.bias.isolated import FITTED
from uvshear.constants import ARCSEC, SPEED_OF_LIGHT
from uvshear.reproduce.cell_models import AtPoints, Gridded, fit_cells
from uvshear.reproduce.visibility_cells import VisibilityCells
from uvshear.shapes.measurement import GalaxyFit
from uvshear.shapes.prior import ShapePrior
from uvshear.shapes.template import Template

GALAXY = GalaxyFit(1e-4, np.array([0.1, -0.05]) * ARCSEC, 0.35 - 0.2j, 1.6 * ARCSEC, 0.0)
PRIOR = ShapePrior(float(np.log(1.6 * ARCSEC)), 0.3)


@pytest.fixture(scope="module")
def cells():
    block = small_survey().samples().block
    uv = block.uvw[:, :2] * block.frequency[0] / SPEED_OF_LIGHT
    return VisibilityCells(uv, block.weights[:, 0], 300)


@pytest.fixture(scope="module")
def data(cells):
    return cells.total(Template(cells.uv, FITTED).model(GALAXY)) / cells.weight


def _fit(cells, data, model):
    return fit_cells(data, cells.weight, model, PRIOR, GALAXY)


def test_the_gridded_model_is_the_data(cells, data):
    np.testing.assert_allclose(Gridded(cells).model(GALAXY), data, atol=1e-6 * np.abs(data).max())
    fit = _fit(cells, data, Gridded(cells))
    assert abs(fit.ellipticity - GALAXY.ellipticity) < 1e-4


def test_centres_of_cells_make_galaxies_rounder_and_means_less_so(cells, data):
    centres = _fit(cells, data, AtPoints(cells.centres))
    means = _fit(cells, data, AtPoints(cells.means))
    assert abs(centres.ellipticity) < 0.99 * abs(GALAXY.ellipticity)
    off = [abs(fit.ellipticity - GALAXY.ellipticity) for fit in (centres, means)]
    assert off[1] < off[0]


def test_responses_are_the_derivatives(cells):
    model = Gridded(cells)
    rows = model.responses(GALAXY)
    step = 1e-3
    for k, change in ((1, step), (2, 1j * step)):
        up, down = (
            model.model(replace(GALAXY, ellipticity=GALAXY.ellipticity + sign * change))
            for sign in (1, -1)
        )
        numerical = (up.astype(complex) - down) / (2 * step)
        assert np.abs(rows[k] - numerical).max() < 2e-3 * np.abs(rows[k]).max()


def test_errors_are_those_of_the_noise(cells, data):
    rng = np.random.default_rng(5)
    model = AtPoints(cells.means)
    fits = []
    for _ in range(60):
        noise = rng.standard_normal((2, len(data))) / np.sqrt(cells.weight)
        fits.append(_fit(cells, data + noise[0] + 1j * noise[1], model))
    spread = np.std([fit.ellipticity.real for fit in fits])
    assert spread == pytest.approx(np.mean([fit.error[0] for fit in fits]), rel=0.3)
