"""Whether a bias is that of the shear which it is to be taken out of."""
# ruff: noqa: PLC0415  (help must not wait for imports)

import math
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from uvshear.cli.names import FacetName
from uvshear.cli.priors import FILE, Prior
from uvshear.cli.terminal import warn
from uvshear.errors import InputError

if TYPE_CHECKING:
    from uvshear.estimators.correction import Calibration


@dataclass(frozen=True)
class ShearRun:
    """What a shear is estimated with; ``averages_cells`` is of the facets of its shapes."""

    estimator: str
    snr_min: float
    flux_min_ujy: float
    prior: Prior
    averages_cells: bool


def refuse_another(path: Path, bias: "Calibration", own: ShearRun) -> None:
    """Refuse the bias (of ``path``) of something else; tell of a cut that is only nearly the same."""
    from uvshear.constants import MICROJANSKY

    facets = {True: FacetName.CELL_AVERAGE.value, False: FacetName.EXACT.value}
    same = {
        "the estimator": (bias.estimator, own.estimator),
        "--snr-min": (f"{bias.snr_min:g}", f"{own.snr_min:g}"),
        "--flux-min-ujy": (f"{bias.flux_min / MICROJANSKY:g}", f"{own.flux_min_ujy:g}"),
        "--prior": (bias.prior, own.prior.source),
        "--facet": (facets[bias.averages_cells], facets[own.averages_cells]),
    }
    for name, (its, ours) in same.items():
        if its != ours:
            raise InputError(f"{path}: is of {name} {its}, the shear of {ours}")
    if own.prior.source == FILE:
        _refuse_another_population(path, own.prior)
    if own.snr_min > 0 and not bias.cuts_on_measured:
        warn(
            f"{path}: its galaxies were cut by their catalogue's flux, these by a measured SNR, which shear and noise"
            " move galaxies across; `uvshear bias --selection measured` is of that, --flux-min-ujy leaves m alone"
        )


def _refuse_another_population(path: Path, prior: Prior) -> None:
    from uvshear.io.population import population_record, read_population

    its, ours = population_record(read_population(path)), population_record(prior.population)
    for part, values in ours.items():
        for name, value in values.items():
            if not math.isclose(its[part][name], value, rel_tol=1e-9):
                raise InputError(
                    f"{path}: is of a population with {part} {name} {its[part][name]:g}, the shear of {value:g}"
                )
