"""Places for states, and the one that keeps nothing."""

from uvshear.extraction.state_store import NO_STORE, Results


def test_results_are_found_by_their_keys():
    results: Results[float] = Results()
    results.add(3, 0.5)
    assert 3 in results
    assert 4 not in results
    assert results[3] == 0.5


def test_a_store_that_keeps_nothing_gives_nothing_back():
    inner = NO_STORE.part("inner")
    inner.save("state", 1)
    inner.results("found").add(1, 2)
    assert inner.load("state") is None
    assert 1 not in inner.results("found")
    assert not inner.is_due
