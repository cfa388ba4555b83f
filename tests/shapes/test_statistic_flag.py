from uvshear.shapes.statistic_flag import StatisticFlag, flag_column


def test_words_are_those_of_the_documentation():
    words = ["ok", "not_measured", "no_data", "too_large", "not_fitted"]
    assert [flag.word for flag in StatisticFlag] == words
    assert all(flag.value[0].islower() and not flag.value.endswith(".") for flag in StatisticFlag)


def test_each_estimator_has_a_column_of_its_own():
    assert flag_column("moments") == "flag_moments"
