"""All kinds of inputs, and how often each is drawn."""

import numpy as np

from tests.fuzz.case import Kind
from tests.fuzz.catalogues import Catalogues
from tests.fuzz.json_files import JsonFiles
from tests.fuzz.layouts import Layouts
from tests.fuzz.measurement_sets import MeasurementSets
from tests.fuzz.shapes import Shapes
from tests.fuzz.statistics import Statistics

KINDS: dict[str, Kind] = {
    "measurement set": MeasurementSets(),
    "catalogue": Catalogues(),
    "layout": Layouts(),
    "json": JsonFiles(),
    "shapes": Shapes(),
    "statistics": Statistics(),
}
SHARES = {
    "measurement set": 0.4,
    "catalogue": 0.25,
    "layout": 0.05,
    "json": 0.1,
    "shapes": 0.1,
    "statistics": 0.1,
}
"""Part of the cases that each kind has."""


def kind_of(seed: int) -> str:
    """Draw the kind of the case of a seed."""
    names = list(SHARES)
    return names[np.random.default_rng([seed, 1]).choice(len(names), p=list(SHARES.values()))]
