"""JSON files of simulated biases."""

import math
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from uvshear.constants import ARCSEC, MICROJANSKY
from uvshear.errors import InputError
from uvshear.estimators.bias import Bias, BiasSimulation
from uvshear.estimators.shear_estimate import SKY, ShearConditions
from uvshear.io.outputs import write_json
from uvshear.io.population import read_population
from uvshear.io.provenance import Provenance
from uvshear.io.records import finite, read_record, rounded


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
        "selection": "measured" if simulation.cuts_on_measured else "catalogue",
        "flux_min_ujy": rounded(conditions.flux_min / MICROJANSKY),
        "flux_max_ujy": rounded(simulation.flux_max / MICROJANSKY) if is_limited else None,
    }
    return (
        {"estimator": conditions.estimator, **cuts, "cuts": cuts}
        | {"facet": "cell-average" if conditions.averages_cells else "exact"}
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
    record = read_record(path, "a file written by `uvshear bias`")
    frame = record.get("frame")
    sign = 1.0 if frame is not None else -1.0
    rows = record.get("bins")
    bins = tuple(
        _bias(path, row, str(row["flux"]), sign)
        for row in (rows if isinstance(rows, list) else [])
        if isinstance(row, dict) and "flux" in row
    )
    return replace(
        _bias(path, record, "all", sign),
        bins=bins,
        frame=SKY if frame is None else str(frame),
        simulation=_simulation(path, record),
    )


def _bias(path: Path, record: Mapping[str, object], name: str, sign: float) -> Bias:
    """Return m and c of the galaxies of a record; m is NaN if no shear was applied."""

    def pair(quantity: str, suffix: str = "") -> np.ndarray:
        return np.array([_number(path, record, f"{quantity}{i}{suffix}") for i in (1, 2)])

    def optional(quantity: str, suffix: str = "") -> np.ndarray:
        values = (finite(record, f"{quantity}{i}{suffix}") for i in (1, 2))
        return np.array([math.nan if value is None else value for value in values])

    counts = (finite(record, count) for count in ("n", "failed"))
    n, failed = (0 if count is None else int(count) for count in counts)
    return Bias(
        name,
        m=optional("m"),
        m_err=optional("m", "_err"),
        c=pair("c") * [1.0, sign],
        c_err=pair("c", "_err"),
        response=optional("response"),
        n=n,
        failed=failed,
    )


def _simulation(path: Path, record: Mapping[str, object]) -> BiasSimulation:
    assumed = {name: record[name] for name in ("prior", "wraps") if record.get(name) is not None}
    if "population" in record:
        assumed["population"] = read_population(path).record()
    flux_max, seed = finite(record, "flux_max_ujy"), finite(record, "seed")
    shears = record.get("shears")
    return BiasSimulation(
        ShearConditions(
            str(record.get("estimator", "")),
            assumed,
            snr_min=_number(path, record, "snr_min"),
            flux_min=(finite(record, "flux_min_ujy") or 0.0) * MICROJANSKY,
            averages_cells=record.get("facet") == "cell-average",
        ),
        cuts_on_measured=record.get("selection", "measured") == "measured",
        flux_max=math.inf if flux_max is None else flux_max * MICROJANSKY,
        keeps_scale_lengths=bool(record.get("legacy_shear", False)),
        position_sigma=(finite(record, "position_error_arcsec") or 0.0) * ARCSEC,
        shears=tuple(complex(*pair) for pair in shears) if isinstance(shears, list) else (),
        density=finite(record, "density"),
        seed=None if seed is None else int(seed),
    )


def _number(path: Path, record: Mapping[str, object], name: str) -> float:
    if (value := finite(record, name)) is None:
        raise InputError(f"{path}: has no number '{name}'; `uvshear bias` writes one")
    return value
