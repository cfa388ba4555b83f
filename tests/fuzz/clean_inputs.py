"""The clean inputs, written by the commands themselves: a small field in two kinds of sets, and all that follows."""

import json
from pathlib import Path

import numpy as np
from astropy.table import Table
from casacore import tables

from tests.arrays import EIGHT_ANTENNAS
from tests.io.measurement_set.varied_sets import LINEAR, Window, write_varied
from uvshear.cli.application import run
from uvshear.constants import MICROJANSKY
from uvshear.galaxy import Exponential, Galaxies, SizeFluxRelation
from uvshear.geometry.directions import PhaseCentre, direction_cosines
from uvshear.interferometer.coverage import Track, synthesise
from uvshear.interferometer.layout import load_layout
from uvshear.interferometer.spectral_window import Channels
from uvshear.predict import predict_visibilities

RA = np.array([30.006, 29.996, 29.988, 30.01])
DEC = np.array([-30.001, -30.006, -29.994, -29.992])
FLUX = np.array([50.0, 90.0, 30.0, 60.0])
LISTS = Path(__file__).parents[1] / "io" / "pybdsf"
TRACK = "--ra-deg 30 --declination-deg -30 --hours 2 --integration-s 600"
BIAS = {
    "estimator": "moments",
    "frame": "sky",
    "version": "0.2.0",
    "m1": -0.02,
    "m1_err": 0.01,
    "m2": -0.03,
    "m2_err": 0.01,
    "c1": 1e-4,
    "c1_err": 1e-4,
    "c2": 2e-4,
    "c2_err": 1e-4,
    "response1": 0.7,
    "response2": 0.7,
    "n": 1000,
    "failed": 0,
    "snr_min": 0.0,
    "selection": "catalogue",
    "flux_min_ujy": 0.0,
    "flux_max_ujy": None,
    "cuts": {"snr_min": 0.0, "selection": "catalogue", "flux_min_ujy": 0.0, "flux_max_ujy": None},
    "facet": "exact",
    "legacy_shear": False,
    "position_error_arcsec": 0.0,
    "density": None,
    "seed": 1,
    "shears": [[0.01, 0.01], [-0.01, -0.01]],
    "bins": [],
}
POPULATION = {
    "flux": {"index": -1.34, "minimum_ujy": 10, "maximum_ujy": 200},
    "size": {"intercept": -0.93, "slope": 0.33, "sigma": 0.3136},
    "ellipticity": {"c": 0.2298, "e0": 0.0732, "maximum": 0.804},
}


def write_clean_inputs(directory: Path) -> None:
    """Write all clean inputs into an empty directory."""
    (directory / "array.txt").write_text(EIGHT_ANTENNAS)
    _write_catalogues(directory)
    _run(
        *("simulate", "--layout", directory / "array.txt", "--catalogue", directory / "cat.ecsv"),
        *TRACK.split(),
        *["--band-mhz", "950", "1190", "--channels", "2", "--snr-at", "10", "40", "--smearing"],
        *("-o", directory / "field.ms"),
    )
    _write_windows(directory)
    _run(
        *("average", directory / "field.ms", "--field-arcmin", "1", "--accuracy", "0.5"),
        *("-o", directory / "averages.ms"),
    )
    _run(
        *("measure", directory / "field.ms", "--catalogue", directory / "cat.ecsv"),
        *("--keep", "moments,bayesian,metacal", "--threads", "1", "-o", directory / "shapes.fits"),
    )
    shapes = Table.read(directory / "shapes.fits")
    shapes.write(directory / "shapes.ecsv")
    (directory / "shapes.ecsv.stats.fits").write_bytes(
        (directory / "shapes.stats.fits").read_bytes()
    )
    (directory / "bias.json").write_text(json.dumps(BIAS, indent=2))
    (directory / "population.json").write_text(json.dumps(POPULATION, indent=2))
    _run(
        *("shear", directory / "shapes.fits", "--estimator", "bayesian"),
        *("-o", directory / "shear.json"),
    )


def _run(*words: str | Path) -> None:
    assert run([str(word) for word in words]) == 0


def _write_catalogues(directory: Path) -> None:
    table = Table({"id": [f"s{k}" for k in range(4)], "ra": RA, "dec": DEC, "flux": FLUX})
    table["spectral_index"] = [-0.7, -0.8, -0.6, -0.7]
    for name, unit in (("ra", "deg"), ("dec", "deg"), ("flux", "uJy")):
        table[name].unit = unit
    table["scale_length"] = np.exp(SizeFluxRelation().prior(FLUX * MICROJANSKY).log_median)
    table["scale_length"] *= np.degrees(1) * 3600
    table["scale_length"].unit = "arcsec"
    table.meta["reference_frequency"] = "1.4 GHz"
    table.write(directory / "cat.ecsv")
    table.write(directory / "cat.vot", format="votable")
    table.write(directory / "cat.csv", format="ascii.csv")
    # A card of FITS has a name of eight letters.
    table.meta["REFFREQ"] = table.meta.pop("reference_frequency")
    table.write(directory / "cat.fits")
    _write_pybdsf(directory)


def _write_pybdsf(directory: Path) -> None:
    """Put the sources into the lists that PyBDSF wrote of another image."""
    lines = (LISTS / "image.srl").read_text().splitlines()
    heads = [number for number, line in enumerate(lines) if line.startswith("# Source_id")]
    names = lines[heads[0]].removeprefix("#").split()
    rows = [line.split() for line in lines[heads[0] + 1 :] if line.strip()][:4]
    table = Table.read(LISTS / "image.srl.fits")[:4]
    for name, values in (("RA", RA), ("DEC", DEC), ("Total_flux", FLUX * MICROJANSKY)):
        table[name] = values
        for row, value in zip(rows, values, strict=True):
            row[names.index(name)] = f"{value:.14g}"
    head = "\n".join(lines[: heads[0] + 1])
    text = "\n".join(" ".join(row) for row in rows)
    (directory / "image.srl").write_text(f"{head}\n{text}\n")
    table.write(directory / "image.srl.fits")


def _write_windows(directory: Path) -> None:
    """Write the field in two spectral windows with four correlations, as observatories do."""
    centre = PhaseCentre(np.radians(30), np.radians(-30))
    track = Track.from_clock(centre, ((-3600.0, 3600.0),), 900.0)
    coverage = synthesise(load_layout(directory / "array.txt"), track)
    l, m, _ = direction_cosines(centre, np.radians(RA), np.radians(DEC))
    galaxies = Galaxies(
        l=l,
        m=m,
        flux=FLUX * MICROJANSKY,
        scale_length=np.exp(SizeFluxRelation().prior(FLUX * MICROJANSKY).log_median),
        ellipticity=np.array([0.2, 0.1j, -0.2, 0.1]),
        spectral_index=np.full(4, -0.7),
    )
    windows, sigma = [], 5e-6
    for low, high in ((950e6, 1070e6), (1070e6, 1190e6)):
        channels = Channels.from_band(low, high, 2)
        seen = predict_visibilities(galaxies, coverage.uvw, channels.frequency, Exponential())
        windows.append(Window(channels, seen))
    path = directory / "windows.ms"
    write_varied(path, coverage, windows, correlations=LINEAR, sigma=sigma, scans=2)
    # A sky without polarisation, so that the hands tell the noise.
    rng = np.random.default_rng(5)
    with tables.table(str(path), readonly=False, ack=False) as main:
        cells = main.getcol("DATA")
        noise = rng.normal(scale=sigma, size=(2, *cells.shape))
        sky = (cells[..., :1] + cells[..., -1:]) / 2 * np.array([1, 0, 0, 1])
        main.putcol("DATA", (sky + noise[0] + 1j * noise[1]).astype(np.complex64))
