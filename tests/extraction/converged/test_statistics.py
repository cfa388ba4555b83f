"""Statistics of galaxies: estimators see facets in fluxes at 1.4 GHz."""

from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np
import pytest

from tests.extraction.converged.states import nothing, touching_pair
from tests.extraction.fields import OPTIONS
from uvshear.execution import SERIAL
from uvshear.extraction.converged import statistics
from uvshear.extraction.converged.statistics import keep_statistics
from uvshear.shapes.source_facet import Column, SourceFacet
from uvshear.shapes.statistic_flag import StatisticFlag


@dataclass(frozen=True)
class Spy:
    """Keeps the power of each source, and what it saw of it, unless its catalogue's flux is the given one."""

    seen: list
    without: float | None = None
    answer: StatisticFlag | None = None
    name = "spy"
    columns: ClassVar = {"power": Column("sum of the power", "Jy-2")}

    def statistic(self, source: SourceFacet):
        self.seen.append(source)
        if source.flux == self.without:
            return self.answer
        return {"power": float(source.facet.power.sum())}


@pytest.fixture(scope="module")
def prepared():
    return touching_pair()


def _keep(prepared, modelled=None, on_source=nothing, spy=None):
    spy = spy or Spy([])
    setting = replace(OPTIONS.setting, keep=(spy,))
    modelled = modelled or prepared.modelled
    centre = prepared.observation.phase_centre
    kept = keep_statistics(prepared.state, modelled, setting, centre, SERIAL, on_source)
    fluxes = prepared.truth.flux.tolist()
    return sorted(spy.seen, key=lambda source: fluxes.index(source.flux)), kept


@pytest.mark.parametrize(
    ("answer", "word"), [(None, "not_fitted"), (StatisticFlag.TOO_LARGE, "too_large")]
)
def test_a_source_that_has_none_has_a_reason(prepared, answer, word):
    heard = []
    spy = Spy([], prepared.truth.flux[1], answer)
    seen, kept = _keep(prepared, on_source=lambda: heard.append(1), spy=spy)
    assert len(seen) == len(heard) == 2
    assert kept[1] == {"flag_spy": word}
    assert kept[0]["flag_spy"] == "ok"
    assert kept[0]["power"] == pytest.approx(prepared.state.facet(0).power.sum(), rel=1e-6)


def test_estimators_see_the_measurements_prior_and_the_catalogues_flux(prepared):
    seen, _ = _keep(prepared)
    assert np.isinf(seen[0].prior.ellipticity_sigma)
    assert seen[0].flux == prepared.truth.flux[0]
    assert seen[0].cells == prepared.state.interaction.plan.cutouts[0]
    assert np.all(seen[0].draw_noise(1)[:100] != seen[1].draw_noise(1)[:100])


def test_fluxes_are_those_at_1_4_ghz(prepared):
    field = prepared.modelled.field
    low = replace(field, sky=replace(field.sky, reference_frequency=0.7e9))
    _, kept = _keep(prepared, replace(prepared.modelled, field=low))
    # A flux at 1.4 GHz is that at 0.7 GHz times 2^-0.7: one unit of it is so much more of the facet's.
    assert kept[0]["power"] == pytest.approx(2**1.4 * prepared.state.facet(0).power.sum(), rel=1e-6)


def test_a_task_has_galaxies_of_one_kind_and_the_largest_come_first():
    rng = np.random.default_rng(4)
    kinds, sizes = rng.choice(4, 60, p=[0.1, 0.2, 0.3, 0.4]), rng.normal(size=60)
    for most in (1, 7, 100):
        parts = statistics._divided(
            range(60), lambda k: (int(kinds[k]),), lambda k: float(sizes[k]), most
        )
        assert sorted(k for part in parts for k in part) == list(range(60))
        lengths = [len(part) for part in parts]
        assert lengths == sorted(lengths, reverse=True)
        assert max(lengths) <= most
        for part in parts:
            assert len(set(kinds[part])) == 1
            assert list(sizes[part]) == sorted(sizes[part])
    assert len(parts) == 4
