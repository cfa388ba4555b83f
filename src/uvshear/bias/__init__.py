"""Bias of the estimators of the shear: galaxies of known shear, simulated many times.

``mock_facets`` draws facets of isolated galaxies, from which ``isolated`` estimates a bias;
``crowded`` observes and measures whole fields. ``survey`` describes the observation and the galaxies, ``fit`` turns
sums of terms into m and c, and ``estimate`` has the function that users call.
"""

from uvshear.bias.estimate import estimate_bias, opposite_shears
from uvshear.bias.survey import Survey

__all__ = ["Survey", "estimate_bias", "opposite_shears"]
