"""Check that a simulated bias belongs to the shear from which it is to be removed."""
# ruff: noqa: PLC0415  (help must not wait for imports)

import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from uvshear.cli.terminal import warn
from uvshear.errors import InputError

if TYPE_CHECKING:
    from uvshear.estimators.bias_correction import BiasCorrection


@dataclass(frozen=True)
class ShearRun:
    """The options with which a shear is estimated, and whether the facets of its shapes average in cells."""

    estimator: str
    snr_min: float
    flux_min_ujy: float
    assumed: Mapping[str, object]
    averages_cells: bool

    @property
    def prior(self) -> str:
        """Origin of the population that the estimator assumes; ``paper`` where it assumes none."""
        return str(self.assumed.get("prior", "paper"))


def refuse_another(path: Path, bias: "BiasCorrection", own: ShearRun) -> None:
    """Refuse a bias that was simulated with other options; warn where a cut is only nearly the same."""
    from uvshear.constants import MICROJANSKY

    facets = {True: "cell-average", False: "exact"}
    same = {
        "--estimator": (bias.estimator, own.estimator),
        "--snr-min": (f"{bias.snr_min:g}", f"{own.snr_min:g}"),
        "--flux-min-ujy": (f"{bias.flux_min / MICROJANSKY:g}", f"{own.flux_min_ujy:g}"),
        "--prior": (bias.prior, own.prior),
        "--facet": (facets[bias.averages_cells], facets[own.averages_cells]),
    }
    for name, (its, ours) in same.items():
        if its != ours:
            raise InputError(
                f"{path}: was simulated with {name} {its}, but the shear is estimated with {name} {ours}"
            )
    if own.prior == "file":
        _refuse_another_population(path, own.assumed)
    if own.snr_min > 0 and not bias.cuts_on_measured:
        warn(
            f"{path}: the simulated galaxies were selected by catalogue flux, these by a measured signal-to-noise"
            " ratio, and shear and noise move galaxies across such a cut; simulate with --selection measured, or cut"
            " with --flux-min-ujy, which leaves m alone"
        )


def _refuse_another_population(path: Path, assumed: Mapping[str, object]) -> None:
    from uvshear.io.population import read_population

    its, ours = read_population(path).record(), assumed["population"]
    assert isinstance(ours, Mapping)
    for part, values in ours.items():
        for name, value in values.items():
            if not math.isclose(its[part][name], value, rel_tol=1e-9):
                raise InputError(
                    f"{path}: its population has {part} {name} = {its[part][name]:g}, but the population"
                    f" assumed for the shear has {value:g}"
                )
