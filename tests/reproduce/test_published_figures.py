import pytest

from uvshear.reproduce.names import TARGETS
from uvshear.reproduce.published_figures import PublishedFigures, estimate_of


@pytest.mark.parametrize("target", TARGETS)
def test_every_target_has_its_numbers_and_says_where_they_are_printed(target):
    published = PublishedFigures.read(target)
    assert "section" in published.where
    assert published.claim.endswith(".")
    for value in published.values.values():
        assert isinstance(value, int | float | list)


def test_numbers_come_with_their_errors():
    assert estimate_of([0.9774, 0.0025]).error == 0.0025
    assert estimate_of(14.83).error is None
    published = PublishedFigures.read("psf-zenith")
    assert published.estimate("smallest_size_arcsec2").value == 14.83
