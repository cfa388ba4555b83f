"""``uvshear info``: a summary of visibilities."""
# ruff: noqa: PLC0415  (help must not wait for imports)

import math
import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from uvshear.cli.panels import GroupedCommand
from uvshear.cli.reading import (
    ColumnOption,
    ConjugateOption,
    FieldOption,
    ScansOption,
    SubtractOption,
    reading_of,
)
from uvshear.cli.terminal import show_facts, warn

if TYPE_CHECKING:
    from uvshear.io.inspection import FieldContent, Inspection

EPILOG = "Example: uvshear info FIELD.ms"

Fact = tuple[str, str]

FIRST_DATE, LAST_DATE = 15020 * 86400.0, 124593 * 86400.0
"""Beginnings of the years 1900 and 2200 [MJD s]; times outside this range cannot be those of observations."""

SHORT = "Summarise a Measurement Set or an MSv4 store."


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command("info", epilog=EPILOG, short_help=SHORT, cls=GroupedCommand)(info)


def info(
    measurement_sets: Annotated[
        list[Path],
        typer.Argument(
            metavar="FIELD.ms...", help="Measurement Sets, or MSv4 stores (zarr), to summarise."
        ),
    ],
    column: ColumnOption = "DATA",
    subtract: SubtractOption = None,
    field: FieldOption = None,
    scans: ScansOption = None,
    conjugate: ConjugateOption = False,
) -> None:
    """Summarise a Measurement Set or an MSv4 store.

    The summary lists the array, fields, frequencies, flags and baselines, and says whether the weights match the
    noise, as far as this can be judged without a catalogue. With --field it covers only that field.
    """
    from uvshear.io.observations import inspect

    reading = reading_of(column, field, scans, conjugates=conjugate, subtracted=subtract)
    for path in measurement_sets:
        seen = inspect(path, reading)
        show_facts(str(path), _facts_of_set(seen))
        for content in seen.fields:
            number = "" if content.number is None else f" {content.number}"
            show_facts(f"field{number} {content.name}".rstrip(), _facts_of_field(content, seen))
            for text in content.warnings:
                warn(text)


def _facts_of_set(seen: "Inspection") -> list[Fact]:
    facts = []
    if (telescope := seen.telescope) is not None:
        dishes = ", ".join(f"{diameter:g}" for diameter in telescope.diameters)
        facts += [
            ("telescope", telescope.name or "not named"),
            ("antennas", str(telescope.antennas) + (f", dishes of {dishes} m" if dishes else "")),
        ]
    if seen.columns:
        facts.append(("columns of visibilities", ", ".join(seen.columns)))
    for k, window in enumerate(seen.windows):
        low = (window.frequency - window.width / 2).min() / 1e6
        high = (window.frequency + window.width / 2).max() / 1e6
        width = ", ".join(f"{hertz / 1e3:.6g}" for hertz in sorted(set(window.width.tolist()))[:3])
        content = f"{low:.6g} - {high:.6g} MHz, {len(window.frequency)} channels of {width} kHz"
        facts.append((f"spectral window {k}", f"{content}; {' '.join(window.correlations)}"))
    return facts


def _facts_of_field(content: "FieldContent", seen: "Inspection") -> list[Fact]:
    from astropy.coordinates import SkyCoord

    counts, centre, ranges = content.counts, content.phase_centre, content.ranges
    direction = SkyCoord(centre.ra, centre.dec, unit="rad")
    facts = [
        ("phase centre", direction.to_string("hmsdms", precision=2)),
        (
            "rows",
            f"{counts.rows} cross-correlations, {counts.autocorrelations} autocorrelations",
        ),
        ("visibilities (Stokes I)", f"{counts.samples}, {counts.usable} usable"),
        ("flagged", f"{100 * counts.flagged_fraction:.2f} %"),
        ("weights", content.weight_column or "from the reader"),
    ]
    if not counts.rows:
        return facts
    shortest, longest = ranges.interval
    interval = f"{shortest:.4g}" + (f" to {longest:.4g}" if longest > shortest else "")
    widest = max((float(window.averaged.max()) for window in seen.windows), default=0.0)
    over_time = f"{interval} s" if longest > 0 else "none in time"
    over_channel = f"{widest / 1e3:.6g} kHz" if widest > 0 else "none in frequency"
    facts += [
        ("time", " to ".join(map(_date, ranges.time)) + " UTC"),
        (
            "averaging",
            "over cells of (u, v, w)" if content.has_averages else f"{over_time}, {over_channel}",
        ),
    ]
    if counts.usable:
        (near, far), (low, high) = ranges.baseline, ranges.uv_distance
        facts += [
            ("projected baselines", f"{near:.4g} to {far:.6g} m"),
            ("uv distance", f"{low:.4g} to {high:.6g} wavelengths"),
        ]
    sense = {
        True: "yes",
        False: "no, the opposite sign, which is usual for some telescopes (LOFAR, WSRT)",
        None: "neither sign fits",
    }[content.uvw_agrees]
    facts.append(("noise / noise implied by the weights", _noise(content)))
    if content.has_averages:
        return facts
    return [
        *facts,
        ("UVW is X(ANTENNA1) - X(ANTENNA2)", sense),
    ]


def _date(time: float) -> str:
    """Return a time [MJD s] as a date, or as a Modified Julian Date if it cannot be that of an observation."""
    from astropy.time import Time

    if not FIRST_DATE < time < LAST_DATE:
        return f"MJD {time / 86400:g}" if math.isfinite(time) else "an unknown time"
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # astropy does not know the leap seconds of the future
        return str(Time(time / 86400, format="mjd").isot[:19])


def _noise(content: "FieldContent") -> str:
    noise = content.noise
    if noise is None:
        return "not known"
    if noise.is_certain:
        return f"{noise.ratio:.3g}, from {noise.smallest.origin}"
    return f"at most {noise.ratio:.3g}, from {noise.smallest.origin}, in which there is sky as well"
