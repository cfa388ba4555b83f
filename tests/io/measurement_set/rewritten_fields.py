"""A small field as a Measurement Set that other programs write anew, and what is read from the result."""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from astropy.table import Table

import uvshear
from tests.skies import galaxies
from uvshear.constants import ARCMIN, ARCSEC
from uvshear.galaxy import Exponential
from uvshear.geometry.directions import PhaseCentre
from uvshear.interferometer.coverage import Track, synthesise
from uvshear.interferometer.layout import ArrayLayout, load_layout
from uvshear.interferometer.noise import ScaledNoise
from uvshear.interferometer.spectral_window import Channels
from uvshear.io.catalogue import catalogue_from_galaxies
from uvshear.io.measurement_set.writer import write_measurement_set
from uvshear.io.observations import open_observation
from uvshear.simulation.observation import SimulatedObservation

CENTRE = PhaseCentre(0.3, float(np.radians(40.0)))
SIGMA = 1e-3
"""Noise of a visibility [Jy]."""

SKY = galaxies(
    np.array([0.7, -1.5, 0.3, 3.0]) * ARCMIN,
    np.array([0.5, 1.0, -2.0, -3.0]) * ARCMIN,
    SIGMA * np.array([20.0, 12.0, 8.0, 40.0]),
    np.array([1.5, 1.0, 2.0, 0.0]) * ARCSEC,
    np.array([0.3, -0.2j, 0.1 + 0.2j, 0.0]),
)
"""Three discs, and a point that is twice as bright."""

CATALOGUE = catalogue_from_galaxies(SKY, CENTRE)
LOW, HIGH = (1.30e9, 1.34e9, 8), (1.40e9, 1.44e9, 4)
"""Bands: their ends [Hz] and numbers of channels."""


def array() -> ArrayLayout:
    """Return sixteen antennas of the VLA (A)."""
    layout = load_layout("vla-a")
    chosen = np.sort(np.random.default_rng(3).permutation(len(layout))[:16])
    return replace(
        layout,
        antenna_names=tuple(layout.antenna_names[k] for k in chosen),
        positions=layout.positions[chosen],
        diameters=layout.diameters[chosen],
    )


def write_field(path: Path, hours: tuple[float, float], band=LOW, seed: int = 1) -> Path:
    """Write integrations of 60 s between two hour angles."""
    return _write(path, (tuple(3600.0 * hour for hour in hours),), 60.0, band, seed)


def write_snapshots(path: Path) -> Path:
    """Write 40 integrations of 1 s within eight hours, in channels of 10 kHz, which smear nothing in the field."""
    spans = tuple((720.0 * k, 720.0 * k + 1) for k in range(-20, 20))
    return _write(path, spans, 1.0, (1.30e9, 1.30e9 + 8e4, 8), 1)


def _write(path: Path, spans, integration: float, band, seed: int) -> Path:
    observation = SimulatedObservation(
        coverage=synthesise(array(), Track.from_clock(CENTRE, spans, integration)),
        channels=Channels.from_band(*band),
        galaxies=SKY,
        profile=Exponential(),
        noise=ScaledNoise(SIGMA),
        seed=seed,
        is_averaged=True,
    )
    write_measurement_set(path, observation)
    return path


@dataclass(frozen=True)
class Samples:
    """All visibilities with weight, in order of time, frequency and baseline.

    Parameters
    ----------
    time
        Of the middle of the integration [s].
    frequency
        Of the channel [Hz].
    uvw
        Baseline [m].
    stokes_i
        Visibility [Jy].
    weights
        1/sigma^2 [Jy^-2].
    interval
        Time that was averaged over [s].
    width
        Band that was averaged over [Hz].
    antennas
        Numbers of the two antennas.
    """

    time: np.ndarray
    frequency: np.ndarray
    uvw: np.ndarray
    stokes_i: np.ndarray
    weights: np.ndarray
    interval: np.ndarray
    width: np.ndarray
    antennas: np.ndarray

    def __len__(self) -> int:
        return len(self.time)

    def select(self, which) -> "Samples":
        return Samples(**{name: values[which] for name, values in vars(self).items()})


def samples_of(*paths: Path) -> Samples:
    """Read Measurement Sets."""
    parts: dict[str, list] = {name: [] for name in Samples.__annotations__}
    for chunk in open_observation(paths).chunks():
        used = chunk.weights > 0
        row, channel = np.nonzero(used)
        parts["time"].append(chunk.integrations.time[row])
        parts["frequency"].append(chunk.frequency[channel])
        parts["uvw"].append(chunk.uvw[row])
        parts["stokes_i"].append(chunk.stokes_i[used])
        parts["weights"].append(chunk.weights[used])
        parts["interval"].append(chunk.integrations.interval[row])
        parts["width"].append(chunk.width[channel])
        parts["antennas"].append(chunk.integrations.antennas[row])
    found = Samples(**{name: np.concatenate(values) for name, values in parts.items()})
    first, second = np.sort(found.antennas, axis=1).T
    # Programs round times to 1e-5 s or so.
    times, frequencies = np.round(found.time, 2), np.round(found.frequency)
    return found.select(np.lexsort((second, first, frequencies, times)))


def check_same_samples(found: Samples, expected: Samples) -> None:
    """Check that a program has only rearranged visibilities: they are the same bits."""
    assert len(found) == len(expected)
    np.testing.assert_allclose(found.time, expected.time, rtol=0, atol=1e-3)
    np.testing.assert_allclose(found.frequency, expected.frequency, rtol=1e-12)
    for name in ("uvw", "stokes_i", "weights", "interval", "width", "antennas"):
        np.testing.assert_array_equal(getattr(found, name), getattr(expected, name), err_msg=name)


def shapes_of(*paths: Path, **options) -> Table:
    """Measure the three galaxies."""
    shapes = uvshear.measure([str(path) for path in paths], CATALOGUE, **options).shapes
    assert shapes["flag"].tolist() == ["ok", "ok", "ok", "point_source"]
    return shapes[:3]


def changes(found: Table, expected: Table) -> np.ndarray:
    """Return how far e1 and e2 of each galaxy have moved, in units of their errors."""
    return np.array(
        [(found[name] - expected[name]) / expected[f"{name}_err"] for name in ("e1", "e2")]
    )
