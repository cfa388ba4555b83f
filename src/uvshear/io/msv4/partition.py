"""One group of visibilities of an MSv4 store: what must be known before its visibilities are read."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np

from uvshear.errors import InputError
from uvshear.io.msv4.antennas import baseline_names
from uvshear.io.msv4.data_groups import CORRELATED_DIMENSIONS, DataGroup, choose_data_group
from uvshear.io.msv4.fields import read_field_names
from uvshear.io.msv4.opening import Dataset, open_group, zarr_errors
from uvshear.io.msv4.spectral_setup import SpectralSetup, read_setup
from uvshear.io.msv4.timeline import Timeline, read_timeline
from uvshear.io.msv4.variables import check_dimensions, quantity
from uvshear.typing import Array, Int

SCHEMA: Final = "4"
"""Major version of the schema that can be read."""

PROBES: Final = 16
"""Number of times, spread over a partition, by which a variable is judged."""

WEIGHT_OF_SIGMA: Final = "SIGMA_SPECTRUM"
"""Variable of sigma, which xarray-ms writes beside the weights; it stands in for weights that are not filled."""

EXPOSURE: Final = "EFFECTIVE_INTEGRATION_TIME"
"""Variable of the times that visibilities were averaged over [s]."""

INTERVAL: Final = "INTEGRATION_TIME"
"""Variable of the nominal times, which xarray-ms writes where they differ."""


@dataclass(frozen=True)
class AveragingTimes:
    """What is known of the times that the visibilities of a partition were averaged over.

    Parameters
    ----------
    has_exposure
        Whether there is a variable EFFECTIVE_INTEGRATION_TIME.
    is_exposed
        Whether it has values above 0.
    is_nominal
        Whether the nominal length of the integrations is above 0, by integration_time or INTEGRATION_TIME.
    """

    has_exposure: bool
    is_exposed: bool
    is_nominal: bool


@dataclass(frozen=True)
class Partition:
    """A group of visibilities.

    Parameters
    ----------
    group
        Path of the group.
    variables
        Variables that are read.
    setup
        Channels and correlations.
    timeline
        Times with their fields and scans.
    baselines
        Names of the first and of the second antenna of each baseline.
    times
        What is known of the times that the visibilities were averaged over.
    """

    group: Path
    variables: DataGroup
    setup: SpectralSetup
    timeline: Timeline
    baselines: tuple[tuple[str, ...], tuple[str, ...]]
    times: AveragingTimes

    @property
    def fields_group(self) -> Path:
        """Path of the subgroup of fields."""
        return self.group / self.variables.field_and_source

    @property
    def averaging_notice(self) -> str | None:
        """What a user should know about the averaging times of the partition."""
        if not self.setup.is_averaged or self.times.is_exposed:
            return None
        if not self.times.is_nominal:
            return (
                f"the channels are averages, but neither {EXPOSURE} nor integration_time is above 0; smearing in time"
                " is not in the model"
            )
        if not self.times.has_exposure:
            return None
        return (
            f"{EXPOSURE} is 0 although the channels are averages; visibilities are taken to be averages over"
            " integration_time"
        )


def read_partition(group: Path, column: str) -> Partition:
    """Read the description of a partition, and check it; an error is one line."""
    with open_group(group) as partition:
        _check_version(group, partition)
        variables = choose_data_group(group, partition, column)
        _check_variables(group, partition, variables)
        times = _averaging_times(group, partition)
        # Stores always give the widths of channels, but seldom the bands that these were averaged over.
        is_sampled = times.has_exposure and not times.is_exposed and _is_simulated(partition.attrs)
        setup = read_setup(group, partition, is_sampled=is_sampled)
        named = read_field_names(group / variables.field_and_source)
        timeline = read_timeline(group, partition, named)
        return Partition(group, variables, setup, timeline, baseline_names(group, partition), times)


def filled_weights(partition: Partition, steps: Sequence[int]) -> str:
    """Return the variable of weights, or of sigma, that has values above 0 at some times; empty if none has."""
    with open_group(partition.group) as group:
        for name in (partition.variables.weights, WEIGHT_OF_SIGMA):
            if name in group.variables and _is_positive(partition.group, group, name, steps):
                return name
    return ""


def probed(steps: Int[Array, " step"]) -> list[int]:
    """Return a few of these times, which are spread over all of them."""
    if not len(steps):
        return []
    chosen = np.unique(np.linspace(0, len(steps) - 1, PROBES).astype(int))
    return [int(step) for step in steps[chosen]]


def _check_version(place: Path, partition: Dataset) -> None:
    version = str(partition.attrs.get("schema_version", SCHEMA))
    if version.partition(".")[0] != SCHEMA:
        raise InputError(
            f"{place}: has version {version} of the schema; version {SCHEMA} (MSv4) is needed"
        )


def _check_variables(place: Path, partition: Dataset, variables: DataGroup) -> None:
    for name, dimensions in (
        (variables.weights, CORRELATED_DIMENSIONS),
        (variables.flags, CORRELATED_DIMENSIONS),
        (EXPOSURE, CORRELATED_DIMENSIONS),
        (INTERVAL, CORRELATED_DIMENSIONS),
        (WEIGHT_OF_SIGMA, CORRELATED_DIMENSIONS),
    ):
        if name in partition.variables:
            check_dimensions(place, name, partition[name].dims, dimensions, all_of=False)
            if partition[name].dtype.kind not in "biuf":
                raise InputError(
                    f"{place}: {name} holds {partition[name].dtype}; numbers are needed"
                )
    uvw = variables.uvw
    if uvw not in partition.variables:
        raise InputError(f"{place}: has no variable {uvw}; the baselines are needed")
    check_dimensions(place, uvw, partition[uvw].dims, ("time", "baseline_id", "uvw_label"))
    if partition.sizes["uvw_label"] != 3 or partition[uvw].dtype.kind not in "iuf":
        raise InputError(
            f"{place}: {uvw} has {partition.sizes['uvw_label']} coordinates of the type {partition[uvw].dtype};"
            " three numbers are needed"
        )
    if partition.sizes["frequency"] == 0 or partition.sizes["polarization"] == 0:
        raise InputError(f"{place}: has no channels or no correlations; visibilities are needed")


def _averaging_times(place: Path, partition: Dataset) -> AveragingTimes:
    steps = probed(np.arange(partition.sizes["time"]))

    def is_filled(name: str) -> bool:
        return name in partition.variables and _is_positive(place, partition, name, steps)

    given = quantity(partition["time"].attrs, "integration_time") if "time" in partition else None
    is_nominal = (given is not None and bool((given > 0).all())) or is_filled(INTERVAL)
    return AveragingTimes(EXPOSURE in partition.variables, is_filled(EXPOSURE), is_nominal)


def _is_positive(place: Path, partition: Dataset, name: str, steps: Sequence[int]) -> bool:
    found = partition[name]
    for step in steps if "time" in found.dims else steps[:1]:
        taken = found.isel(time=step) if "time" in found.dims else found
        with zarr_errors(place, name), np.errstate(invalid="ignore"):
            if bool(np.any(taken.values > 0)):
                return True
    return False


def _is_simulated(attributes: Any) -> bool:
    """Whether the visibilities come from a simulator, by the PROCESSOR of the Measurement Set."""
    processor = attributes.get("processor_info")
    words = processor.values() if isinstance(processor, dict) else ()
    return "SIMULATOR" in {str(word).upper() for word in words}
