import pytest

from uvshear.errors import InputError
from uvshear.extraction import ConvergedExtraction, PaperExtraction
from uvshear.extraction.registry import EXTRACTIONS, extraction_named


@pytest.mark.parametrize(
    ("name", "extraction"), [("converged", ConvergedExtraction()), ("paper", PaperExtraction())]
)
def test_the_packages_extractions_are_found_by_name(name, extraction):
    assert extraction_named(name) == extraction
    assert name in EXTRACTIONS.names()


def test_an_extraction_of_a_users_own_is_found_by_its_module():
    found = extraction_named("uvshear.extraction.paper:PaperExtraction")
    assert found == PaperExtraction()


def test_what_is_no_extraction_is_refused():
    with pytest.raises(InputError, match="is not an Extraction but has the type"):
        extraction_named("uvshear.extraction.model:Model")


def test_an_unknown_name_is_refused():
    with pytest.raises(InputError, match="nonsense"):
        extraction_named("nonsense")
