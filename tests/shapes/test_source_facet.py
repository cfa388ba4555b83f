import numpy as np

from tests.shapes.facets import ALPHA, EXPONENTIAL, PRIOR, noisy
from uvshear.galaxy import DiscEllipticityPrior
from uvshear.imaging.cutout import cutout
from uvshear.shapes.shape import measure_shape
from uvshear.shapes.source_facet import Column, SourceFacet, noise_named


def test_noise_depends_on_the_seed_and_on_the_name_alone():
    draw = noise_named((3, 4), 1000)
    np.testing.assert_array_equal(draw(5), noise_named((3, 4), 1000)(5))
    for other in (draw(6), noise_named((3, 5), 1000)(5), noise_named((3,), 1000)(5)):
        assert abs(np.vdot(draw(5), other)) < 4 * 2 * np.sqrt(1000)


def test_noise_is_of_unit_variance_in_each_component():
    noise = noise_named((1,), 20_000)(2)
    for part in (noise.real, noise.imag):
        assert abs(part.mean()) < 4 / np.sqrt(20_000)
        assert abs(part.std() - 1) < 4 / np.sqrt(40_000)
    assert abs(np.mean(noise.real * noise.imag)) < 4 / np.sqrt(20_000)


def test_the_shape_is_measured_once_with_the_priors_of_the_source():
    facet, _ = noisy(np.random.default_rng(1), 0.2 + 0.1j)
    source = SourceFacet(
        facet=facet,
        cells=cutout(64, ALPHA, 0.0, 1e5),
        prior=PRIOR,
        flux=1e-4,
        profile=EXPONENTIAL,
        population=DiscEllipticityPrior(),
        draw_noise=noise_named((1,), len(facet.power)),
    )
    expected = measure_shape(facet, PRIOR, EXPONENTIAL)
    np.testing.assert_array_equal(source.shape.ellipticity, expected.ellipticity)
    assert source.shape is source.shape


def test_a_column_need_not_have_a_unit():
    assert Column("Number of cells.").unit is None
