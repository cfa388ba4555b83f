import numpy as np

from uvshear.diagnostics.slope import fit_slope
from uvshear.reproduce.slope_panel import slope_panel


def test_each_way_has_the_slopes_of_both_components():
    rng = np.random.default_rng(5)
    true, error = rng.uniform(-0.5, 0.5, 100), np.full(100, 0.1)
    first, second = (fit_slope(true, factor * true, error) for factor in (0.9, 0.8))
    panel = slope_panel({"one way": [first, second], "another": [second, first]})
    one, another = panel.curves
    assert (one.label, another.label) == ("one way", "another")
    np.testing.assert_allclose(one.y, [0.9, 0.8])
    np.testing.assert_allclose(another.y, [0.8, 0.9])
    assert len(panel.names) == len(one.x) == 2
