"""What averaging and dishes do to shapes far from the phase centre, and what is left when each is not modelled.

    python benchmarks/losses.py
    python benchmarks/losses.py --degrees 1 --width-khz 500 --interval-s 4 --weight 1e8

Three galaxies off the centre, 64 antennas of SKA-Mid of two sizes, visibilities averaged over 5 x 5 frequencies and
moments within each channel and integration; no noise. Errors are the largest of the three.
"""

import argparse
from dataclasses import replace

import numpy as np

import uvshear
from uvshear.constants import ARCSEC, MICROJANSKY
from uvshear.execution import in_threads
from uvshear.galaxy import CatalogueSize, Galaxies
from uvshear.geometry.directions import PhaseCentre
from uvshear.interferometer.attenuation import BandwidthSmearing, CombinedAttenuation, TimeSmearing
from uvshear.interferometer.coverage import EARTH_ROTATION, antenna_uvw
from uvshear.interferometer.layout import load_layout
from uvshear.interferometer.primary_beam import AiryBeam
from uvshear.interferometer.visibilities import Integrations, Visibilities, VisibilitySet
from uvshear.io.catalogue import catalogue_from_galaxies
from uvshear.predict import predict_visibilities
from uvshear.predict.losses import Losses

CENTRE = PhaseCentre(0.0, np.radians(-30.0))
FREQUENCY = np.array([1.0e9, 1.15e9])
LAYOUT = load_layout("ska-mid-aa2")
HOURS = np.linspace(-1.0, 1.0, 12)
FIRST, SECOND = np.triu_indices(len(LAYOUT), 1)
DISHES = AiryBeam.from_diameters(LAYOUT.diameters)


def main() -> None:
    """Observe once, measure with each correction left out, print."""
    arguments = parse()
    sky = galaxies(arguments.degrees)
    width, interval = arguments.width_khz * 1e3, arguments.interval_s
    observation = observed(sky, width, interval, arguments.weight)
    smearing = BandwidthSmearing(), TimeSmearing(CENTRE.dec)
    one_index = replace(sky, spectral_index=np.full(3, -0.7))
    (block,) = observation.blocks
    plane = VisibilitySet(CENTRE, (replace(block, uvw=block.uvw * (1, 1, 0)),))
    cases = {
        "everything": (observation, sky, (*smearing, DISHES)),
        "no channels": (observation, sky, (smearing[1], DISHES)),
        "no integrations": (observation, sky, (smearing[0], DISHES)),
        "no primary beam": (observation, sky, smearing),
        "one spectral index": (observation, one_index, (*smearing, DISHES)),
        "no w": (plane, sky, (*smearing, DISHES)),
        "nothing": (observation, one_index, ()),
    }
    for name, (seen, modelled, parts) in cases.items():
        error, flux = errors(seen, modelled, sky, CombinedAttenuation(parts))
        print(f"{name:20} e {error:.5f}  flux {flux:.5f}", flush=True)


def parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--degrees", type=float, default=0.5, help="from the centre")
    parser.add_argument("--width-khz", type=float, default=1000.0, help="of the channels")
    parser.add_argument("--interval-s", type=float, default=8.0, help="of the integrations")
    parser.add_argument("--weight", type=float, default=1e7, help="of a visibility [Jy^-2]")
    return parser.parse_args()


def galaxies(degrees: float) -> Galaxies:
    angle = np.sin(np.radians(degrees))
    return Galaxies(
        l=np.array([1.0, -0.7, 0.0]) * angle,
        m=np.array([0.0, 0.7, -1.0]) * angle,
        flux=np.full(3, 5e-3),
        scale_length=np.array([1.0, 0.8, 1.2]) * ARCSEC,
        ellipticity=np.array([0.3 - 0.1j, -0.2 + 0.3j, 0.1 + 0.1j]),
        spectral_index=np.array([-0.7, -1.2, 0.1]),
    )


def errors(
    observation: VisibilitySet, modelled: Galaxies, true: Galaxies, attenuation: CombinedAttenuation
) -> tuple[float, float]:
    """Largest error of e, and of the flux over itself."""
    # The whole product stands in for the dishes' beam: parts of it are to be left out one by one.
    shapes = uvshear.measure(
        observation,
        catalogue_from_galaxies(modelled, CENTRE),
        model=uvshear.Model(size=CatalogueSize(), smears=False, primary_beam=attenuation),
        resources=uvshear.Resources(executor=in_threads(2)),
    ).shapes
    e = np.array(shapes["e1"]) + 1j * np.array(shapes["e2"])
    flux = np.array(shapes["flux_fit"]) * MICROJANSKY
    return float(np.abs(e - true.ellipticity).max()), float(np.abs(flux / true.flux - 1).max())


def observed(sky: Galaxies, width: float, interval: float, weight: float) -> VisibilitySet:
    """Averages of the visibilities themselves."""
    x, share = np.polynomial.legendre.leggauss(5)
    pairs = np.tile(np.column_stack([FIRST, SECOND]), (len(HOURS), 1))
    taken = Integrations(pairs, np.zeros(len(pairs)), np.full(len(pairs), interval))
    widths = np.full(len(FREQUENCY), width)
    dishes = Losses(DISHES, widths, taken)
    vis = np.zeros((len(pairs), len(FREQUENCY)), complex)
    for t, of_time in zip(x / 2, share / 2, strict=True):
        uvw = baselines(HOURS + EARTH_ROTATION * interval * t)
        for nu, of_channel in zip(x / 2, share / 2, strict=True):
            fine = predict_visibilities(
                sky, uvw, FREQUENCY + width * nu, executor=in_threads(2), losses=dishes
            )
            vis += of_time * of_channel * fine
    block = Visibilities(
        baselines(HOURS),
        FREQUENCY,
        vis,
        np.full(vis.shape, weight),
        width=widths,
        integrations=taken,
    )
    return VisibilitySet(CENTRE, (block,))


def baselines(hours: np.ndarray) -> np.ndarray:
    """Of all pairs at each hour angle [m]."""
    places = antenna_uvw(LAYOUT.positions, hours, CENTRE.dec)
    return (places[:, FIRST] - places[:, SECOND]).reshape(-1, 3)


if __name__ == "__main__":
    main()
