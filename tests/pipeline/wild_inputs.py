"""A small observation and its catalogue, with values put into them that cannot be right, or hardly."""

from dataclasses import dataclass, replace

import numpy as np
from astropy.table import Table
from hypothesis import strategies as st

from tests.skies import galaxies, random_baselines
from uvshear.constants import ARCSEC
from uvshear.geometry.directions import PhaseCentre, equatorial
from uvshear.interferometer.visibilities import Integrations, Visibilities, VisibilitySet
from uvshear.predict import predict_visibilities

CENTRE = PhaseCentre(1.0, -0.5)
FREQUENCY = np.array([1.3e9, 1.4e9])
ROWS, SIGMA = 240, 3e-4
NOT_FINITE = (np.nan, np.inf, -np.inf)

OF_ROWS = {
    "uvw": (*NOT_FINITE, 0.0, 1e-30, 1e7, 1e20, 1e300),
    "stokes_i": (*NOT_FINITE, 0.0, 1e3, 1e10, 1e30, complex(np.nan, 0)),
    "weights": (*NOT_FINITE, 0.0, -1.0, -1e30, 1e-30, 1e12, 1e30),
    "time": (*NOT_FINITE, -1e30, 1e30, 0.0),
    "interval": (*NOT_FINITE, -1.0, 0.0, 1e6, 1e30),
    "antennas": (-1, 0, 30_000),
}
OF_CHANNELS = {
    "width": (*NOT_FINITE, -1e6, 0.0, 1e9, 1e30),
    "frequency": (*NOT_FINITE, -1e9, 0.0, 1e-3, 1e20, 1e300),
}
OF_SOURCES = {
    "flux": (*NOT_FINITE, -1.0, 0.0, 1e-30, 1e-9, 1e30),
    "ra": (*NOT_FINITE, 1e30, 0.0, 720.0),
    "dec": (*NOT_FINITE, 91.0, 90.0, -90.0),
    "scale_length": (*NOT_FINITE, -1.0, 0.0, 1e-30, 1e-6, 60.0, 1e4, 1e30),
    "spectral_index": (*NOT_FINITE, 100.0, -100.0, 1e5),
    "reference_frequency": (*NOT_FINITE, -1.0, 0.0, 1e-3, 1e12, 1e30),
}


@dataclass(frozen=True)
class Change:
    """A value that is put into some of the rows, channels or sources."""

    name: str
    value: complex
    rows: slice

    def of_samples(self, seen: Visibilities) -> Visibilities:
        """Return the samples with the value in them."""
        in_rows = self.name in ("time", "interval", "antennas")
        owner = seen.integrations if in_rows else seen
        values = getattr(owner, self.name).copy()
        places = self.rows if self.name in OF_ROWS else slice((self.rows.start or 0) % 2, None)
        values[places] = self.value
        changed = replace(owner, **{self.name: values})
        return replace(seen, integrations=changed) if in_rows else changed


def _changes(kinds: dict[str, tuple[complex, ...]]) -> st.SearchStrategy[Change]:
    rows = st.sampled_from([slice(0, None), slice(3, 4), slice(1, None, 2), slice(2, None, 9)])
    choices = [(name, value) for name, values in kinds.items() for value in values]
    return st.tuples(st.sampled_from(choices), rows).map(lambda two: Change(*two[0], two[1]))


wild_sets = st.lists(_changes(OF_ROWS | OF_CHANNELS), max_size=3)
wild_catalogues = st.lists(_changes(OF_SOURCES), max_size=1)


def sky():
    """Four galaxies, half an arcminute apart."""
    l = np.array([0, 40, -60, 20]) * ARCSEC
    m = np.array([0, 30, 10, -70]) * ARCSEC
    flux = np.array([1.0, 0.7, 0.5, 0.3]) * 1e-3
    alpha = np.array([1.2, 0.9, 1.0, 0.8]) * ARCSEC
    return galaxies(l, m, flux, alpha, np.array([0.2, 0.1j, -0.3, 0.1 + 0.1j]))


def observation(changes):
    """The galaxies as 21 antennas see them in an hour."""
    uvw = random_baselines(ROWS, 3e4, depth=0.3)
    vis = predict_visibilities(sky(), uvw, FREQUENCY)
    noise = np.random.default_rng(3).normal(size=(2, *vis.shape))
    pairs = np.array([(p, q) for p in range(24) for q in range(p + 1, 24)])[:ROWS]
    seen = Visibilities(
        uvw=uvw,
        frequency=FREQUENCY,
        stokes_i=(vis + SIGMA * (noise[0] + 1j * noise[1])).astype(np.complex64),
        weights=np.full(vis.shape, SIGMA**-2, np.float32),
        width=np.full(2, 1e6),
        integrations=Integrations(
            pairs, 5e9 + 60.0 * np.repeat(np.arange(10.0), ROWS // 10), np.full(ROWS, 60.0)
        ),
    )
    with np.errstate(over="ignore"):
        for change in changes:
            seen = change.of_samples(seen)
    return VisibilitySet(CENTRE, (seen,))


def catalogue(changes):
    """The galaxies' catalogue."""
    truth = sky()
    ra, dec = equatorial(CENTRE, truth.l, truth.m)
    table = Table(
        {
            "ra": np.degrees(ra),
            "dec": np.degrees(dec),
            "flux": truth.flux,
            "scale_length": truth.scale_length / ARCSEC,
            "spectral_index": truth.spectral_index,
            "reference_frequency": np.full(4, 1.4e9),
        }
    )
    table["flux"].unit = "Jy"
    for change in changes:
        table[change.name][change.rows] = change.value
    return table
