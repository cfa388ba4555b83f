"""Measurement Sets that CASA has put together, taken apart, averaged, shifted or simulated."""

import json
from pathlib import Path

import numpy as np
import pytest
from astropy.table import Table

import uvshear
from tests.io.measurement_set.rewritten_fields import (
    CATALOGUE,
    CENTRE,
    HIGH,
    array,
    changes,
    check_same_samples,
    samples_of,
    shapes_of,
    write_field,
    write_snapshots,
)
from tests.other_programs import run_casa
from uvshear.constants import ARCSEC, REFERENCE_FREQUENCY
from uvshear.galaxy import CatalogueSize, Gaussian
from uvshear.io.catalogue import Catalogue
from uvshear.io.observations import inspect

pytestmark = [pytest.mark.referee, pytest.mark.xdist_group("casa")]

REWRITE = """
import shutil
from casatasks import concat, exportuvfits, flagdata, importuvfits, mstransform, partition, phaseshift, split
from casatasks import virtualconcat

concat(vis=["early.ms", "late.ms"], concatvis="concat.ms")
concat(vis=["high.ms", "late.ms", "early.ms"], concatvis="bands.ms")
for name in ("early", "late"):
    # virtualconcat needs a SOURCE table, and moves what it is given
    mstransform(vis=f"{name}.ms", outputvis=f"member-{name}.ms", datacolumn="data")
virtualconcat(vis=["member-early.ms", "member-late.ms"], concatvis="virtual.mms")
partition(vis="early.ms", outputvis="baselines.mms", datacolumn="data", separationaxis="baseline", numsubms=3)
partition(vis="bands.ms", outputvis="bands.mms", datacolumn="data", separationaxis="spw", numsubms=2)
mstransform(vis="early.ms", outputvis="windows.ms", datacolumn="data", regridms=True, nspw=2)
split(vis="bands.ms", outputvis="window.ms", datacolumn="data", spw="1")
split(vis="early.ms", outputvis="antennas.ms", datacolumn="data", antenna="0~9&0~9")
mstransform(vis="early.ms", outputvis="averaged.ms", datacolumn="data", timeaverage=True, timebin="120s",
            chanaverage=True, chanbin=2)
phaseshift(vis="snapshots.ms", outputvis="shifted.ms", datacolumn="data", phasecenter="J2000 0.3001rad 0.698rad")
exportuvfits(vis="early.ms", fitsfile="early.uvfits", datacolumn="data")
importuvfits(fitsfile="early.uvfits", vis="uvfits.ms")
shutil.copytree("early.ms", "flagged.ms")
flagdata(vis="flagged.ms", mode="manual", antenna="3")
flagdata(vis="flagged.ms", mode="manual", spw="0:2")
"""

SIMULATE = """
import json
import numpy as np
from casatools import componentlist, measures, simulator, table

field = json.load(open("field.json"))
sm, me, cl, tb = simulator(), measures(), componentlist(), table()
sm.open("simulated.ms")
x, y, z = np.transpose(field["positions"]).tolist()
count = len(x)
sm.setconfig(telescopename="VLA", x=x, y=y, z=z, dishdiameter=[25.0] * count, mount=["alt-az"],
             antname=[f"A{k:02d}" for k in range(count)], coordsystem="global", referencelocation=me.observatory("VLA"))
sm.setspwindow(spwname="L", freq="1.4GHz", deltafreq="50kHz", freqresolution="50kHz", nchannels=4,
               stokes="RR RL LR LL")
sm.setfeed("perfect R L")
ra, dec = field["centre"]
sm.setfield(sourcename="field", sourcedirection=me.direction("J2000", f"{ra}rad", f"{dec}rad"))
sm.setauto(0.0)
sm.settimes(integrationtime="1s", usehourangle=True, referencetime=me.epoch("UTC", "2020/01/01/00:00:00"))
for start in np.linspace(-7200, 7200, 60):
    sm.observe("field", "L", starttime=f"{start}s", stoptime=f"{start + 1}s")
for ra, dec, flux, major, minor, angle in field["galaxies"]:
    cl.addcomponent(dir=f"J2000 {ra:.14f}rad {dec:.14f}rad", flux=flux, fluxunit="Jy", freq="1.4GHz",
                    shape="Gaussian", majoraxis=f"{major}arcsec", minoraxis=f"{minor}arcsec",
                    positionangle=f"{angle}deg", spectrumtype="spectral index", index=-0.7)
cl.rename("galaxies.cl")
cl.close()
sm.predict(complist="galaxies.cl")
sm.setseed(11)
sm.setnoise(mode="simplenoise", simplenoise="1mJy")
sm.corrupt()
sm.close()
tb.open("simulated.ms", nomodify=False)
for name, value in (("WEIGHT", 1e6), ("SIGMA", 1e-3)):
    tb.putcol(name, np.full(tb.getcol(name).shape, value))
tb.close()
"""
"""Snapshots, whose smearing is nothing: CASA's simulator does not smear. It leaves all weights at 1."""


@pytest.fixture(scope="module")
def sets(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Directory of what CASA has written."""
    directory = tmp_path_factory.mktemp("casa")
    write_field(directory / "early.ms", (-0.5, 0.1))
    write_field(directory / "late.ms", (1.0, 1.3), seed=2)
    write_field(directory / "high.ms", (-0.5, 0.1), HIGH, seed=3)
    write_snapshots(directory / "snapshots.ms")
    run_casa(REWRITE, directory)
    return directory


@pytest.mark.parametrize(
    ("written", "sources"),
    [
        ("concat.ms", ["early", "late"]),
        ("bands.ms", ["high", "early", "late"]),
        ("virtual.mms", ["early", "late"]),
        ("baselines.mms", ["early"]),
        ("bands.mms", ["high", "early", "late"]),
        ("windows.ms", ["early"]),
        ("window.ms", ["early", "late"]),
    ],
)
def test_rearranged_visibilities_are_the_same(sets: Path, written: str, sources: list[str]) -> None:
    expected = samples_of(*(sets / f"{source}.ms" for source in sources))
    check_same_samples(samples_of(sets / written), expected)
    (content,) = inspect(sets / written).fields
    assert content.counts.usable == len(expected)
    assert content.warnings == ()


def test_antennas_and_flags_are_those_that_casa_left(sets: Path) -> None:
    early = samples_of(sets / "early.ms")
    check_same_samples(
        samples_of(sets / "antennas.ms"), early.select((early.antennas < 10).all(axis=1))
    )
    kept = (early.antennas != 3).all(axis=1) & (early.frequency != np.unique(early.frequency)[2])
    check_same_samples(samples_of(sets / "flagged.ms"), early.select(kept))


def test_averages_are_weighted_means(sets: Path) -> None:
    early = samples_of(sets / "early.ms")
    baselines = len(np.unique(early.antennas, axis=0))

    def pairs(values: np.ndarray) -> np.ndarray:
        """Mean over two times and two channels."""
        blocks = values.reshape(-1, 2, 4, 2, baselines, *values.shape[1:])
        return blocks.mean(axis=(1, 3)).reshape(-1, *values.shape[1:])

    found = samples_of(sets / "averaged.ms")
    np.testing.assert_allclose(found.time, pairs(early.time), rtol=0, atol=1e-3)
    np.testing.assert_allclose(found.frequency, pairs(early.frequency), rtol=1e-12)
    np.testing.assert_allclose(found.uvw, pairs(early.uvw), rtol=0, atol=1e-6)
    # the weights are equal
    np.testing.assert_allclose(found.weights, 4 * pairs(early.weights), rtol=1e-6)
    np.testing.assert_allclose(found.stokes_i, pairs(early.stokes_i), rtol=0, atol=5e-8)
    assert np.unique(found.interval).tolist() == [120.0]
    assert np.unique(found.width).tolist() == [10e6]


@pytest.mark.parametrize("written", ["baselines.mms", "windows.ms", "uvfits.ms"])
def test_shapes_stay(sets: Path, shapes: Table, written: str) -> None:
    """Up to 0.003 of the errors, by the order of sums; float32 in UVFITS adds nothing to it."""
    assert np.abs(changes(shapes_of(sets / written), shapes)).max() < 0.01


def test_averaging_changes_shapes_as_little_as_the_errors_say(sets: Path, shapes: Table) -> None:
    """By 0.10 of the errors, which grow to 1.008 of what they were; smearing alone makes 20 times as much."""
    found = shapes_of(sets / "averaged.ms")
    assert np.abs(changes(found, shapes)).max() < 0.3
    assert np.all(found["e1_err"] < 1.02 * shapes["e1_err"])


def test_a_moved_phase_centre_moves_no_shape(sets: Path) -> None:
    """By 0.014 of the errors, for a move of 31 arcsec."""
    before, after = (shapes_of(sets / name) for name in ("snapshots.ms", "shifted.ms"))
    assert np.abs(changes(after, before)).max() < 0.1
    for name in ("dl", "dm"):
        np.testing.assert_allclose(after[name], before[name], rtol=0, atol=0.001, err_msg=name)


@pytest.fixture(scope="module")
def shapes(sets: Path) -> Table:
    """Shapes from the set before any change."""
    return shapes_of(sets / "early.ms")


def _gaussians() -> tuple[list[list[float]], Catalogue]:
    """Full widths [arcsec] and position angles [deg] of three galaxies, and their catalogue."""
    widths = np.array([[3.0, 2.0], [2.5, 1.0], [4.0, 2.5]])
    angle = np.array([30.0, 110.0, 60.0])
    # sigma of the axes is alpha / (1 - |e|) and alpha / (1 + |e|)
    alpha = 2 / np.sum(1 / widths, axis=1) / np.sqrt(8 * np.log(2)) * ARCSEC
    catalogue = Catalogue(
        identifier=np.arange(3),
        flux=CATALOGUE.flux[:3],
        spectral_index=np.full(3, -0.7),
        ra=CATALOGUE.ra[:3],
        dec=CATALOGUE.dec[:3],
        scale_length=alpha,
        reference_frequency=REFERENCE_FREQUENCY,
    )
    columns = [catalogue.ra, catalogue.dec, catalogue.flux, *widths.T, angle]
    return np.column_stack(columns).tolist(), catalogue


def test_a_sky_of_casa_s_simulator_has_its_shapes(tmp_path: Path) -> None:
    rows, catalogue = _gaussians()
    field = {
        "positions": array().positions.tolist(),
        "centre": [CENTRE.ra, CENTRE.dec],
        "galaxies": rows,
    }
    (tmp_path / "field.json").write_text(json.dumps(field))
    run_casa(SIMULATE, tmp_path)
    path = tmp_path / "simulated.ms"
    (content,) = inspect(path).fields
    assert content.warnings == ()
    assert content.uvw_agrees
    model = uvshear.Model(profile=Gaussian(), size=CatalogueSize())
    shapes = uvshear.measure(path, catalogue, model=model).shapes
    assert shapes["flag"].tolist() == ["ok"] * 3
    major, minor, angle = np.transpose(rows)[3:]
    modulus = (major - minor) / (major + minor)
    for name, truth in (
        ("e1", -modulus * np.cos(2 * np.radians(angle))),
        ("e2", modulus * np.sin(2 * np.radians(angle))),
        ("flux_fit", 1e6 * catalogue.flux),
        ("scale_length", catalogue.scale_length / ARCSEC),
    ):
        assert np.all(np.abs(shapes[name] - truth) < 4 * shapes[f"{name}_err"]), name
    assert np.all(shapes["e_sigma"] < 0.003)
    np.testing.assert_allclose(shapes["position_angle"], angle, rtol=0, atol=0.5)
    for name in ("dl", "dm"):
        np.testing.assert_allclose(shapes[name], 0, atol=0.01, err_msg=name)
