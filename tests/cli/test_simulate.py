from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from uvshear.cli.simulate import parse_sefd
from uvshear.errors import InputError
from uvshear.galaxy import Galaxies, SizeFluxRelation
from uvshear.io.measurement_set.observation import MeasurementSet
from uvshear.predict import predict_visibilities

GOOD = "--declination-deg -30 --hours 1 --integration-s 600 --band-mhz 950 1190 --snr-at 10 50"


def test_a_field_is_simulated_with_its_phase_centre(field: Path) -> None:
    observation = MeasurementSet(field)
    assert observation.phase_centre.dec == pytest.approx(np.radians(-30))
    assert sum(len(chunk) for chunk in observation.chunks()) == 28 * 6  # baselines, samples


def test_snr_at_is_that_of_the_round_median_galaxy(field: Path) -> None:
    flux = np.array([10e-6])
    zero = np.zeros(1)
    size = SizeFluxRelation().median(flux)
    galaxy = Galaxies(zero, zero, flux, size, zero.astype(complex), np.array([-0.7]))
    power = 0.0
    for chunk in MeasurementSet(field).chunks():
        model = predict_visibilities(galaxy, chunk.uvw, chunk.frequency)
        power += float(np.sum(chunk.weights * np.abs(model) ** 2))
    assert np.sqrt(power) == pytest.approx(50, rel=1e-5)


def test_hours_and_hour_angles_say_the_same(
    uvshear: Callable, tmp_path: Path, catalogue: Path, layout: Path, field: Path
) -> None:
    words = GOOD.replace("--hours 1", "--hour-angles -0.5 0 --hour-angles 0 0.5")
    path = tmp_path / "other.ms"
    outcome = uvshear(
        "simulate", "--layout", layout, "--catalogue", catalogue, *words.split(), "-o", path
    )
    assert outcome.status == 0, outcome.err
    one, other = (next(iter(MeasurementSet(p).chunks())) for p in (field, path))
    np.testing.assert_allclose(one.uvw, other.uvw, atol=1e-3)


def test_the_result_does_not_depend_on_threads(
    uvshear: Callable, tmp_path: Path, catalogue: Path, layout: Path, field: Path
) -> None:
    path = tmp_path / "other.ms"
    common = ("simulate", "--layout", layout, "--catalogue", catalogue, *GOOD.split())
    assert uvshear(*common, "--threads", "1", "-o", path).status == 0
    one, other = (next(iter(MeasurementSet(p).chunks())) for p in (field, path))
    np.testing.assert_array_equal(one.stokes_i, other.stokes_i)


@pytest.mark.parametrize(
    ("text", "sefd"),
    [("400", 400.0), ("15:400,13.5:420", ((15.0, 400.0), (13.5, 420.0)))],
)
def test_an_sefd_is_one_number_or_one_a_diameter(text: str, sefd: object) -> None:
    assert parse_sefd(text) == sefd


@pytest.mark.parametrize("text", ["", "-1", "nan", "15:400:3", "15:-2", "many", "15:400,20"])
def test_a_wrong_sefd_is_refused(text: str) -> None:
    with pytest.raises(InputError, match="--sefd-jy"):
        parse_sefd(text)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("--hours 1", "--hours -1", "'--hours': -1; a number above 0 is needed"),
        ("--hours 1", "", "--hours or --hour-angles: give one of the two"),
        ("--hours 1", "--hours 1 --hour-angles 0 1", "--hours or --hour-angles"),
        ("--hours 1", "--hour-angles 2 1", "2 1 is not a range; A < B"),
        ("--hours 1", "--hour-angles one 2", "'one 2': two numbers A B are needed"),
        ("--hours 1", "--hour-angles 0 2 --hour-angles 1 3", "overlap"),
        (
            "--integration-s 600",
            "--integration-s 0",
            "'--integration-s': 0; a number above 0 is needed",
        ),
        ("950 1190", "1190 950", "1190 950 is not a range"),
        ("950 1190", "-950 1190", "-950 1190 is not a range"),
        ("--snr-at 10 50", "", "--snr-at, --sefd-jy or --no-noise"),
        ("--snr-at 10 50", "--snr-at 10 -50", "10 -50: both must be above 0"),
        ("--snr-at 10 50", "--snr-at 10 50 --sefd-jy 400", "--snr-at and --sefd-jy"),
        ("--snr-at 10 50", "--sefd-jy minus", "--sefd-jy minus: a positive number"),
        ("--snr-at 10 50", "--sefd-jy 15:400", "dishes of 13.5 m without an SEFD"),
        (
            "--snr-at 10 50",
            "--sefd-jy 400 --efficiency 1.1",
            "1.1; a number above 0 and at most 1 is needed",
        ),
        ("--declination-deg -30", "--declination-deg -95", "-95; a declination between -90 and 90"),
        ("--declination-deg -30", "", "--declination-deg: is needed, because the catalogue has no"),
        (
            "--declination-deg",
            "--channels 0 --declination-deg",
            "'--channels': 0; a number above 0 is needed",
        ),
        ("--declination-deg", "--shear 1 0.5 --declination-deg", "|g| must be below 1"),
        ("--declination-deg", "--shear nan 0 --declination-deg", "|g| must be below 1"),
        (
            "--declination-deg",
            "--elevation-limit-deg -5 --declination-deg",
            "-5; a number of 0 or more is needed",
        ),
        ("--declination-deg", "--elevation-limit-deg 89.9 --declination-deg", "elevation"),
        ("--declination-deg", "--profile cube --declination-deg", "--profile cube: 'cube' is not"),
        ("--declination-deg", "--primary-beam x --declination-deg", "--primary-beam x: 'x' is not"),
    ],
)
def test_a_wrong_option_is_named_and_nothing_written(
    uvshear: Callable,
    tmp_path: Path,
    catalogue: Path,
    layout: Path,
    old: str,
    new: str,
    message: str,
) -> None:
    before = sorted(tmp_path.iterdir())
    words = GOOD.replace(old, new).split()
    outcome = uvshear(
        "simulate",
        "--layout",
        layout,
        "--catalogue",
        catalogue,
        *words,
        "-o",
        tmp_path / "field.ms",
    )
    assert outcome.status == 2
    assert message in outcome.err
    assert outcome.err.count("\n") == 1
    assert sorted(tmp_path.iterdir()) == before


@pytest.mark.parametrize(
    ("option", "name", "message"),
    [
        ("--catalogue", "absent.fits", "absent.fits: no such file"),
        ("--catalogue", "cat.csv", "column 'flux' has no unit"),
        ("--layout", "nowhere", "neither a known array"),
        ("-o", "nowhere/field.ms", "does not exist"),
        ("-o", "cat.ecsv", "exists already"),
    ],
)
def test_a_wrong_file_is_named_and_nothing_written(
    uvshear: Callable,
    tmp_path: Path,
    catalogue: Path,
    layout: Path,
    option: str,
    name: str,
    message: str,
) -> None:
    files = {"--layout": layout, "--catalogue": catalogue, "-o": tmp_path / "field.ms"}
    files[option] = tmp_path / name
    before = sorted(tmp_path.iterdir())
    words = [word for pair in files.items() for word in pair]
    outcome = uvshear("simulate", *words, *GOOD.split())
    assert outcome.status == 2
    assert message in outcome.err
    assert outcome.err.count("\n") == 1
    assert sorted(tmp_path.iterdir()) == before


def test_a_measurement_set_is_replaced_only_if_asked(
    uvshear: Callable, catalogue: Path, layout: Path, field: Path
) -> None:
    words = ("simulate", "--layout", layout, "--catalogue", catalogue, *GOOD.split(), "-o", field)
    assert uvshear(*words).status == 2
    assert uvshear(*words, "--overwrite").status == 0
