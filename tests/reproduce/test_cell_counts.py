import numpy as np
import pytest

from uvshear.constants import MICROJANSKY
from uvshear.galaxy import SizeFluxRelation
from uvshear.reproduce.cell_counts import FixedCount, TableCount


@pytest.mark.parametrize(
    ("flux", "cells"),
    [(10, 280), (19.9, 280), (20, 350), (40, 420), (79, 460), (80, 500), (100, 550), (200, 600)],
)
def test_the_table_is_that_of_the_paper(flux, cells):
    median = float(SizeFluxRelation().median(np.array([flux * MICROJANSKY]))[0])
    assert TableCount().cells(median) == cells
    assert TableCount(100).cells(median) == cells + 100
    assert FixedCount(600).cells(median) == 600
