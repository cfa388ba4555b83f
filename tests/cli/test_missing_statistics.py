"""The line about statistics that were to be kept and are missing."""

from dataclasses import dataclass

from astropy.table import Table

from uvshear.cli.missing_statistics import tell_missing_statistics


@dataclass
class Kept:
    """The parts of a measurement that are told of."""

    statistics: Table | None
    estimators: tuple[str, ...] = ("moments", "metacal")


def test_what_is_missing_is_counted_by_reason(capsys):
    table = Table(
        {
            "flag_moments": ["ok", "ok", "not_measured", "ok", "ok"],
            "flag_metacal": ["ok", "too_large", "not_measured", "not_fitted", "too_large"],
        }
    )
    tell_missing_statistics(Kept(table))
    expected = "no statistics of metacal for 3 sources: 2 too_large, 1 not_fitted\n"
    assert capsys.readouterr().out == expected


def test_nothing_is_told_where_nothing_was_to_be_kept(capsys):
    tell_missing_statistics(Kept(None, ()))
    assert capsys.readouterr().out == ""
