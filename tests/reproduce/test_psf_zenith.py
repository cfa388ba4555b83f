import math

import numpy as np
import pytest

from uvshear.constants import ARCSEC
from uvshear.imaging import ImageGrid
from uvshear.reproduce.psf_zenith import PsfZenith


@pytest.fixture(scope="module")
def finding():
    target = PsfZenith(
        distances=(0.0, math.radians(60)), integration=3600.0, grid=ImageGrid(128, 0.4 * ARCSEC)
    )
    return target.finding({name: target.measure(task) for name, task in target.tasks().items()})


def test_the_psf_is_stretched_along_m_far_from_the_zenith(finding):
    e1 = finding.curves["about transit, e1"]
    assert abs(e1[0]) < 0.05
    assert e1[1] == pytest.approx(-0.2, abs=0.03)


def test_the_paper_s_size_at_the_zenith_is_that_of_an_aperture(finding):
    rows = [row for row in finding.quantities if row.name.startswith("R at 60 deg")]
    assert len(rows) >= 4
    assert all(row.paper.value == 15.54 for row in rows)
    assert all(14 < row.as_paper.value < 19 for row in rows)
    assert any("disc of radius" in row.name for row in rows)


def test_the_picture_shows_the_printed_sizes(finding):
    assert len(finding.picture.axes) == 3
    (entries,) = (ax.get_legend_handles_labels()[1] for ax in finding.picture.axes[2:])
    assert "Rivi & Miller 2018" in entries
    assert all(np.isfinite(finding.curves["about transit, R [arcsec2]"]))
