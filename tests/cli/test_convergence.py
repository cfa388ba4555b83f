"""The convergence of a sky model in words."""

import pytest

from uvshear.cli.convergence import tell_convergence

RECORD = {"major_cycles": 4, "left_undone": 0.05, "left_undone_most": 0.2, "tolerance": 0.1}


def test_a_converged_sky_is_told_without_a_note(capsys):
    tell_convergence(RECORD)
    told = capsys.readouterr()
    assert told.out.startswith(
        "4 major cycles; one more would change the model of a source by 0.05"
    )
    assert told.err == ""


@pytest.mark.parametrize(
    ("change", "note"),
    [({"left_undone": 0.3}, "has not converged"), ({"released": [2.0, 0.7]}, "shears")],
)
def test_a_sky_that_still_moves_has_a_note(capsys, change, note):
    tell_convergence(RECORD | change)
    assert note in capsys.readouterr().err


def test_an_extraction_without_iterations_has_nothing_to_tell(capsys):
    tell_convergence({"extraction": "paper"})
    assert capsys.readouterr().out == ""
