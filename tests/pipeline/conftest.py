"""One measured field for several test files."""

import pytest

from tests.pipeline.fields import METHOD, MODEL, vla_field
from uvshear.execution import Resources, Serial
from uvshear.pipeline.measure import measure


@pytest.fixture(scope="session")
def field():
    return vla_field()


@pytest.fixture(scope="session")
def kept(field):
    """A measurement with the moments."""
    return measure(
        field.observation,
        field.catalogue,
        keep="moments",
        model=MODEL,
        method=METHOD,
        resources=Resources(Serial()),
    )
