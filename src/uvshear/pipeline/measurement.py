"""What a measurement gives: shapes, statistics, the sky that was found; in memory, or in files."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Self

import numpy as np
from astropy.table import Table

from uvshear.diagnostics.residual_image import DirtyAndResidual, residual_image
from uvshear.errors import InputError
from uvshear.execution import Resources
from uvshear.extraction import MeasurementOptions, Model
from uvshear.interferometer.summary import ObservationSummary, summarise
from uvshear.interferometer.uv_range import UvRange
from uvshear.interferometer.visibilities import Observation
from uvshear.io.catalogue import Catalogue, read_catalogue, write_catalogue
from uvshear.io.observations import open_observation
from uvshear.io.outputs import check_file
from uvshear.io.provenance import Provenance
from uvshear.io.shapes import extraction_record, read_shapes, write_shapes
from uvshear.io.statistics import read_statistics, statistics_path, write_statistics
from uvshear.io.tables import check_table_name
from uvshear.predict.gridded import Gridding, block_of
from uvshear.progress import Meter, Progress


@dataclass(frozen=True)
class MeasuredField:
    """The observation that was measured, and how."""

    observation: Observation
    summary: ObservationSummary
    uv_range: UvRange
    options: MeasurementOptions


@dataclass(frozen=True, repr=False)
class Measurement:
    """Shapes of the sources of a catalogue, and what was found beside them.

    Parameters
    ----------
    shapes
        One row for every source of the catalogue, in its order, with units and descriptions (``io.shapes.COLUMNS``).
    statistics
        What estimators of the shear need beside the shapes, one row for every source; None if nothing was kept.
    sky
        The sources that were subtracted, as they were found; a catalogue that can be simulated.
    record
        How the extraction went.
    field
        The observation that was measured; None of a measurement that was read from files.
    """

    shapes: Table
    statistics: Table | None
    sky: Catalogue | None
    record: Mapping[str, object]
    field: MeasuredField | None = None

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
        kept = (
            [] if self.statistics is None else self.statistics.meta.get("estimators", "").split(",")
        )
        lines.append(
            f"  statistics kept for: {', '.join(filter(None, kept)) or 'no estimator but the mean'}"
        )
        told = [
            f"{name} {value}" for name, value in self.record.items() if not isinstance(value, list)
        ]
        lines.append(f"  {', '.join(told)}")
        return "\n".join(lines)

    def write(self, path: str | Path, *, overwrite: bool = False) -> None:
        """Write the shapes, and beside them the statistics and the sky (:meth:`companions`); all or none of them."""
        target = Path(path)
        check_outputs(target, overwrite=overwrite)
        statistics, sky = companions(target)
        made = {
            name: self.shapes.meta[name] for name in Provenance.KEYS if name in self.shapes.meta
        }
        if self.sky is not None:
            write_catalogue(sky, self.sky, made, overwrite=overwrite)
        if self.statistics is not None:
            write_statistics(statistics, self.statistics, made, overwrite=overwrite)
        elif overwrite:
            statistics.unlink(missing_ok=True)
        write_shapes(target, self.shapes, overwrite=overwrite)

    def with_provenance(self, provenance: Provenance) -> Self:
        """Return the measurement with what its files say of how they were made."""
        shapes = self.shapes.copy()
        shapes.meta.update(provenance.metadata())
        return replace(self, shapes=shapes)

    def residual_image(
        self,
        observation: Observation | str | Path | None = None,
        *,
        model: Model | None = None,
        resources: Resources | None = None,
        progress: Progress | None = None,
    ) -> DirtyAndResidual:
        """Image the baselines that took part, and what is left of them without the sky that was found.

        Parameters
        ----------
        observation, model
            What was measured, and what was believed; needed of a measurement that was read from files.
        """
        field, sky = self._field(observation, model, resources), self.sky
        if sky is None:
            raise InputError("the sky of this measurement is not known: its file is missing")
        options, centre = field.options, field.observation.phase_centre
        meter = Meter(progress)
        meter.expect(field.summary.samples)
        attenuation = (
            options.model.attenuation(centre.dec)
            if options.method.extraction.models_attenuation
            else None
        )
        return residual_image(
            field.observation,
            sky.galaxies(centre),
            options.model.profile,
            summary=field.summary,
            uv_range=field.uv_range,
            gridding=Gridding(
                block=block_of(options.resources.memory), executor=options.resources.executor
            ),
            attenuation=attenuation,
            # Every sample is predicted once and imaged twice.
            step=lambda samples: meter.add(samples / 3),
        )

    def _field(
        self,
        observation: Observation | str | Path | None,
        model: Model | None,
        resources: Resources | None,
    ) -> MeasuredField:
        if observation is None:
            if self.field is None:
                raise InputError(
                    "a measurement that was read from a file needs the observation for an image of it"
                )
            return self.field
        seen = (
            observation if isinstance(observation, Observation) else open_observation(observation)
        )
        options = MeasurementOptions(model=model or Model(), resources=resources or Resources())
        limits = self.record.get("uv_range")
        uv_range = UvRange(*limits) if isinstance(limits, list) else UvRange()
        return MeasuredField(seen, summarise(seen), uv_range, options)


def companions(shapes: Path) -> tuple[Path, Path]:
    """Names of the files of statistics and of the sky that go with a table of shapes."""
    return statistics_path(shapes), shapes.with_name(f"{shapes.stem}.sky.fits")


def check_outputs(shapes: Path, *, overwrite: bool, inputs: tuple[Path, ...] = ()) -> None:
    """Refuse outputs of a measurement that cannot be written, before anything is computed for them."""
    check_table_name(shapes)
    for path in (shapes, *companions(shapes)):
        check_file(path, overwrite=overwrite, inputs=inputs)


def read_measurement(path: str | Path) -> Measurement:
    """Read the table of shapes of a measurement, and the files that lie beside it."""
    target = Path(path)
    shapes = read_shapes(target)
    statistics, sky = companions(target)
    return Measurement(
        shapes=shapes,
        statistics=read_statistics(statistics, target, shapes) if statistics.exists() else None,
        sky=read_catalogue(sky) if sky.exists() else None,
        record=extraction_record(shapes),
    )
