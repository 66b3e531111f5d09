"""Fits and runs that were kept: the same to the last bit, found by all that they came from and by nothing less."""

import dataclasses

import numpy as np
import pytest
from test_fitting import BLOCK, DECLARED, DRAG, campaign, model

from studies.loop.fits.fitting import fit
from studies.loop.observed.windows import record_of, swing_windows
from studies.loop.outcomes.runs import falls_of
from studies.loop.runs.keeping import Keeper, digest_of
from studies.loop.runs.simulation import Simulator
from studies.loop.swings.trials import E


@pytest.fixture(scope="module")
def tests():
    return campaign()


@pytest.fixture(scope="module")
def windows(tests):
    records = [record_of(test, k, 2e-4, DECLARED.alpha) for k, test in enumerate(tests)]
    return swing_windows([r for r in records if r is not None])


class Silent(Simulator):
    """One that cannot run anything."""

    def run(self, models, jobs):
        raise AssertionError("it was run again")


def same(one, other):
    """Whether two fits agree in every bit."""
    plain = [
        (dataclasses.replace(f, model=None, parameters=(), windows=()), f.model, f.values, f.windows)
        for f in (one, other)
    ]
    return digest_of(plain[0]) == digest_of(plain[1])


def test_a_fit_that_was_kept_is_the_fit_and_nothing_is_run(tests, windows, tmp_path):
    plain, keeping, silent = Simulator(tests), Simulator(tests, keeper=Keeper(tmp_path)), Silent(tests)
    silent.keeper = keeping.keeper
    once, kept, again = (fit(s, model(0.0), [E, DRAG], windows, iterations=2) for s in (plain, keeping, silent))
    assert same(once, kept) and same(kept, again)
    # The states alone, of what came out: numbers that were read are the numbers that were found.
    after = [fit(s, f.model, [], f.windows[:2], iterations=2) for s, f in ((keeping, kept), (silent, again))]
    assert same(*after)


def test_another_start_record_option_or_window_is_another_fit(tests, windows, tmp_path):
    fit(Simulator(tests, keeper=Keeper(tmp_path)), model(0.1), [DRAG], windows[:6], iterations=1)
    moved = [windows[0].moved(windows[0].theta + 1e-12, windows[0].omega), *windows[1:6]]
    noisier = [dataclasses.replace(tests[0], time=tests[0].time + 1e-9), *tests[1:]]
    for others, start, parameters, cut, iterations in (
        (tests, model(0.1 + 1e-12), [DRAG], windows[:6], 1),
        (tests, model(0.1), [E, DRAG], windows[:6], 1),
        (tests, model(0.1), [DRAG], windows[:5], 1),
        (tests, model(0.1), [DRAG], moved, 1),
        (tests, model(0.1), [DRAG], windows[:6], 2),
        (noisier, model(0.1), [DRAG], windows[:6], 1),
    ):
        with pytest.raises(AssertionError, match="run again"):
            fit(Silent(others, keeper=Keeper(tmp_path)), start, parameters, cut, iterations=iterations)


def test_a_damaged_file_is_done_again(tests, windows, tmp_path):
    first = fit(Simulator(tests, keeper=Keeper(tmp_path)), model(0.1), [DRAG], windows[:6], iterations=1)
    [path] = tmp_path.rglob("*.npz")
    for content in (b"", path.read_bytes()[:200], b"PK\x03\x04 something else"):
        path.write_bytes(content)
        assert same(
            first, fit(Simulator(tests, keeper=Keeper(tmp_path)), model(0.1), [DRAG], windows[:6], iterations=1)
        )
    Keeper(tmp_path).clear()
    assert list(tmp_path.iterdir()) == []


def test_falls_are_kept_likewise(tests, tmp_path):
    models = [model(0.1, e) for e in (0.5, 0.9)]
    fell = falls_of(Simulator(tests, keeper=Keeper(tmp_path)), models)
    assert np.array_equal(falls_of(Silent(tests, keeper=Keeper(tmp_path)), models), fell)
    with pytest.raises(AssertionError, match="run again"):
        falls_of(Silent(tests, keeper=Keeper(tmp_path)), models[:1])


def test_what_has_no_digest_is_refused():
    assert digest_of(1.0) != digest_of(1) and digest_of([1, 2], 3) != digest_of([1], 2, 3)
    assert digest_of({"a": np.zeros(2)}) != digest_of({"a": np.zeros((2, 1))})
    with pytest.raises(TypeError, match="want numbers, texts, arrays"):
        digest_of(lambda: BLOCK)
