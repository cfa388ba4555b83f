"""Removal of a simulated bias from a shear, and the check that the two belong together."""

import math
import warnings
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from uvshear.constants import MICROJANSKY
from uvshear.errors import DataWarning, InputError
from uvshear.estimators.bias import Bias, BiasSimulation
from uvshear.estimators.shear_estimate import SKY, ShearConditions, ShearEstimate


def remove_bias(bias: Bias, estimate: ShearEstimate) -> ShearEstimate:
    """Return the shear without the bias, and those of the bins of flux without the biases of their bins.

    Errors of the shear, of c and of m are added in quadrature. Bins that were not simulated are left out.
    """
    by_flux = bias.by_flux
    bins = {
        name: _without(by_flux[name], part)
        for name, part in estimate.bins.items()
        if name in by_flux
    }
    return replace(_without(bias, estimate), bins=bins)


def _without(bias: Bias, estimate: ShearEstimate) -> ShearEstimate:
    g = (np.array([estimate.g1, estimate.g2]) - bias.c) / (1 + bias.m)
    error = np.array([estimate.g1_err, estimate.g2_err])
    error = np.sqrt(error**2 + bias.c_err**2 + (g * bias.m_err) ** 2) / (1 + bias.m)
    (g1, g2), (g1_err, g2_err) = g.tolist(), error.tolist()
    return replace(estimate, g1=g1, g1_err=g1_err, g2=g2, g2_err=g2_err)


def check_removable(bias: Bias, own: ShearConditions, name: str = "the bias") -> None:
    """Refuse a bias that does not belong to a shear; warn where a cut is only nearly the same.

    Parameters
    ----------
    own
        Conditions of the shear.
    name
        Name of the bias in messages: that of its file.

    Raises
    ------
    InputError
        The bias has no m or c, or was simulated under conditions that are not those of the shear.
    """
    if bias.frame != SKY:
        raise InputError(f"{name}: is in the frame '{bias.frame}'; the frame '{SKY}' is needed")
    for part in (bias, *bias.bins):
        if not np.isfinite([part.m, part.m_err, part.c, part.c_err]).all():
            raise InputError(
                f"{name}: lacks m, c or their errors; simulate the bias again with a shear above 0"
            )
        if part.m.min() <= -1:
            raise InputError(
                f"{name}: m is -1 or less, so that the estimator does not respond to a shear or has the wrong sign;"
                " such a bias cannot be removed"
            )
    simulation = bias.simulation
    if simulation is None:
        raise InputError(
            f"{name}: has no record of its simulation; use a Bias from estimate_bias or read_bias"
        )
    _refuse_what_is_not_measured(simulation, name)
    _refuse_other_conditions(simulation.conditions, own, name)
    if own.snr_min > 0 and not simulation.cuts_on_measured:
        warnings.warn(
            f"{name}: the simulated galaxies were selected by the signal-to-noise ratio of their catalogue flux,"
            " but the measured ones by their fitted signal-to-noise ratio, which shear and noise change; simulate"
            " with `--selection measured`, or cut the measured galaxies by flux (`--flux-min-ujy`), which does not"
            " bias the shear",
            DataWarning,
            stacklevel=3,
        )


def _refuse_what_is_not_measured(simulation: BiasSimulation, name: str) -> None:
    """Refuse what a simulation can have and measured shapes have not."""
    if math.isfinite(simulation.flux_max):
        raise InputError(
            f"{name}: was simulated with an upper limit of the flux, {simulation.flux_max / MICROJANSKY:g} uJy,"
            " but `uvshear shear` has no such cut; simulate without `--flux-max-ujy`"
        )
    if simulation.keeps_scale_lengths:
        raise InputError(
            f"{name}: was simulated with `--legacy-shear`, which is not the effect of a lens, so that it does not"
            " apply to measured shapes"
        )
    if simulation.position_sigma > 0:
        raise InputError(
            f"{name}: was simulated with `--position-error-arcsec`, but the statistics of `measure --keep` are not"
            " corrected for position errors"
        )


def _refuse_other_conditions(simulated: ShearConditions, own: ShearConditions, name: str) -> None:
    same = {
        "estimator": (simulated.estimator, own.estimator),
        "snr_min": (f"{simulated.snr_min:g}", f"{own.snr_min:g}"),
        "flux_min_ujy": tuple(f"{each.flux_min / MICROJANSKY:g}" for each in (simulated, own)),
        "prior": (simulated.prior, own.prior),
        "wraps": (simulated.wraps, own.wraps),
    }
    for option, (its, ours) in same.items():
        if its != ours:
            raise InputError(
                f"{name}: was simulated with {option} = {its}, but the shear is estimated with {option} = {ours}; give"
                " both the same setting"
            )
    if simulated.averages_cells is not own.averages_cells:
        raise InputError(
            f"{name}: was simulated with facet = {_facet(simulated)}, but the shapes were measured with"
            f" facet = {_facet(own)}; simulate the bias with the same facets"
        )
    if own.prior == "file":
        _refuse_another_population(simulated.assumed, own.assumed, name)


def _facet(conditions: ShearConditions) -> str:
    return "cell-average" if conditions.averages_cells else "exact"


def _refuse_another_population(
    simulated: Mapping[str, object], own: Mapping[str, object], name: str
) -> None:
    its, ours = simulated.get("population"), own.get("population")
    if not isinstance(its, Mapping) or not isinstance(ours, Mapping):
        raise InputError(f"{name}: has no population, but the shear is estimated with one")
    for part, values in ours.items():
        for parameter, value in values.items():
            if not math.isclose(its[part][parameter], value, rel_tol=1e-9):
                raise InputError(
                    f"{name}: its population has {part} {parameter} = {its[part][parameter]:g}, but the population"
                    f" assumed for the shear has {value:g}"
                )
