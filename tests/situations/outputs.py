"""Outputs that meet inputs, one another, or what earlier runs left; and files of different runs that are mixed."""

import json
import shutil
from pathlib import Path

import numpy as np
from astropy.io import fits
from astropy.table import Table

from tests.situations.situation import SAME, Expected, Files, Situation, refused

MEASURE = "measure {}/field.ms --catalogue {}/cat.ecsv"
SIMULATE = (
    "simulate --layout {}/array.txt --hours 1 --integration-s 600 --band-mhz 950 1190 --no-noise"
)
SHEAR = "shear {}/clean.fits --estimator moments -o {}/shear.json"


def nothing(files: Files) -> None:
    """No change."""


def catalogue_called(name: str) -> object:
    """A catalogue with a name that an output would have."""

    def make(files: Files) -> list[str]:
        sources = Table.read(files.catalogue)
        sources.meta.clear()
        sources.write(files.directory / name)
        return ["--catalogue", str(files.directory / name)]

    return make


def made(name: str, content: str = "mine") -> object:
    """A file that is there before."""
    return lambda files: (files.directory / name).write_text(content)


def orphans(files: Files) -> None:
    """Files of a measurement whose shapes are gone."""
    for kind in ("stats", "sky"):
        shutil.copy(files.directory / f"clean.{kind}.fits", files.directory / f"out.{kind}.fits")


def another_run(files: Files) -> None:
    """Statistics of another measurement of the same sources."""
    path = files.directory / "clean.stats.fits"
    with fits.open(path, mode="update") as file:
        file[1].header["RUN"] = "0123456789abcdef"


def some_rows(files: Files) -> None:
    """Shapes from which rows were taken, and whose order was changed."""
    path = files.directory / "clean.fits"
    Table.read(path)[[2, 0]].write(path, overwrite=True)


def changed(name: str, value: object) -> object:
    """Statistics with impossible numbers."""

    def make(files: Files) -> None:
        path = files.directory / "clean.stats.fits"
        with fits.open(path, mode="update") as file:
            for column in file[1].columns:
                if column.name.startswith(name) and column.format.endswith(("D", "E")):
                    file[1].data[column.name][:] = value

    return make


def truncated(name: str) -> object:
    """A file that ends too early."""

    def make(files: Files) -> None:
        path: Path = files.directory / name
        path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])

    return make


def array_shapes(files: Files) -> None:
    """Shapes that are arrays."""
    path = files.directory / "clean.fits"
    shapes = Table.read(path)
    shapes["e1"] = np.tile(np.asarray(shapes["e1"]), (2, 1)).T
    shapes.write(path, overwrite=True)


def calibration(record: object) -> object:
    """A record of a bias that is none."""

    def make(files: Files) -> list[str]:
        path = files.directory / "bias.json"
        path.write_text(json.dumps(record))
        return ["--calibration", str(path)]

    return make


def killed(files: Files) -> None:
    """What a killed run leaves."""
    left = files.directory / ".out.fits.uvshear-unfinished-abcdefgh"
    left.mkdir()
    (left / "out.fits").write_text("half")


DONE = Expected(measures=False)
IS_INPUT = refused("is an input too|no measurement wrote it")

_CASES: tuple[tuple[str, object, Expected, str], ...] = (
    (
        "the catalogue",
        nothing,
        refused("is an input too"),
        f"{MEASURE} -o {{}}/cat.ecsv --overwrite",
    ),
    ("within the set", nothing, refused("within the input"), f"{MEASURE} -o {{}}/field.ms/o.fits"),
    (
        "a file of the set",
        made("field.ms/o.fits"),
        refused("within the input"),
        f"{MEASURE} -o {{}}/field.ms/o.fits --overwrite",
    ),
    (
        "a catalogue with the name of the statistics",
        catalogue_called("out.stats.fits"),
        IS_INPUT,
        f"{MEASURE} -o {{}}/out.fits --overwrite",
    ),
    (
        "a catalogue with the name of the sky",
        catalogue_called("out.sky.fits"),
        IS_INPUT,
        f"{MEASURE} -o {{}}/out.fits --overwrite",
    ),
    (
        "the statistics as a residual image",
        nothing,
        refused("written twice"),
        f"{MEASURE} --residual-image {{}}/out.stats.fits -o {{}}/out.fits",
    ),
    ("shapes that exist", nothing, refused("exists already"), f"{MEASURE} -o {{}}/clean.fits"),
    (
        "a file of someone else with the name of the sky",
        made("out.sky.fits"),
        refused("no measurement wrote it"),
        f"{MEASURE} -o {{}}/out.fits --overwrite",
    ),
    ("files without their shapes", orphans, SAME, f"{MEASURE} --keep moments -o {{}}/out.fits"),
    ("what a killed run leaves", killed, SAME, f"{MEASURE} -o {{}}/out.fits"),
    (
        "a directory that is not there",
        nothing,
        refused("does not exist"),
        f"{MEASURE} -o {{}}/no/out.fits",
    ),
    ("an extension of no format", nothing, refused("extension"), f"{MEASURE} -o {{}}/out.dat"),
    (
        "shapes as the record of their shear",
        nothing,
        refused("input too"),
        "shear {}/clean.fits -o {}/clean.fits --overwrite",
    ),
    (
        "statistics as the record of a shear",
        nothing,
        refused("input too"),
        "shear {}/clean.fits -o {}/clean.stats.fits --overwrite",
    ),
    (
        "the catalogue as a simulated set",
        nothing,
        refused("not a Measurement Set|input"),
        f"{SIMULATE} --catalogue {{}}/cat.ecsv -o {{}}/cat.ecsv --overwrite",
    ),
    (
        "a simulated set around its catalogue",
        lambda files: shutil.copy(files.catalogue, files.field / "cat.ecsv"),
        refused("contains the input"),
        f"{SIMULATE} --catalogue {{}}/field.ms/cat.ecsv -o {{}}/field.ms --overwrite",
    ),
    ("statistics of another run", another_run, refused("another measurement"), SHEAR),
    ("shapes cut to some rows", some_rows, DONE, SHEAR),
    ("statistics cut short", truncated("clean.stats.fits"), refused("clean.stats.fits"), SHEAR),
    ("shapes cut short", truncated("clean.fits"), refused("clean.fits"), SHEAR),
    ("shapes that are arrays", array_shapes, refused("e1"), SHEAR),
    ("a calibration that is a list", calibration([1, 2]), refused("bias.json"), SHEAR),
    ("a calibration of NaN", calibration({"m1": None}), refused("bias.json"), SHEAR),
    (
        "a calibration with m_err of 1e300",
        calibration({"m1": 0.0, "m1_err": 1e300, "m2": 0.0, "m2_err": 1e300, "c1": 0, "c2": 0}),
        refused("bias.json"),
        SHEAR,
    ),
    ("responses that are NaN", changed("", np.nan), refused("not those that were written"), SHEAR),
)

SITUATIONS = tuple(Situation(f"an output: {name}", *rest) for name, *rest in _CASES)
