"""The likelihood over shapes of faint galaxies against sums over all positions, cell by cell."""

import numpy as np
import pytest
from scipy.special import log_ndtr

from tests.reference import plane
from tests.shapes.facets import ALPHA, EXPONENTIAL, PRIOR, noisy
from uvshear.galaxy import DiscEllipticityPrior
from uvshear.shapes.interpolative import TemplateDecomposition
from uvshear.shapes.likelihood import sample_likelihood

SPACING = 0.12 * ALPHA
RADIUS = 4 * ALPHA


def _over_all_positions(facet, ellipticity, log_scale_length):
    """Log of the sum over a square lattice of positions, one line a shape."""
    x = np.arange(-RADIUS, RADIUS + SPACING / 2, SPACING)
    places = np.stack(np.meshgrid(x, x), axis=-1).reshape(-1, 2)
    places = places[np.hypot(*places.T) <= RADIUS]
    phased = np.real(facet.correlation[:, None] * np.exp(-2j * np.pi * facet.uv @ places.T))
    found = []
    for e, size in zip(ellipticity, log_scale_length, strict=True):
        model = plane.galaxy(facet.uv, 1.0, (0.0, 0.0), complex(e), np.exp(size)).real
        norm = facet.power @ model**2
        significance = (model @ phased) / np.sqrt(norm)
        log_terms = 0.5 * significance**2 + log_ndtr(significance)
        highest = log_terms.max()
        found.append(highest + np.log(np.exp(log_terms - highest).sum()) - 0.5 * np.log(norm))
    return np.array(found)


def _discrepancy(facet, *, decomposed):
    """Standard deviation of the difference of the logarithms over the posterior."""
    population = DiscEllipticityPrior()
    sizes = PRIOR.log_scale_length - 1.6, PRIOR.log_scale_length + 1.6
    decomposition = (
        (lambda: TemplateDecomposition.from_facet(facet, EXPONENTIAL, sizes))
        if decomposed
        else None
    )
    found = sample_likelihood(facet, PRIOR, EXPONENTIAL, population, decomposition)
    samples = found.samples
    rng = np.random.default_rng(3)
    chosen = rng.choice(len(samples.probability), 300, p=samples.probability)
    log_scale_length = samples.log_scale_length[chosen]
    exact = _over_all_positions(facet, samples.ellipticity[chosen], log_scale_length)
    return float(np.std(found.log_likelihood[chosen] - exact))


@pytest.mark.parametrize("decomposed", [False, True])
def test_faint_galaxies_have_their_positions_everywhere(decomposed):
    rng = np.random.default_rng(12)
    off = [
        _discrepancy(noisy(rng, e=0.2 + 0.1j, snr=7.0)[0], decomposed=decomposed) for _ in range(8)
    ]
    # measured 0.009; with nodes about the best fit alone, as a bright galaxy has them, 0.034, and a shear 1.3 % too low
    assert np.sqrt(np.mean(np.square(off))) < 0.016
