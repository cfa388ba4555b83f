"""The package from Python: what a user imports, and every command's work in a few lines."""

import ast
import inspect
import pydoc
import subprocess
import sys
import textwrap
from pathlib import Path

import numpy as np
import pytest
from astropy import units
from astropy.table import Table

import uvshear

# Bright sources in long integrations make neighbouring samples differ by more than noise.

SETTING = """
plan = uvshear.ObservingPlan(
    uvshear.load_layout("meerkat"),
    uvshear.Track.from_clock(uvshear.PhaseCentre(0.0, -0.5), ((-7200, 7200),), 1200),
    uvshear.Channels.from_band(0.95e9, 1.19e9, 1),
)
"""

TASKS = {
    "layouts": """
        print(uvshear.known_layouts())
        layout = uvshear.load_layout("vla-a")
        uvshear.plot.save(uvshear.plot.draw_layout(layout.positions, layout.name), Path("vla-a.png"))
    """,
    "catalogue": """
        sky = uvshear.SquareField(np.radians(0.1))
        number = uvshear.expected_number(sky, density=1e7, ring=2)
        rng = np.random.default_rng(1)
        galaxies = uvshear.draw_population(uvshear.Population(ring=2), sky, number=number, rng=rng)
        uvshear.write_catalogue("drawn.fits", uvshear.catalogue_from_galaxies(galaxies))
    """,
    "simulate": """
        observation = uvshear.simulate("CAT.fits", plan, shear=0.03 + 0.01j, seed=2)
        uvshear.write_measurement_set("simulated.ms", observation)
    """,
    "info": """
        content = uvshear.inspect("FIELD.ms")
        print(content.telescope.name, content.fields[0].counts.usable)
    """,
    "average": """
        averaged = uvshear.average("FIELD.ms", "compact.ms", field_arcmin=10)
        print(averaged.samples / averaged.rows)
    """,
    "measure": """
        keep = "moments,bayesian,metacal"
        m = uvshear.measure("FIELD.ms", "CAT.fits", keep=keep)
        m.write("SHAPES.fits")
        m = uvshear.read_measurement("SHAPES.fits")
        image = m.residual_image("FIELD.ms")
    """,
    "shear": """
        for estimator in ("mean", "moments", "bayesian", "metacal"):
            shear = uvshear.estimate_shear("SHAPES.fits", estimator, flux_min=10e-6)
            uvshear.write_shear(f"{estimator}.json", shear)
    """,
    "bias": """
        survey = uvshear.Survey(plan)
        bias = uvshear.estimate_bias("moments", galaxies=100, shear=0.05, survey=survey)
        uvshear.write_bias("BIAS.json", bias)
        bias = uvshear.read_bias("BIAS.json")
        shear = uvshear.estimate_shear("SHAPES.fits", "moments", correction=bias)
    """,
    "psf": """
        grid = uvshear.ImageGrid(size=128, pixel=0.5 * np.pi / 180 / 3600)
        observation = uvshear.weighted(uvshear.open_observation("FIELD.ms"), [uvshear.RoundPsf()])
        psf = uvshear.point_spread_function(observation, grid)
        shape = uvshear.measure_psf(psf, grid.pixel, 10 * grid.pixel)
        lobe = uvshear.fit_main_lobe(psf, grid.pixel)
    """,
    "reproduce": """
        page = uvshear.reproduce_paper("reproduced", ["psf-images"], scale="quick")
        print(page.read_text())
    """,
}
"""The work of each command but ``demo``, which runs the others."""


@pytest.fixture(scope="module")
def workplace(tmp_path_factory):
    """FIELD.ms, CAT.fits and SHAPES.fits of six bright galaxies."""
    directory = tmp_path_factory.mktemp("door")
    rng = np.random.default_rng(2)
    Table(
        {
            "id": np.arange(1, 7),
            "l": np.array([1.0, -1.0, 0.3, -0.6, 1.4, 0.2]) * 1e-3,
            "m": np.array([0.5, 2.0, -0.8, -1.5, -0.4, 1.2]) * 1e-3,
            "flux": np.array([80.0, 120.0, 90.0, 110.0, 150.0, 100.0]) * units.uJy,
            "scale_length": np.full(6, 1.5) * units.arcsec,
            "e1": rng.uniform(-0.3, 0.3, 6),
            "e2": rng.uniform(-0.3, 0.3, 6),
        }
    ).write(directory / "CAT.fits")
    names = {"uvshear": uvshear}
    exec(SETTING, names)
    observation = uvshear.simulate(
        directory / "CAT.fits", names["plan"], noise=uvshear.GalaxyNoise(snr=100.0)
    )
    uvshear.write_measurement_set(directory / "FIELD.ms", observation)
    measurement = uvshear.measure(
        directory / "FIELD.ms", directory / "CAT.fits", keep="moments,bayesian,metacal"
    )
    measurement.write(directory / "SHAPES.fits")
    return directory


@pytest.mark.parametrize("task", TASKS)
def test_the_work_of_a_command_is_a_few_lines_of_python(
    task, workplace, tmp_path, monkeypatch, capsys
):
    for path in workplace.iterdir():
        if task != "measure" or not path.name.startswith("SHAPES"):
            (tmp_path / path.name).symlink_to(path)
    monkeypatch.chdir(tmp_path)
    code = textwrap.dedent(TASKS[task])
    assert len(code.strip().splitlines()) <= 5
    names = {"uvshear": uvshear, "np": np, "Path": Path}
    exec(SETTING, names)
    exec(compile(code, task, "exec"), names)
    capsys.readouterr()
    made = {path.name for path in tmp_path.iterdir() if not path.is_symlink()}
    expected = {
        "layouts": {"vla-a.png"},
        "catalogue": {"drawn.fits"},
        "simulate": {"simulated.ms"},
        "average": {"compact.ms"},
        "shear": {f"{name}.json" for name in ("mean", "moments", "bayesian", "metacal")},
        "bias": {"BIAS.json"},
        "measure": {"SHAPES.fits", "SHAPES.stats.fits", "SHAPES.sky.fits"},
        "reproduce": {"reproduced"},
    }
    assert made == expected.get(task, set())


def test_every_command_has_its_lines():
    from typer.main import get_command

    from uvshear.cli.application import app

    assert set(TASKS) == set(get_command(app).commands) - {"demo"}


def test_every_public_name_can_be_imported_and_is_listed():
    listed = dir(uvshear)
    for name in uvshear.__all__:
        assert getattr(uvshear, name) is not None
        assert name in listed
    assert len(set(uvshear.__all__)) == len(uvshear.__all__)
    assert {name for names in uvshear._HOMES.values() for name in names.split()} | {
        "__version__",
        "plot",
    } == set(uvshear.__all__)


def test_help_leads_to_every_public_name():
    assert uvshear.__doc__ is not None
    names = [name for name in uvshear.__all__ if name != "__version__"]
    assert [name for name in names if f"``{name}``" not in uvshear.__doc__] == []
    text = pydoc.plain(pydoc.render_doc(uvshear))
    assert [name for name in names if name not in text] == []
    for name in ("measure", "estimate_shear", "estimate_bias", "simulate", "read_measurement"):
        assert f"{name}(" in text


def test_names_that_type_checkers_see_are_the_public_ones():
    tree = ast.parse(inspect.getsource(uvshear))
    (block,) = (
        node
        for node in tree.body
        if isinstance(node, ast.If) and getattr(node.test, "id", "") == "TYPE_CHECKING"
    )
    places = {alias.name: node.module for node in block.body for alias in node.names if node.module}
    homes = {
        name: f"uvshear.{module}"
        for module, names in uvshear._HOMES.items()
        for name in names.split()
    }
    assert places == homes | {"plot": "uvshear"}


def test_a_name_that_is_not_there_is_told_as_usual():
    with pytest.raises(AttributeError, match="module 'uvshear' has no attribute 'measures'"):
        uvshear.measures  # noqa: B018


def test_importing_the_package_imports_nothing_heavy():
    check = "import sys, uvshear; assert not {'numpy', 'numba', 'astropy'} & set(sys.modules)"
    subprocess.run([sys.executable, "-c", check], check=True)


WRONG = {
    "model": ("model=uvshear.Exponential()", "a uvshear.Model is needed, not the type Exponential"),
    "method": ("method='paper'", "method='paper': a uvshear.Method is needed, not the type str"),
    "resources": ("resources=2", "resources=2: a uvshear.Resources is needed, not the type int"),
    "keep": (
        "keep='moment'",
        "'moment' is not a known estimator; the known names are mean, moments, bayesian, metacal",
    ),
    "an object in keep": ("keep=[3]", "3 is not an estimator of the shear"),
    "a number for keep": ("keep=3", "3 is not an estimator of the shear"),
    "dropped": (
        "keep='moments', method=uvshear.Method(extraction=uvshear.PaperExtraction())",
        "PaperExtraction keeps no statistics for estimators of the shear",
    ),
}


@pytest.mark.parametrize("case", WRONG)
def test_what_is_wrong_is_refused_before_anything_is_read(case, tmp_path):
    """In an interpreter without the type checks of the tests."""
    call, message = WRONG[case]
    program = (
        "import uvshear\n"
        f"try: uvshear.measure('absent.ms', 'absent.fits', {call})\n"
        "except uvshear.InputError as error: print(error)\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, check=True, text=True, cwd=tmp_path
    )
    assert message in done.stdout


@pytest.mark.parametrize(
    ("call", "message"),
    [
        ("measure(3, 'CAT.fits')", "int: an observation, or the path or paths of its files"),
        ("measure('FIELD.ms', 3)", "int: a Catalogue, an astropy Table, or the path of one"),
        ("estimate_shear(3)", "int: a Measurement, a table of shapes, or the path of one"),
        ("estimate_shear('SHAPES.fits', 'spin')", "'spin' is not a known estimator"),
        ("estimate_bias('spin', galaxies=100)", "'spin' is not a known estimator"),
    ],
)
def test_wrong_types_are_told_in_one_line(call, message, workplace):
    program = (
        f"import uvshear\ntry: uvshear.{call}\nexcept uvshear.InputError as error: print(error)\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, check=True, text=True, cwd=workplace
    )
    assert message in done.stdout
    assert done.stdout.count("\n") == 1


def test_keep_is_names_classes_or_objects(workplace):
    from uvshear.estimators.registry import estimators_of

    for keep in (
        "moments,likelihood",
        "moments, bayesian",
        ["moments", "bayesian"],
        (uvshear.Moments, uvshear.Bayesian()),
    ):
        assert [estimator.name for estimator in estimators_of(keep)] == ["moments", "bayesian"]
    for keep in (uvshear.Moments, uvshear.Moments(), "moments"):
        (only,) = estimators_of(keep)
        assert only == uvshear.Moments()
    statistics = uvshear.read_measurement(workplace / "SHAPES.fits").statistics
    for estimator in (uvshear.Moments, uvshear.Bayesian, uvshear.Metacal):
        assert set(estimator.columns) <= set(statistics.colnames)
