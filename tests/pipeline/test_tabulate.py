"""What was extracted as tables."""

import numpy as np


def test_rows_are_those_of_the_catalogue_in_its_order(field, kept):
    shapes = kept.shapes
    assert shapes["id"].tolist() == field.catalogue.identifier.tolist()
    np.testing.assert_allclose(shapes["ra"], np.degrees(field.catalogue.ra))
    np.testing.assert_allclose(shapes["flux"], 1e6 * field.catalogue.flux)
    assert shapes.meta["ra0_deg"] == np.degrees(field.observation.phase_centre.ra)


def test_the_sky_can_be_simulated_again(field, kept):
    """It has every source that was subtracted, with shapes and sizes; points are points."""
    sky, centre = kept.sky, field.observation.phase_centre
    assert sky.identifier.tolist() == ["s0", "s1", "s2", "s3", "s5"]
    assert sky.is_point.tolist() == [False, True, False, False, False]
    truth = field.truth.select(np.array([0, 1, 2, 3, 5]))
    galaxies = sky.galaxies(centre)
    np.testing.assert_allclose(galaxies.l, truth.l, atol=1e-7)
    np.testing.assert_allclose(galaxies.flux, truth.flux, rtol=0.05)
    assert np.abs(galaxies.ellipticity - truth.ellipticity)[[0, 2]].max() < 0.1
    assert sky.field_centre == centre
