"""Statistics beside a table of shapes."""

from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

import numpy as np
import pytest
from astropy.io import fits
from astropy.table import Table

from tests.estimators.test_evidence import Toy
from uvshear.errors import InputError
from uvshear.estimators.bayesian import Bayesian, likelihoods_of
from uvshear.estimators.estimator import Estimator
from uvshear.estimators.moments import Moments
from uvshear.estimators.packing import PACKED, pack
from uvshear.estimators.sample import Sample
from uvshear.io.statistics import (
    missing_statistics,
    read_statistics,
    statistics_path,
    statistics_table,
    write_statistics,
)
from uvshear.shapes.source_facet import Column

SHAPES = Table({"id": ["a", "b", "c"]})


@dataclass(frozen=True)
class Own(Estimator):
    """Keeps a number and an array."""

    name = "own"
    columns: ClassVar = {
        "height": Column("height of the peak", "Jy"),
        "ladder": Column("values at some scales"),
    }

    def terms(self, sample, about):
        raise NotImplementedError


def test_the_file_lies_beside_the_shapes() -> None:
    assert statistics_path(Path("field/shapes.fits")) == Path("field/shapes.stats.fits")
    assert statistics_path(Path("field/shapes.ecsv")) == Path("field/shapes.ecsv.stats.fits")


def test_columns_have_units_and_descriptions_and_gaps() -> None:
    kept = {0: {"height": 1.5, "ladder": np.arange(3.0)}, 2: {"height": -2.0, "ladder": np.ones(2)}}
    table = statistics_table(SHAPES, [Own(), Moments()], kept)
    assert table.meta["estimators"] == "own,moments"
    assert table["height"].unit == "Jy"
    assert table["ladder"].description == "values at some scales"
    np.testing.assert_array_equal(table["height"], [1.5, np.nan, -2.0])
    assert [len(ladder) for ladder in table["ladder"]] == [3, 0, 2]
    assert np.isnan(table["m1"]).all()
    names = ["id", "flag_own", "height", "ladder", "flag_moments", *Moments.columns]
    assert table.colnames == names


def test_each_source_has_the_reason_why_it_has_no_statistic(tmp_path: Path) -> None:
    told = {"height": 1.5, "ladder": np.ones(2), "flag_own": "ok", "flag_moments": "too_large"}
    # an extraction that is not this package's own need not tell flags
    untold = {"m1": 1.0}
    table = statistics_table(SHAPES, [Own(), Moments()], {0: told, 2: untold})
    path = _written(tmp_path / "shapes.stats.fits", table)
    back = read_statistics(path, tmp_path / "shapes.fits", SHAPES)
    for known in (table, back):
        assert list(known["flag_own"]) == ["ok", "not_measured", "not_fitted"]
        assert list(known["flag_moments"]) == ["too_large", "not_measured", "ok"]
    assert missing_statistics(table, "own") == {"not_fitted": 1}
    assert missing_statistics(table, "moments") == {"too_large": 1}
    assert missing_statistics(Table({"id": ["a"]}), "moments") == {}


def _written(path: Path, table: Table) -> Path:
    write_statistics(path, table, {"command": "uvshear measure"})
    return path


def test_what_is_written_is_read(tmp_path: Path) -> None:
    kept = {0: {"height": 1.5, "ladder": np.arange(3.0)}}
    table = statistics_table(SHAPES, [Own()], kept)
    path = _written(tmp_path / "shapes.stats.fits", table)
    back = read_statistics(path, tmp_path / "shapes.fits", SHAPES)
    assert back.meta["estimators"] == "own"
    assert back.meta["command"] == "uvshear measure"
    np.testing.assert_array_equal(back["height"].filled(np.nan), [1.5, np.nan, np.nan])
    np.testing.assert_array_equal(back["ladder"][0], [0, 1, 2])
    assert back["height"].description == "height of the peak"
    assert "command" not in table.meta


def test_likelihoods_survive_a_file(tmp_path: Path) -> None:
    packed = pack(Toy(0.3 - 0.2j, 0.25).on_lattice())
    table = statistics_table(SHAPES, [Bayesian()], {1: packed})
    path = _written(tmp_path / "shapes.stats.fits", table)
    back = read_statistics(path, tmp_path / "shapes.fits", SHAPES)
    sample = Sample({name: np.asarray(back[name]) for name in PACKED}, np.zeros(3))
    found = likelihoods_of(sample)
    assert [likelihood is None for likelihood in found] == [True, False, True]
    ours = likelihoods_of(Sample.from_rows([packed]))[0]
    np.testing.assert_array_equal(found[1].point, ours.point)
    np.testing.assert_allclose(found[1].log_likelihood, ours.log_likelihood)
    np.testing.assert_allclose(found[1].flux, ours.flux)


def test_arrays_of_one_length_stay_arrays(tmp_path: Path) -> None:
    kept = {k: {"height": 1.0, "ladder": np.full(3, float(k))} for k in range(3)}
    path = _written(tmp_path / "s.stats.fits", statistics_table(SHAPES, [Own()], kept))
    back = read_statistics(path, tmp_path / "s.fits", SHAPES)
    np.testing.assert_array_equal(np.stack(list(back["ladder"])), [[0] * 3, [1] * 3, [2] * 3])


@pytest.mark.parametrize(
    ("shapes", "message"),
    [
        (Table({"id": ["a", "d"]}), "has no source d, which .*shapes.fits has; measure again"),
        (Table({"id": ["a", "a"]}), "has sources of the same id"),
        (Table({"id": ["a", "b", "c"]}, meta={"RUN": "1"}), "belongs to another measurement than"),
        (Table({"name": ["a", "b", "c"]}), "shapes.fits: has no column 'id'"),
    ],
)
def test_statistics_of_other_shapes_are_refused(
    tmp_path: Path, shapes: Table, message: str
) -> None:
    path = _written(tmp_path / "shapes.stats.fits", statistics_table(SHAPES, [Moments()], {}))
    with pytest.raises(InputError, match=message):
        read_statistics(path, tmp_path / "shapes.fits", shapes)


@pytest.mark.parametrize("ids", [["b"], ["c", "a"], ["c", "b", "a"]])
def test_shapes_that_were_selected_or_sorted_find_their_statistics(
    tmp_path: Path, ids: list[str]
) -> None:
    kept = {k: {"height": float(k)} for k in range(3)}
    path = _written(tmp_path / "s.stats.fits", statistics_table(SHAPES, [Own()], kept))
    back = read_statistics(path, tmp_path / "s.fits", Table({"id": ids}))
    assert back["id"].tolist() == ids
    assert back["height"].tolist() == ["abc".index(name) for name in ids]


def test_a_number_that_was_changed_is_refused_with_its_source(tmp_path: Path) -> None:
    kept = {k: {"height": float(k)} for k in range(3)}
    path = _written(tmp_path / "s.stats.fits", statistics_table(SHAPES, [Own()], kept))
    with fits.open(path, mode="update") as file:
        file[1].data["height"][1] = 1.0000001
    with pytest.raises(InputError, match=r"the numbers of 1 of 3 sources \(the first is b\) are"):
        read_statistics(path, tmp_path / "s.fits", Table({"id": ["a"]}))


def test_identifiers_are_compared_as_text(tmp_path: Path) -> None:
    """FITS pads text, and numbers may come back as another type."""
    shapes = Table({"id": np.array([1, 2, 30])})
    path = _written(tmp_path / "s.stats.fits", statistics_table(shapes, [Moments()], {}))
    padded = Table({"id": ["1 ", "2 ", "30"]})
    assert len(read_statistics(path, tmp_path / "s.fits", padded)) == 3


@pytest.mark.parametrize(
    ("identifier", "message"),
    [
        (np.array([b"a", b"\xff\xfe", b"c"]), "column 'id': has letters beyond ASCII"),
        (np.ones((3, 2)), "column 'id' holds arrays; one identifier for each row is needed"),
        (np.full((3, 2), "a"), "column 'id': holds no words"),
    ],
)
def test_identifiers_that_are_none_are_refused_with_the_name_of_the_file(
    tmp_path: Path, identifier: np.ndarray, message: str
) -> None:
    statistics = Table({"id": identifier, "m1": np.zeros(3)})
    statistics.write(tmp_path / "s.stats.fits")
    with pytest.raises(InputError, match=rf"s\.stats\.fits: {message}"):
        read_statistics(tmp_path / "s.stats.fits", tmp_path / "s.fits", SHAPES)
