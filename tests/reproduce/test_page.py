from dataclasses import replace

import pytest

from uvshear.reproduce.finding import Estimate, Quantity
from uvshear.reproduce.page import page_of, write_page, written
from uvshear.reproduce.reproduced_target import ReproducedTarget

TARGET = ReproducedTarget(
    "psf-zenith",
    "The PSF",
    "quick",
    1,
    100.0,
    (Quantity("R", Estimate(14.83), Estimate(15.01, 0.2), Estimate(-0.01234, 0.0021)),),
    "psf-zenith.png",
    "A picture.",
    ("First.", "Second."),
)


@pytest.mark.parametrize(
    ("estimate", "text"),
    [
        (Estimate(0.97741, 0.00254), "0.9774 ± 0.0025"),
        (Estimate(-0.0904, 0.0186), "−0.090 ± 0.019"),
        (Estimate(14.83), "14.83"),
        (Estimate(14.9991), "15.00"),
        (Estimate(-0.00002, 0.0015), "0.0000 ± 0.0015"),
        (Estimate(600.0), "600"),
        (Estimate(123.4, 25.0), "123 ± 25"),
        (Estimate(8.7e-8), "8.700e-08"),
        (Estimate(float("nan"), 0.1), ""),
        (None, ""),
    ],
)
def test_a_number_has_as_many_digits_as_its_error(estimate, text):
    assert written(estimate) == text


def test_a_section_has_the_numbers_of_both_the_picture_and_the_remarks(tmp_path):
    page = page_of([TARGET])
    assert "| R | 14.83 | 15.01 ± 0.20 | −0.0123 ± 0.0021 | +0.9 |" in page
    assert "![The PSF](psf-zenith.png)" in page
    assert "*A picture.*" in page
    assert "First. Second." in page
    assert "(`psf-zenith`, scale `quick`, seed 1, 2 min on one core)" in page
    assert "2 min on one core, commit 0123456789)" in page_of(
        [replace(TARGET, commit="0123456789")]
    )
    path = tmp_path / "index.md"
    write_page(path, [TARGET])
    assert path.read_text() == page
