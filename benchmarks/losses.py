"""What averaging and dishes do to shapes far from the phase centre, and what is left when each is not modelled.

    python benchmarks/losses.py

Three galaxies half a degree off the centre, 64 antennas of SKA-Mid of two sizes, 1 MHz channels and 8 s integrations,
averaged over 5 x 5 frequencies and moments within each; no noise. Errors are the largest of the three.
"""

from dataclasses import replace

import numpy as np

from uvshear.constants import ARCSEC
from uvshear.galaxy import CatalogueSize, Galaxies
from uvshear.geometry.directions import PhaseCentre
from uvshear.interferometer.attenuation import BandwidthSmearing, TimeSmearing, Together
from uvshear.interferometer.coverage import EARTH_ROTATION, antenna_uvw
from uvshear.interferometer.layout import load_layout
from uvshear.interferometer.primary_beam import AiryBeam
from uvshear.interferometer.visibilities import Integrations, Visibilities, VisibilitySet
from uvshear.io.catalogue import catalogue_from_galaxies
from uvshear.measurement import MeasurementOptions
from uvshear.pipeline import extract
from uvshear.predict import predict_visibilities
from uvshear.predict.losses import Losses

CENTRE = PhaseCentre(0.0, np.radians(-30.0))
FREQUENCY, WIDTH, INTERVAL = np.array([1.0e9, 1.15e9]), np.full(2, 1e6), 8.0
LAYOUT = load_layout("ska-mid-aa2")
HOURS = np.linspace(-1.0, 1.0, 12)
FIRST, SECOND = np.triu_indices(len(LAYOUT), 1)
DISHES = AiryBeam.of_diameters(LAYOUT.diameters)
ANGLE = np.sin(np.radians(0.5))

SKY = Galaxies(
    l=np.array([1.0, -0.7, 0.0]) * ANGLE,
    m=np.array([0.0, 0.7, -1.0]) * ANGLE,
    flux=np.full(3, 5e-3),
    scale_length=np.array([1.0, 0.8, 1.2]) * ARCSEC,
    ellipticity=np.array([0.3 - 0.1j, -0.2 + 0.3j, 0.1 + 0.1j]),
    spectral_index=np.array([-0.7, -1.2, 0.1]),
)


def main() -> None:
    """Observe once, measure with each correction left out, print."""
    observation = observed()
    smearing = BandwidthSmearing(), TimeSmearing(CENTRE.dec)
    flat = replace(SKY, spectral_index=np.full(3, -0.7))
    cases = {
        "everything": (SKY, (*smearing, DISHES)),
        "no channels": (SKY, (smearing[1], DISHES)),
        "no integrations": (SKY, (smearing[0], DISHES)),
        "no primary beam": (SKY, smearing),
        "one spectral index": (flat, (*smearing, DISHES)),
        "nothing": (flat, ()),
    }
    for name, (sky, parts) in cases.items():
        error, flux = errors(observation, sky, Together(parts))
        print(f"{name:20} e {error:.5f}  flux {flux:.5f}", flush=True)


def errors(observation: VisibilitySet, sky: Galaxies, attenuation: Together) -> tuple[float, float]:
    """Largest error of e, and of the flux over itself."""
    # The whole product stands in for the dishes' beam: parts of it are to be left out one by one.
    options = MeasurementOptions(
        size=CatalogueSize(), threads=2, smears=False, primary_beam=attenuation
    )
    found = extract(observation, catalogue_from_galaxies(sky, CENTRE), options)[1].measurements
    e = np.array([complex(*found[k].ellipticity) for k in range(len(sky))])
    flux = np.array([found[k].flux for k in range(len(sky))])
    return float(np.abs(e - SKY.ellipticity).max()), float(np.abs(flux / SKY.flux - 1).max())


def observed() -> VisibilitySet:
    """Averages of the visibilities themselves."""
    x, weight = np.polynomial.legendre.leggauss(5)
    pairs = np.tile(np.column_stack([FIRST, SECOND]), (len(HOURS), 1))
    taken = Integrations(pairs, np.zeros(len(pairs)), np.full(len(pairs), INTERVAL))
    dishes = Losses(DISHES, WIDTH, taken)
    vis = np.zeros((len(pairs), len(FREQUENCY)), complex)
    for t, of_time in zip(x / 2, weight / 2, strict=True):
        uvw = baselines(HOURS + EARTH_ROTATION * INTERVAL * t)
        for nu, of_channel in zip(x / 2, weight / 2, strict=True):
            fine = predict_visibilities(SKY, uvw, FREQUENCY + WIDTH * nu, threads=2, losses=dishes)
            vis += of_time * of_channel * fine
    block = Visibilities(
        baselines(HOURS), FREQUENCY, vis, np.full(vis.shape, 1e7), width=WIDTH, integrations=taken
    )
    return VisibilitySet(CENTRE, (block,))


def baselines(hours: np.ndarray) -> np.ndarray:
    """Of all pairs at each hour angle [m]."""
    places = antenna_uvw(LAYOUT.positions, hours, CENTRE.dec)
    return (places[:, FIRST] - places[:, SECOND]).reshape(-1, 3)


if __name__ == "__main__":
    main()
