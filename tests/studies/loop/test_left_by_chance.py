"""What a round of the search refits on top of what leaves no more of swings than chance does; fits are stubs."""

from types import SimpleNamespace

import pytest

from studies.loop.swings import tracing
from studies.loop.swings.tracing import NOTHING_OF_SOME, search

SCORES = {"a": 5.5, "b": 4.0, "c": 3.0, "d": 2.0, "e": 1.0}
ON_SOME = {"slack": 2.9, "slides": 3.1}


@pytest.fixture
def refitted(monkeypatch):
    """Names of those that are fitted to all windows."""
    names = list[str]()
    monkeypatch.setattr(tracing, "_scores", lambda *_, **__: dict(scores))
    monkeypatch.setattr(tracing, "on_some", lambda s, onto, c: SimpleNamespace(gained=ON_SOME.get(c.name, 0.0)))
    monkeypatch.setattr(tracing, "on_all", lambda s, onto, c, first: names.append(c.name))
    monkeypatch.setattr(tracing, "to_the_end", lambda *_: [])
    scores = dict(SCORES)
    return SimpleNamespace(names=names, scores=scores)


def searched(by_chance):
    fixed = {"in_swings": True, "costly": False, "slips": False, "after": ""}
    pool = [SimpleNamespace(name=name, effect=name, smooth=name in SCORES, **fixed) for name in (*SCORES, *ON_SOME)]
    return search(None, SimpleNamespace(effects=(), costly=False), pool, by_chance=by_chance)


def test_the_first_few_are_refitted_and_what_explains_something_of_some_swings(refitted):
    found = searched(by_chance=True)
    assert refitted.names == ["a", "b", "c", "slides"]
    assert found.skipped == {"d": "score 2", "e": "score 1", "slack": NOTHING_OF_SOME}


def test_all_that_may_pay_or_be_hinted_at_is_refitted(refitted):
    """A hint lowers the criterion by 6, that is chi-square by more."""
    refitted.scores |= {"d": 6.5, "e": 5.9}
    found = searched(by_chance=True)
    assert refitted.names == ["a", "d", "e", "slides"]
    assert sorted(found.skipped) == ["b", "c", "slack"]


def test_everything_is_refitted_where_more_is_left(refitted):
    found = searched(by_chance=False)
    assert refitted.names == [*SCORES, *ON_SOME]
    assert not found.skipped
