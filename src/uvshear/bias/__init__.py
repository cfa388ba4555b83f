"""Bias of the estimators of the shear: galaxies of known shear, simulated many times.

``mock_facets`` draws galaxies that are alone in the beam, ``isolated`` measures their bias; ``crowded`` observes and
measures whole fields. ``survey`` says what is observed, ``fit`` turns sums into m and c, ``estimate`` does all of it.
"""

from uvshear.bias.estimate import estimate_bias, opposite_shears
from uvshear.bias.fit import Bias
from uvshear.bias.survey import Survey

__all__ = ["Bias", "Survey", "estimate_bias", "opposite_shears"]
