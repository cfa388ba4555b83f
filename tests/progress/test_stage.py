"""A stage as it is expected."""

from uvshear.progress import Stage


def test_the_work_of_a_stage_is_divided_equally_among_its_units():
    assert Stage("fits", cost=6e9, amount=3.0).unit_cost == 2e9


def test_where_cost_or_amount_is_not_known_units_count():
    assert Stage("fits", cost=6e9).unit_cost == Stage("fits", amount=3.0).unit_cost == 1.0
