import numpy as np
import pytest

from tests.extraction.sources import ALPHA, PROFILE, part
from tests.skies import L_BAND, galaxies, vla
from uvshear.execution import in_threads
from uvshear.extraction.paper.cell_average import CellAverageFacets
from uvshear.extraction.paper.exact import ExactFacets
from uvshear.extraction.paper.facet_gathering import FacetAccumulator
from uvshear.extraction.paper.facets import Target
from uvshear.interferometer.accumulate import accumulate
from uvshear.interferometer.uv_range import UvRange
from uvshear.interferometer.visibilities import Visibilities, VisibilitySet
from uvshear.predict import predict_visibilities

SKY = galaxies([0.001, -0.002, 0.0], [0.0, 0.001, -0.001], [3e-4, 2e-4, 1e-4], ALPHA, 0.2j)
MEMBERS = (0, 2)
MODELS = [SKY.select(np.array([k])) for k in MEMBERS]


def _observation(pieces):
    uvw, centre = vla("b", samples=2)
    vis = predict_visibilities(SKY, uvw, L_BAND, PROFILE)
    seen = Visibilities(uvw, L_BAND, vis, np.ones(vis.shape))
    return VisibilitySet(
        centre, tuple(part(seen, rows) for rows in np.array_split(np.arange(len(uvw)), pieces))
    )


def _facets(pieces, threads, on_chunk=None):
    gathering = FacetAccumulator(_builders(MEMBERS), MODELS, in_threads(threads), on_chunk)
    (facets,) = accumulate(_observation(pieces), [gathering])
    return facets


def _builders(members):
    targets = [Target(SKY.select(np.array([k])), ALPHA, UvRange(0.0, 5e4), 1.4e9) for k in members]
    return [ExactFacets().open(target, PROFILE) for target in targets]


def test_threads_change_no_bit_of_a_facet():
    for alone, together in zip(_facets(3, 1), _facets(3, 3), strict=True):
        np.testing.assert_array_equal(alone.correlation, together.correlation)
        np.testing.assert_array_equal(alone.power, together.power)


def test_every_chunk_is_reported():
    rows = []
    _facets(4, 2, rows.append)
    assert len(rows) == 4
    assert sum(rows) == 702


def test_a_builder_without_a_member_is_a_mistake():
    with pytest.raises(ValueError, match="zip"):
        FacetAccumulator(_builders([0]), MODELS)


@pytest.mark.parametrize("method", [ExactFacets(), CellAverageFacets()], ids=type)
def test_a_pass_in_two_parts_gives_the_facets_of_one(method):
    targets = [Target(model, ALPHA, UvRange(0.0, 5e4), 1.4e9) for model in MODELS]

    def gathering():
        return FacetAccumulator([method.open(target, PROFILE) for target in targets], MODELS)

    (whole,) = accumulate(_observation(2), [gathering()])
    first, later = gathering(), gathering()
    chunks = _observation(2).blocks
    first.add(chunks[0])
    later.add(chunks[1])
    first.merge(later)
    for facet, expected in zip(first.result(), whole, strict=True):
        np.testing.assert_allclose(facet.correlation, expected.correlation, rtol=1e-6, atol=1e-20)
        np.testing.assert_allclose(facet.power, expected.power, rtol=1e-6, atol=1e-6)
