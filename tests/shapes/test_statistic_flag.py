from pathlib import Path

from uvshear.shapes.statistic_flag import StatisticFlag, flag_column

DOCS = Path(__file__).parents[2] / "docs"


def test_words_are_those_of_the_documentation():
    text = (DOCS / "files.md").read_text()
    for flag in StatisticFlag:
        assert f"| `{flag.word}` |" in text or flag is StatisticFlag.OK
    assert all(flag.value[0].islower() and not flag.value.endswith(".") for flag in StatisticFlag)


def test_each_estimator_has_a_column_of_its_own():
    assert flag_column("moments") == "flag_moments"
