"""Results of a measurement: shapes, statistics and the fitted sky, in memory or in files."""

from collections.abc import Mapping
from contextlib import nullcontext
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Self

import numpy as np
from astropy.table import Table

from uvshear.diagnostics.residual_image import DirtyAndResidual, residual_image
from uvshear.errors import InputError
from uvshear.estimators import ESTIMATORS, estimator_of
from uvshear.execution import Resources
from uvshear.extraction import Model
from uvshear.interferometer.summary import ObservationSummary, summarise
from uvshear.interferometer.uv_range import UvRange
from uvshear.interferometer.visibilities import Observation
from uvshear.io.catalogue import Catalogue, read_catalogue, write_catalogue
from uvshear.io.checkpoint import CheckpointStore
from uvshear.io.outputs import check_file, new_outputs
from uvshear.io.provenance import Provenance
from uvshear.io.run_identity import RUN, companion, new_run, run_in_file, run_of
from uvshear.io.shapes import extraction_record, metadata, read_shapes, write_shapes
from uvshear.io.statistics import read_statistics, statistics_path, write_statistics
from uvshear.io.tables import check_table_name
from uvshear.pipeline.observation import ObservationLike, observation_of
from uvshear.predict.gridded import Gridding
from uvshear.progress import Meter, Progress, Stage


@dataclass(frozen=True)
class MeasuredField:
    """The observation that was measured, with its model, and the executor and memory for work on it."""

    observation: Observation
    summary: ObservationSummary
    model: Model
    resources: Resources


@dataclass(frozen=True, repr=False)
class Measurement:
    """Shapes of the sources of a catalogue, with the statistics and the sky of the same fit.

    Parameters
    ----------
    shapes
        One row for every source of the catalogue, in its order, with units and descriptions (``io.shapes.COLUMNS``).
    statistics
        Statistics that estimators of the shear need in addition to the shapes, one row for every source; None if none
        were kept.
    sky
        The sources that were subtracted, with their fitted parameters; a catalogue that can be simulated.
    record
        Facts about the course of the extraction, such as the number of cycles.
    field
        The observation that was measured; None for a measurement that was read from files.
    checkpoint
        The stored state of the measurement, which is removed when the measurement is written; None if there is none.
    """

    shapes: Table
    statistics: Table | None
    sky: Catalogue | None
    record: Mapping[str, object]
    field: MeasuredField | None = None
    checkpoint: CheckpointStore | None = None

    def __len__(self) -> int:
        return len(self.shapes)

    def __repr__(self) -> str:
        flags, counts = np.unique(np.asarray(self.shapes["flag"]).astype(str), return_counts=True)
        tally = ", ".join(f"{count} {flag}" for flag, count in zip(flags, counts, strict=True))
        lines = [f"Measurement of {len(self)} sources: {tally}"]
        is_ok = np.asarray(self.shapes["flag"]).astype(str) == "ok"
        if is_ok.any():
            snr = np.asarray(self.shapes["snr"], float)[is_ok]
            error = np.asarray(self.shapes["e_sigma"], float)[is_ok]
            lines.append(
                f"  signal-to-noise ratio {snr.min():.3g} to {snr.max():.3g} (median {np.median(snr):.3g}),"
                f" median error of e {np.median(error):.3g}"
            )
        kept = ", ".join(self.estimators) or "none (only `mean` can be used)"
        lines.append(f"  statistics kept for: {kept}")
        lines += [f"  {line}" for line in _course(self.record)]
        return "\n".join(lines)

    @property
    def estimators(self) -> tuple[str, ...]:
        """Names of the estimators whose statistics were kept."""
        if self.statistics is None:
            return ()
        if named := str(self.statistics.meta.get("estimators", "")):
            return tuple(named.split(","))
        # Files of version 0.1.0 do not name them.
        own = (estimator_of(name) for name in ESTIMATORS.own)
        known = set(self.statistics.colnames)
        return tuple(
            estimator.name
            for estimator in own
            if estimator.columns and set(estimator.columns) <= known
        )

    def write(self, path: str | Path, *, overwrite: bool = False) -> None:
        """Write files of the shapes, the statistics and the sky (:func:`companions`), all or none of them."""
        target = Path(path)
        check_outputs(target, overwrite=overwrite)
        statistics, sky = companions(target)
        known = metadata(self.shapes)
        made = {name: str(known[name]) for name in Provenance.KEYS if name in known}
        made[RUN] = run_of(self.shapes) or new_run(self.shapes, made)
        shapes = self.shapes.copy(copy_data=False)
        shapes.meta[RUN] = made[RUN]
        # A companion without its table was left by a table that is gone.
        replaces = overwrite or not target.exists()
        stored = nullcontext() if self.checkpoint is None else self.checkpoint.until_written()
        with stored, new_outputs(target) as outputs:
            if self.statistics is not None:
                write_statistics(outputs.new(statistics, overwrite=replaces), self.statistics, made)
            if self.sky is not None:
                write_catalogue(outputs.new(sky, overwrite=replaces), self.sky, made)
            write_shapes(outputs.new(target, overwrite=overwrite), shapes)
        # Files of an earlier measurement would be refused beside this one.
        for file, content in ((statistics, self.statistics), (sky, self.sky)):
            if content is None and file.exists() and run_in_file(file) is not None:
                file.unlink()

    def with_provenance(self, provenance: Provenance) -> Self:
        """Return the measurement with the provenance that its files will have."""
        shapes = self.shapes.copy()
        shapes.meta.update(provenance.metadata())
        return replace(self, shapes=shapes)

    def residual_image(
        self,
        observation: ObservationLike | None = None,
        *,
        model: Model | None = None,
        resources: Resources | None = None,
        progress: Progress | None = None,
    ) -> DirtyAndResidual:
        """Return the dirty image of the baselines that were used, and the residual image without the fitted sky.

        Parameters
        ----------
        observation, model
            The observation that was measured, and the assumptions about it. They are needed if the measurement was read
            from files.
        resources
            Executor and memory.
        progress
            Function called with the work done so far and the total work.
        """
        if self.sky is None:
            raise InputError(
                "the fitted sky is not available: its file (SHAPES.sky.fits for SHAPES.fits) is not beside the"
                " table of shapes"
            )
        field = self._field(observation, model, resources)
        centre = field.observation.phase_centre
        meter = Meter(progress)
        samples, moments = field.summary.samples, field.summary.probes.scatter.shape[1]
        meter.begin(Stage("residual image", samples, samples, "visibilities"))
        is_modelled = self.record.get("models_attenuation", True)
        limits = self.record.get("uv_range")
        images = residual_image(
            field.observation,
            self.sky.galaxies(centre),
            field.model.profile,
            summary=field.summary,
            uv_range=UvRange(*limits) if isinstance(limits, list) else UvRange(),
            gridding=Gridding.within(field.resources, samples, moments=moments),
            attenuation=field.model.attenuation(centre.dec) if is_modelled else None,
            # Every sample is predicted once and imaged twice.
            step=lambda samples: meter.add(samples / 3),
        )
        meter.finish()
        return images

    def _field(
        self,
        observation: ObservationLike | None,
        model: Model | None,
        resources: Resources | None,
    ) -> MeasuredField:
        known = self.field
        if observation is not None:
            seen = observation_of(observation)
            known = MeasuredField(seen, summarise(seen), Model(), Resources())
        if known is None:
            raise InputError(
                "this measurement was read from files, which do not contain the visibilities; pass the observation"
                " as well"
            )
        return replace(known, model=model or known.model, resources=resources or known.resources)


def _course(record: Mapping[str, object]) -> list[str]:
    """Return lines about the course of an extraction."""
    facts = {name: value for name, value in record.items() if not isinstance(value, list)}
    cycles, left, most = (
        facts.pop(name, None) for name in ("major_cycles", "left_undone", "left_undone_most")
    )
    lines = []
    if left is not None:
        lines.append(
            f"{cycles} major cycles; one more would change the model of a source by {left} times the noise (rms over"
            f" all sources), and by at most {most} times the noise for any single source"
        )
    if facts:
        lines.append(", ".join(f"{name} {value}" for name, value in facts.items()))
    return lines


def companions(shapes: Path) -> tuple[Path, Path]:
    """Names of the files of statistics and of the sky that go with a table of shapes."""
    return statistics_path(shapes), companion(shapes, "sky")


def check_outputs(shapes: Path, *, overwrite: bool) -> None:
    """Refuse outputs of a measurement that cannot be written, before anything is computed for them.

    A companion is replaced if its table of shapes is, or is gone. A file of the name of a companion that no measurement
    wrote is never replaced.
    """
    check_table_name(shapes)
    check_file(shapes, overwrite=overwrite)
    is_gone = not shapes.exists()
    for path in companions(shapes):
        check_file(path, overwrite=overwrite or is_gone)
        if path.exists() and run_in_file(path) is None:
            raise InputError(
                f"{path}: exists already, and no measurement wrote it; it would be replaced by a file that goes with"
                f" {shapes}, so give another name for the shapes"
            )


def read_measurement(path: str | Path) -> Measurement:
    """Read the table of shapes of a measurement, and the files that go with it."""
    target = Path(path)
    shapes = read_shapes(target)
    statistics, sky = companions(target)
    return Measurement(
        shapes=shapes,
        statistics=read_statistics(statistics, target, shapes) if statistics.exists() else None,
        sky=_read_sky(sky, target, shapes) if sky.exists() else None,
        record=extraction_record(shapes),
    )


def _read_sky(path: Path, shapes_path: Path, shapes: Table) -> Catalogue:
    if (run_in_file(path) or None) != run_of(shapes):
        raise InputError(
            f"{path}: belongs to another measurement than {shapes_path}; measure again"
        )
    return read_catalogue(path)
