"""JSON files of simulated biases."""

import math
from dataclasses import replace
from pathlib import Path
from typing import Final

import numpy as np

from uvshear.constants import ARCSEC, MICROJANSKY
from uvshear.errors import InputError
from uvshear.estimators.bias import Bias, BiasSimulation
from uvshear.estimators.shear_estimate import SKY, ShearConditions
from uvshear.io.outputs import write_json
from uvshear.io.population import read_population
from uvshear.io.provenance import Provenance
from uvshear.io.records import CheckedRecord, finite, read_record, rounded

WRITER: Final = "uvshear bias"

FRAMELESS: Final = "0.1.0"
"""Version whose files do not name a frame."""

LARGEST: Final = 1e3
"""Largest modulus of m, of c and of their errors that is read. Larger ones are no bias of an estimator, and the removal
of one would lose a shear below the rounding errors."""

EXACT, AVERAGED, MEASURED = "exact", "cell-average", "measured"
"""Kinds of facets, and the selection by the fitted signal-to-noise ratio."""


def write_bias(
    path: str | Path, bias: Bias, provenance: Provenance | None = None, *, overwrite: bool = False
) -> None:
    """Write a bias, with the simulation that gave it, to a JSON file that ``estimate_shear`` and `uvshear shear` read.

    Raises
    ------
    InputError
        The file exists and is not to be overwritten, or cannot be written.
    """
    made = provenance or Provenance("uvshear.estimate_bias")
    simulation = bias.simulation
    # The assumptions come last: an option may be a file, whose content they are.
    record: dict[str, object] = dict(bias.record())
    if simulation is not None:
        record |= _simulation_record(simulation)
    record |= dict(made.options)
    if simulation is not None:
        record |= dict(simulation.conditions.assumed)
    record |= made.record()
    record |= {
        "frame": bias.frame,
        "bins": [{"flux": part.name, **part.record()} for part in bias.bins],
    }
    write_json(Path(path), record, overwrite=overwrite)


def _simulation_record(simulation: BiasSimulation) -> dict[str, object]:
    """Return the simulation by the names of the command line's options, in its units."""
    conditions = simulation.conditions
    is_limited = math.isfinite(simulation.flux_max)
    cuts = {
        "snr_min": conditions.snr_min,
        "selection": MEASURED if simulation.cuts_on_measured else "catalogue",
        "flux_min_ujy": rounded(conditions.flux_min / MICROJANSKY),
        "flux_max_ujy": rounded(simulation.flux_max / MICROJANSKY) if is_limited else None,
    }
    return (
        {"estimator": conditions.estimator, **cuts, "cuts": cuts}
        | {"facet": AVERAGED if conditions.averages_cells else EXACT}
        | {"legacy_shear": simulation.keeps_scale_lengths}
        | {"position_error_arcsec": rounded(simulation.position_sigma / ARCSEC)}
        | {"density": simulation.density, "seed": simulation.seed}
        | {"shears": [[shear.real, shear.imag] for shear in simulation.shears]}
    )


def read_bias(path: str | Path) -> Bias:
    """Read a bias, in total and by flux, with the simulation that gave it.

    Files of version 0.1.0 do not name a frame. They are in the (l, m) frame, so the sign of c2 is reversed.

    Raises
    ------
    InputError
        The file does not exist, or is damaged.
    """
    path = Path(path)
    values = read_record(path, "a file written by `uvshear bias`")
    record = CheckedRecord(str(path), values, WRITER)
    _refuse_contradictions(record)
    frame = record.word("frame", "")
    if not frame and record.word("version", FRAMELESS) != FRAMELESS:
        raise InputError(f"{path}: has no word 'frame'; `{WRITER}` writes one")
    sign = 1.0 if frame else -1.0
    bins = tuple(_bin(record, row, sign) for row in record.entries("bins"))
    if len({part.name for part in bins}) < len(bins):
        raise InputError(f"{path}: has two bins of the same flux; `{WRITER}` writes one")
    return replace(
        _bias(record, "all", sign),
        bins=bins,
        frame=frame or SKY,
        simulation=_simulation(path, record),
    )


def _refuse_contradictions(record: CheckedRecord) -> None:
    """Refuse a file that has two values of a cut: the cuts are written twice."""
    cuts = record.values.get("cuts") or {}
    if not isinstance(cuts, dict):
        raise InputError(f"{record.name}: 'cuts' is no object with names and values")
    for name, value in cuts.items():
        if record.values.get(name) != value:
            raise InputError(
                f"{record.name}: '{name}' is {record.values.get(name)}, but {value} in 'cuts'; the file has been"
                " changed, simulate the bias again"
            )


def _bin(record: CheckedRecord, row: object, sign: float) -> Bias:
    if not isinstance(row, dict) or not isinstance(row.get("flux"), str):
        raise InputError(f"{record.name}: an entry of 'bins' has no word 'flux'")
    part = CheckedRecord(f"{record.name}: bin {row['flux']}", row, WRITER)
    return _bias(part, row["flux"], sign)


def _bias(record: CheckedRecord, name: str, sign: float) -> Bias:
    """Return m and c of the galaxies of a record; m is NaN if no shear was applied."""

    def pair(quantity: str) -> np.ndarray:
        return np.array([record.number(f"{quantity}{i}", -LARGEST, LARGEST) for i in (1, 2)])

    def optional(quantity: str, suffix: str = "") -> np.ndarray:
        least = 0 if suffix else -LARGEST
        names = (f"{quantity}{i}{suffix}" for i in (1, 2))
        found = (record.number_or_none(name, least, LARGEST) for name in names)
        return np.array([math.nan if value is None else value for value in found])

    return Bias(
        name,
        m=optional("m"),
        m_err=optional("m", "_err"),
        c=pair("c") * [1.0, sign],
        c_err=np.array([record.number(f"c{i}_err", 0, LARGEST) for i in (1, 2)]),
        response=np.array(
            [record.number_or_none(f"response{i}") or math.nan for i in (1, 2)], float
        ),
        n=record.count_or_none("n") or 0,
        failed=record.count_or_none("failed") or 0,
    )


def _simulation(path: Path, record: CheckedRecord) -> BiasSimulation:
    values = record.values
    assumed: dict[str, object] = {
        name: record.word(name, "") for name in ("prior", "wraps") if values.get(name) is not None
    }
    if "population" in values:
        assumed["population"] = read_population(path).record()
    flux_max = record.number_or_none("flux_max_ujy", 0)
    return BiasSimulation(
        ShearConditions(
            record.word("estimator", ""),
            assumed,
            snr_min=record.number("snr_min", 0),
            flux_min=(record.number_or_none("flux_min_ujy", 0) or 0.0) * MICROJANSKY,
            averages_cells=record.word("facet", EXACT, (EXACT, AVERAGED)) == AVERAGED,
        ),
        cuts_on_measured=record.word("selection", MEASURED, (MEASURED, "catalogue")) == MEASURED,
        flux_max=math.inf if flux_max is None else flux_max * MICROJANSKY,
        keeps_scale_lengths=record.truth("legacy_shear"),
        position_sigma=(record.number_or_none("position_error_arcsec", 0) or 0.0) * ARCSEC,
        shears=tuple(_shear(record, pair) for pair in record.entries("shears")),
        density=record.number_or_none("density", 0),
        seed=record.count_or_none("seed"),
    )


def _shear(record: CheckedRecord, pair: object) -> complex:
    """Return a shear that was applied."""
    if isinstance(pair, list) and len(pair) == 2:
        first, second = (finite({"g": part}, "g") for part in pair)
        if first is not None and second is not None and math.hypot(first, second) < 1:
            return complex(first, second)
    raise InputError(
        f"{record.name}: an entry of 'shears' is no pair of numbers g1, g2 with |g| < 1"
    )
