"""``uvshear info``: what is in a Measurement Set."""
# ruff: noqa: PLC0415  (help must not wait for imports)

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

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


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command("info", epilog=EPILOG)(info)


def info(
    measurement_sets: Annotated[
        list[Path], typer.Argument(metavar="FIELD.ms...", help="Sets to look at.")
    ],
    column: ColumnOption = "DATA",
    subtract: SubtractOption = None,
    field: FieldOption = None,
    scans: ScansOption = None,
    conjugate: ConjugateOption = False,
) -> None:
    """Print what a Measurement Set holds: array, fields, frequencies, flags, uv range, noise against the weights."""
    from uvshear.io.data_warnings import remarks_on
    from uvshear.io.inspection import inspect

    reading = reading_of(column, field, scans, conjugates=conjugate, subtracted=subtract)
    for path in measurement_sets:
        seen = inspect(path, reading)
        show_facts(str(path), _facts_of_set(seen))
        for one in seen.fields:
            title = f"field {one.data.header.field_id} {one.name}"
            show_facts(title, _facts_of_field(one))
            for remark in remarks_on(one):
                warn(remark)


def _facts_of_set(seen: "Inspection") -> list[Fact]:
    telescope = seen.telescope
    dishes = ", ".join(f"{one:g}" for one in telescope.diameters)
    facts = [
        ("telescope", telescope.name or "not said"),
        ("antennas", str(telescope.antennas) + (f", dishes of {dishes} m" if dishes else "")),
        ("columns of visibilities", ", ".join(seen.columns)),
    ]
    windows = seen.fields[0].data.spectral_windows
    for k, (window, correlations) in enumerate(zip(windows, seen.correlations, strict=True)):
        low = (window.frequency - window.width / 2).min() / 1e6
        high = (window.frequency + window.width / 2).max() / 1e6
        width = ", ".join(f"{one / 1e3:.6g}" for one in sorted(set(window.width.tolist()))[:3])
        content = f"{low:.6g} - {high:.6g} MHz, {len(window)} channels of {width} kHz"
        facts.append((f"window {k}", f"{content}; {' '.join(correlations)}"))
    return facts


def _facts_of_field(one: "FieldContent") -> list[Fact]:
    from astropy.coordinates import SkyCoord
    from astropy.time import Time

    counts, centre = one.counts, one.data.phase_centre
    direction = SkyCoord(centre.ra, centre.dec, unit="rad")
    facts = [
        ("phase centre", direction.to_string("hmsdms", precision=2)),
        ("rows", f"{counts.rows} and {counts.autocorrelations} autocorrelations"),
        ("visibilities (Stokes I)", f"{counts.samples}, {counts.usable} usable"),
        ("flagged", f"{100 * counts.flagged_fraction:.2f} %"),
        ("weights", one.data.header.weight_column),
    ]
    if not counts.rows:
        return facts
    start, end = (Time(day / 86400, format="mjd") for day in one.time)
    shortest, longest = one.interval
    interval = f"{shortest:.4g}" + (f" to {longest:.4g}" if longest > shortest else "")
    widest = max(float(part.averaged.max()) for part in one.data.header.descriptions)
    over_time = f"{interval} s" if longest > 0 else "no time"
    over_channel = f"{widest / 1e3:.6g} kHz" if widest > 0 else "no band"
    averaged = f"{over_time}, {over_channel}"
    facts += [
        ("time", f"{start.isot[:19]} to {end.isot[:19]} UTC"),
        ("averaged over", averaged),
    ]
    if counts.usable:
        (near, far), (low, high) = one.baseline, one.uv_distance
        facts += [
            ("projected baselines", f"{near:.4g} to {far:.6g} m"),
            ("uv distance", f"{low:.4g} to {high:.6g} wavelengths"),
        ]
    ratio = one.noise_over_weights
    sense = {True: "yes", False: "the opposite", None: "neither"}[one.uvw_agrees]
    return [
        *facts,
        ("noise over weights' noise", "not known" if ratio is None else f"{ratio:.3g}"),
        ("UVW is X(ANTENNA1) - X(ANTENNA2)", sense),
    ]
