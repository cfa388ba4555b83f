"""All sources of a field together: major cycles over the visibilities, and minor cycles on facets between them.

1. Major cycle (``major_cycle``): subtract all models from the visibilities and gather the residual as a facet of each
   source; the first cycle also gathers the beams (``beams``), and the first two leave out the longest baselines.
2. Minor cycle (``minor_cycle``): fit the sources in turn and together until they hardly move.
3. Repeat both until another major cycle would change the sources by a small fraction of the noise; the sky to subtract
   next is extrapolated from the last cycles (``acceleration``).
4. Sample the posterior of every galaxy (``shapes``), with its neighbours marginalised
   (``neighbour_marginalisation``).
5. If statistics are to be kept (``statistics``), first let the sky converge with a very wide prior on ellipticities
   (``release``).

A minor cycle mixes the beam of a source from a few, and the interaction of two sources is truncated in
distance and in baseline length. The resulting errors are a tenth to a fifth of the change since the last major cycle.
The next major cycle corrects them, because its residual is exact.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

from uvshear.execution import Executor, single_threaded_libraries
from uvshear.extraction.converged.acceleration import Cycle, next_sky
from uvshear.extraction.converged.baselines import Baselines
from uvshear.extraction.converged.extraction_state import (
    ExtractionState,
    load_baselines,
    load_extraction,
    save_extraction,
)
from uvshear.extraction.converged.foresight import Foresight
from uvshear.extraction.converged.history import History
from uvshear.extraction.converged.major_cycle import first_major_cycle, next_major_cycle
from uvshear.extraction.converged.minor_cycle import run_minor_cycle
from uvshear.extraction.converged.modelled_field import ModelledField
from uvshear.extraction.converged.planner import Planner
from uvshear.extraction.converged.reach import out_of_reach, too_large
from uvshear.extraction.converged.release import release
from uvshear.extraction.converged.shapes import measure_shapes
from uvshear.extraction.converged.sky_state import SkyState
from uvshear.extraction.converged.statistics import keep_statistics
from uvshear.extraction.converged.workload import Workload
from uvshear.extraction.extraction import Extracted, Extraction, Setting
from uvshear.extraction.field import Field
from uvshear.extraction.state_store import StateStore
from uvshear.interferometer.held_observation import HELD_PART, held
from uvshear.interferometer.uv_range import UvRange
from uvshear.interferometer.visibilities import Observation
from uvshear.predict.gridded import Gridding
from uvshear.progress import Meter, Progress
from uvshear.shapes.measurement import FitFlag
from uvshear.shapes.source_facet import Kept

ROUGH = 0.3
"""Tolerance of the first minor cycle: the next major cycle brings a larger change."""

ERROR, FINEST = 0.1, 1e-5
"""Error of the gridder over the noise, for the brightest source, and the smallest relative error in single
precision."""

AFRESH = 1
"""Number of minor cycles in which every source looks for its peak from scratch."""

WITHOUT_LONGEST = 2
"""Number of major cycles without the longest baselines, which cost two thirds of a cycle. With one such cycle the sky
of 2195 galaxies is the same after three cycles (slopes within 1e-4, remaining change 0.059 against 0.064)."""

COUPLED = 2
"""Number of minor cycles that compute the couplings of sources; later ones scale the last couplings."""


@dataclass(frozen=True)
class ConvergedExtraction(Extraction):
    """Extraction that subtracts all sources from one another until the sky model no longer changes.

    Parameters
    ----------
    tolerance
        The sky has converged when the rms change of the models of the sources falls below this number, in units of the
        noise. The change dm of a model counts as sqrt(<dm, dm>), with the noise-weighted inner product of visibilities.
    most_major_cycles
        Largest number of major cycles.
    scale_lengths
        Width of a facet over the median scale length; facets are wider for galaxies that turn out to be larger.
    epsilon
        Relative error of the gridder, unless a bright source requires a smaller one.
    shortest
        Baseline below which visibilities are left out [wavelengths]; the uv range may leave out more. By default
        baselines without information on shapes are left out (``converged.baselines``); 0 leaves out none.
    """

    models_attenuation = True
    keeps_statistics = True

    tolerance: float = 0.1
    most_major_cycles: int = 15
    scale_lengths: float = 45.0
    epsilon: float = 1e-4
    shortest: float | None = None

    def within_reach(self, field: Field) -> Field:
        """Return the field with a flag for sources that images do not represent (``converged.reach``)."""
        if len(field.modelled) == 0:
            return field
        is_galaxy = field.flags[field.modelled] == FitFlag.OK
        longest = Baselines.from_field(field, is_galaxy, 0.0).longest
        near = field.without(out_of_reach(field, longest), FitFlag.OUTSIDE_FIELD)
        return near.without(too_large(near, longest, self.scale_lengths), FitFlag.TOO_LARGE)

    def extract(
        self,
        observation: Observation,
        field: Field,
        setting: Setting,
        progress: Progress | None = None,
    ) -> Extracted:
        """Measure every source of ``field.measured``, with all others of ``field.modelled`` subtracted."""
        if len(field.modelled) == 0:
            record = {"extraction": "converged", "major_cycles": 0}
            return Extracted({}, field.sky, field.uv_range, record)
        # Threads of the linear algebra would compete with those of the fits, and change the last bits.
        with single_threaded_libraries(), setting.resources.executor.lasting() as executor:
            meter, profile = Meter(progress), setting.model.profile
            is_galaxy = field.flags[field.modelled] == FitFlag.OK
            baselines = Baselines.from_field(field, is_galaxy, self.shortest, profile)
            baselines = load_baselines(setting.store, baselines)
            observation = held(observation, HELD_PART * setting.resources.memory)
            found = self._extract(observation, field, setting, executor, meter, baselines)
            if found is None:
                baselines = baselines.without_short_ones()
                save_extraction(setting.store, ExtractionState(baselines))
                found = self._extract(observation, field, setting, executor, meter, baselines)
        assert found is not None
        return found

    def _extract(
        self,
        observation: Observation,
        field: Field,
        setting: Setting,
        executor: Executor,
        meter: Meter,
        baselines: Baselines,
    ) -> Extracted | None:
        """Measure with these baselines; None where they let the sky diverge, and fewer can be used."""
        centre, store = observation.phase_centre, setting.store
        modelled = ModelledField.from_field(field, setting.model, centre.dec)
        epsilon = self._epsilon(field)
        planner = Planner.from_field(modelled, baselines, self.scale_lengths, epsilon)
        summary = field.summary
        moments = summary.probes.scatter.shape[1]
        gridding = Gridding.within(setting.resources, summary.samples, epsilon, moments)
        gridding = replace(gridding, memory=gridding.memory - HELD_PART * setting.resources.memory)
        rough_cycles = min(WITHOUT_LONGEST, self.most_major_cycles - 1)
        workload = Workload(
            planner,
            Foresight(self.tolerance, rough_cycles, self.most_major_cycles),
            setting.keep,
            epsilon,
            executor.workers,
        )
        cycles = _Cycles(self, workload, gridding, executor, meter, store)

        reached = load_extraction(store, baselines, modelled)
        while not reached.has_converged:
            if not reached.awaits_minor_cycle:
                reached = cycles.with_major_cycle(reached, observation)
                save_extraction(store, reached)
            reached = cycles.with_minor_cycle(reached)
            if reached.history.is_diverging and baselines.limit > 0:
                return None
            save_extraction(store, reached)

        state, history = reached.sky, reached.history
        assert state is not None
        meter.begin(*workload.ending)
        posteriors = store.results("posteriors")
        meter.expect(-len(posteriors))
        measurements = measure_shapes(state, modelled, history, executor, meter.add, posteriors)
        record = self._record(history, baselines)
        statistics: Mapping[int, Kept] = {}
        if setting.keep:
            meter.begin(*workload.ending[1:])
            tolerance = self.tolerance / 2
            released, moved = release(state, tolerance, executor, meter.add, store.part("release"))
            record["released"] = [round(rms, 4) for rms in moved]
            meter.note(moves=record["released"])
            meter.begin(*workload.ending[2:])
            known = store.results("statistics")
            meter.expect(-len(known))
            statistics = keep_statistics(
                released, modelled, setting, centre, executor, meter.add, known
            )
        meter.finish()
        return Extracted(
            measurements=measurements,
            sky=modelled.sky(state.fits),
            uv_range=UvRange(baselines.shortest, field.uv_range.maximum),
            record=record,
            kept=statistics,
        )

    def _epsilon(self, field: Field) -> float:
        """Relative error of the gridder, whose absolute error shall be below the noise of the brightest source."""
        snr = float(field.sky.flux[field.modelled].max()) * math.sqrt(field.summary.weight)
        return min(self.epsilon, max(ERROR / snr, FINEST))

    def _record(self, history: History, baselines: Baselines) -> dict[str, object]:
        return {
            "extraction": "converged",
            **history.record(),
            "shortest_baseline": round(baselines.shortest, 1),
            "tolerance": self.tolerance,
        }


@dataclass(frozen=True)
class _Cycles:
    """The major and minor cycles of an extraction, from one state of the extraction to the next."""

    extraction: ConvergedExtraction
    workload: Workload
    gridding: Gridding
    executor: Executor
    meter: Meter
    store: StateStore

    def with_major_cycle(
        self, reached: ExtractionState, observation: Observation
    ) -> ExtractionState:
        """Subtract the sky that the last cycles suggest, and gather the residual."""
        state, number, meter = reached.sky, len(reached.history), self.meter
        planner, workload = self.workload.planner, self.workload
        modelled = planner.modelled
        fits = modelled.expected if state is None else next_sky(state, reached.cycles)
        is_rough = number < workload.foresight.rough_cycles
        plan = planner.plan_roughly(fits) if is_rough else planner.plan(fits)
        meter.begin(*workload.stages(reached.history, plan))
        sky = planner.subtracted(fits)
        if state is None:
            cycle = first_major_cycle(
                observation,
                plan,
                planner.plan_beams(),
                sky,
                self.gridding,
                meter.add,
                workload.share_of_beams,
            )
        else:
            known = state.interaction.beams
            cycle = next_major_cycle(observation, plan, known, sky, self.gridding, meter.add)
        couplings = state.linearisation if state and number >= COUPLED else None
        state = SkyState.from_major_cycle(cycle, modelled.sources, fits, self.executor, couplings)
        return replace(reached, sky=state, awaits_minor_cycle=True)

    def with_minor_cycle(self, reached: ExtractionState) -> ExtractionState:
        """Fit the sources to the residual of the last major cycle."""
        state, number, extraction = reached.sky, len(reached.history), self.extraction
        assert state is not None
        _, *stages = self.workload.stages(reached.history, state.interaction.plan)
        self.meter.begin(*stages)
        tolerance = extraction.tolerance if number else max(extraction.tolerance, ROUGH)
        minor = run_minor_cycle(
            state,
            tolerance,
            self.executor,
            self.meter.add,
            afresh=number < AFRESH,
            store=self.store,
            label=f"{number} with baselines from {reached.baselines.shortest}",
        )
        state, cycles = minor.state, reached.cycles
        # The first step, from the catalogue, tells nothing of those near the maximum of the likelihood.
        if number:
            expected = self.workload.planner.modelled.expected
            cycles = (*cycles, Cycle.from_state(state, expected))
        history = reached.history.with_cycle(minor.change, minor.moves)
        self.meter.note(**history.last())
        is_last = (
            history.left_undone < extraction.tolerance
            or len(history) >= extraction.most_major_cycles
        )
        return replace(
            reached,
            history=history,
            cycles=cycles,
            sky=state,
            awaits_minor_cycle=False,
            has_converged=state.interaction.plan.has_all_baselines and is_last,
        )
