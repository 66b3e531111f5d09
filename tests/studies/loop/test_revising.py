"""What a greedy search accepted is looked at again: stand-ins give way, what is needless goes, twins are named.

Campaigns are of the laboratory, which shares no code with the models; what was planted is a number of its world.
"""

import math
from dataclasses import replace
from functools import cache
from types import SimpleNamespace
from typing import Any

import found
import numpy as np
import pytest

from studies.campaigns import Campaign, Channel, Conditions, DeclaredBlock, Test
from studies.laboratory import event, table
from studies.laboratory.parameters import G, World, uniform
from studies.loop import closing, finding_file
from studies.loop.dataset import candidates
from studies.loop.finding_file import as_json
from studies.loop.fits.fitting import fit
from studies.loop.models.candidates import Candidate
from studies.loop.models.model import LoopModel
from studies.loop.records.preparing import Setup, prepare
from studies.loop.report import page
from studies.loop.search import revising
from studies.loop.search.revising import Revision, revised, taken_out, without_needless
from studies.loop.swings.learning import profiles, terms
from studies.loop.swings.tracing import all_candidates, baseline, search
from studies.loop.swings.trials import Round, Trial, bic
from studies.loop.whole import rivals as rivals_module
from studies.loop.whole.rivals import Rival, near_all, twins
from studies.loop.whole.whole_fits import whole_fit

BREADTH, HEIGHT, MASS, E, NOISE, STEP = 0.2, 0.6, 30.0, 0.93, 1e-4, 0.004
DECLARED = DeclaredBlock(BREADTH, HEIGHT, 0.25, MASS)
IDEAL = uniform(BREADTH, HEIGHT, MASS, E)
LEANS = (0.26, -0.24, 0.21, -0.18, 0.15, -0.12)  # rad


@cache
def planted(*changes: tuple[str, float]) -> tuple[Setup, Trial]:
    """Six releases in a laboratory whose world is changed, and the calibrated block."""
    rng, tests, world = np.random.default_rng(1), [], replace(IDEAL, **dict(changes))
    assert isinstance(world, World)
    zero = np.zeros(1501)
    for k, lean in enumerate(LEANS):
        run = event.simulate(world, table.pieces(STEP, zero, zero, (zero, zero, zero)), STEP, 1, lean)
        read = run.rotation + NOISE * rng.standard_normal(run.rotation.size)
        channel = Channel("rotation", "rotation", NOISE)
        tests.append(Test(f"free-{k}", "free", run.time, (channel,), {"rotation": read}, initial_rotation=lean))
    campaign = Campaign("decays", DECLARED, Conditions(restitution=E), (channel,), tuple(tests))
    setup = prepare(campaign, LoopModel(DECLARED, E, {}, G))
    return setup, baseline(setup.simulator, setup.start, setup.swings)


def tried(setup: Setup, onto: Trial, *effects: str) -> Round:
    pool = [c for c in all_candidates(onto.swing.model) if c.effect in effects]
    return search(setup.simulator, onto, pool)


def on_top(setup: Setup, onto: Trial, *effects: str) -> tuple[Round, Trial]:
    """A round with these effects, as if the first one named had won it."""
    tries = tried(setup, onto, *effects)
    return tries, next(t for t in tries.trials if t.effects[-1] == effects[0])


def quiet(text: str) -> None:
    """Nobody listens."""


@pytest.mark.parametrize(
    "names",
    [
        pytest.param(("learned[friction]", "learned[damping]"), marks=pytest.mark.slow),
        pytest.param(
            ("learned[curve alike on both sides, near upright]", "learned[curve by side, near upright]"),
            marks=pytest.mark.slow,
        ),
        ("restitution_drift", "learned[drag]"),
    ],
)
def test_of_an_effect_that_two_parts_share_the_other_one_stays(names: tuple[str, str]) -> None:
    """What is left is what was never fitted with the part that is taken out."""
    setup, plain = planted(("quadratic", 0.05))
    declared, windows = plain.swing.model.declared, plain.swing.windows
    forms = {c.name: c for c in (*terms(declared), *profiles(declared, windows))}

    def on_top_of(onto: Trial, part: Candidate) -> Trial:
        start = onto.swing.model.changed(part.nothing(declared))
        parameters = (*onto.every, *part.parameters)
        return onto.with_(part, fit(setup.simulator, start, parameters, windows, iterations=3))

    one, other = (forms[name] for name in names)
    both = on_top_of(on_top_of(plain, one), other)
    for k, kept in enumerate((other, one)):
        left, alone = taken_out(setup, plain, both, k), on_top_of(plain, kept)
        assert left.names == (kept.name,)
        found, wanted = left.swing.model, alone.swing.model
        assert {e: {*v} for e, v in found.effects.items()} == {e: {*v} for e, v in wanted.effects.items()}
        assert (found.drift == 0.0) == (wanted.drift == 0.0)


def test_swings_do_not_stay_in_a_minimum_that_whole_records_have_left() -> None:
    """They had ended at six times the planted drag and with another restitution."""
    setup, plain = planted(("quadratic", 0.05))
    _, drag = on_top(setup, plain, "quadratic_drag")
    whole = whole_fit(setup, drag)
    assert closing._led(setup, drag, whole) is drag
    away = drag.swing.model.changed({"quadratic_drag.coefficient": 0.3, "restitution": 0.9})
    stuck = replace(drag, swing=fit(setup.simulator, away, [], drag.swing.windows, iterations=3))
    assert stuck.swing.chi2 > 2.0 * drag.swing.chi2
    found = closing._led(setup, stuck, whole)
    assert found.swing.chi2 == pytest.approx(drag.swing.chi2, abs=1.0)
    assert found.swing.model.get("quadratic_drag.coefficient") == pytest.approx(0.05, rel=0.05)


def test_an_effect_that_stood_for_another_one_is_left_out() -> None:
    """Drag was planted alone; damping, accepted first, stands for some of it and is not needed beside it."""
    setup, plain = planted(("quadratic", 0.05))
    first, stand_in = on_top(setup, plain, "viscous_damping", "quadratic_drag")
    second, both = on_top(setup, stand_in, "quadratic_drag")
    made = revised(setup, plain, both, whole_fit(setup, both), [first, second], quiet)
    assert made.trial.effects == ("quadratic_drag",)
    assert made.said == ("Viscous damping was accepted at first, and is not needed beside the others",)
    assert [r.onto.effects for r in made.rounds] == [()]
    assert bic(made.trial.swing) == pytest.approx(min(bic(t.swing) for t in first.trials), abs=1.0)


def test_what_took_the_place_of_a_twin_goes_if_it_is_not_needed() -> None:
    setup, plain = planted(("quadratic", 0.05))
    first, stand_in = on_top(setup, plain, "viscous_damping", "quadratic_drag")
    second, both = on_top(setup, stand_in, "quadratic_drag")
    stands = Revision(both, whole_fit(setup, both), (), ("before",))
    made = without_needless(setup, plain, stands, [first, second], quiet)
    assert made is not None and made.trial.effects == ("quadratic_drag",)
    assert made.said == ("before", "Viscous damping is not needed beside the others")
    [again] = made.rounds  # what came near it in the first round was tried in its place
    assert again.onto is plain and {t.effects for t in again.trials} == {("viscous_damping",), ("quadratic_drag",)}
    assert any(t is made.trial for t in again.trials)
    assert without_needless(setup, plain, made, [first, second], quiet) is None  # one effect alone


@pytest.mark.parametrize("there", [True, False])
def test_whole_records_of_less_are_looked_for_where_the_trial_that_stands_has_them(
    monkeypatch: pytest.MonkeyPatch, there: bool
) -> None:
    """A minimum that a needless effect led to is there without it too."""
    setup, plain = planted(("quadratic", 0.05))
    _, drag = on_top(setup, plain, "quadratic_drag")
    found = replace(drag.swing.model, effects={"quadratic_drag": {"coefficient": 0.07}, "tether": {"stiffness": 0.0}})
    asked = []

    def fitted(_: Setup, trial: Trial, weights: object) -> SimpleNamespace:
        asked.append(trial.swing.model)
        own = trial.swing.model is drag.swing.model
        return SimpleNamespace(chi2=2.0 if own is there else 1.0, weights=weights)

    monkeypatch.setattr(revising, "whole_fit", fitted)
    stands = SimpleNamespace(whole=SimpleNamespace(model=found))
    best = revising._whole_without(setup, drag, stands)  # type: ignore[arg-type]
    assert best.chi2 == 1.0 and best.weights is stands.whole  # type: ignore[attr-defined]
    assert [model.effects for model in asked] == [drag.swing.model.effects, {"quadratic_drag": {"coefficient": 0.07}}]


@pytest.mark.parametrize(("first", "many", "goes"), [(9.0, 9.0, False), (1.0, 9.0, True), (9.0, 1.0, True)])
def test_whole_records_refuse_to_let_an_effect_go_from_no_start(
    monkeypatch: pytest.MonkeyPatch, first: float, many: float, goes: bool
) -> None:
    both, alone = stub("a", "b", chi2=1000.0), stub("a", chi2=1010.0)
    monkeypatch.setattr(revising, "_whole_without", lambda setup, less, stands: first)
    monkeypatch.setattr(revising, "_whole_without_from_many", lambda setup, less, stands: many)
    monkeypatch.setattr(revising, "explains_more", lambda setup, one, other: one < other)
    stands = Revision(both, 5.0, ())  # type: ignore[arg-type]
    made = revising._dropped(SimpleNamespace(by_rotation=True), stands, [alone])  # type: ignore[arg-type]
    assert (made is not None and made.trial is alone) is goes


@pytest.mark.parametrize(("again", "kept"), [(30.0, "given"), (10.0, "again")])
def test_the_better_fit_of_whole_records_is_kept_of_the_trial_that_stands(
    monkeypatch: pytest.MonkeyPatch, again: float, kept: str
) -> None:
    """It may come from a start that is not tried with its rivals."""
    setup, plain = planted(("quadratic", 0.05))
    tries, drag = on_top(setup, plain, "quadratic_drag", "viscous_damping")

    def whole(name: str, chi2: float) -> SimpleNamespace:
        return SimpleNamespace(name=name, chi2=chi2, model=None, windows=(), parameters=(), samples=100)

    monkeypatch.setattr(rivals_module, "whole_fit", lambda setup, trial, weights: whole("again", again))
    monkeypatch.setattr(rivals_module, "errors", lambda setup, model, windows: SimpleNamespace(holdout=0.0))
    alone = replace(tries, trials=[drag, *(t for t in tries.trials if t is not drag)])
    found = near_all(setup, [alone], drag, whole("given", 20.0))  # type: ignore[arg-type]
    assert [r.whole.name for r in found if r.trial.effects == ("quadratic_drag",)] == [kept]  # type: ignore[attr-defined]
    assert all(r.whole.name == "again" for r in found if r.trial.effects != ("quadratic_drag",))  # type: ignore[attr-defined]


@pytest.mark.parametrize(
    ("explained", "near"),
    [
        (80.0, [0.0, 30.0, 50.0]),  # those that explain next to nothing are not near
        (20.0, [0.0, 30.0]),
        (5000.0, [0.0, 30.0, 50.0, 70.0, 390.0]),
    ],
)
def test_rivals_that_explain_next_to_nothing_are_not_near(monkeypatch: pytest.MonkeyPatch, explained, near) -> None:
    """By hand: how much worse than the best they are after the search, and what that one explains."""

    def trial(off: float) -> SimpleNamespace:
        swing = SimpleNamespace(chi2=off, parameters=(), samples=100, model=off, windows=())
        return SimpleNamespace(names=(str(off),), swing=swing, every=(), costly=False)

    monkeypatch.setattr(rivals_module, "fit", lambda simulator, model, *_, **how: trial(model).swing)
    monkeypatch.setattr(rivals_module, "replace", lambda trial, swing: trial)
    monkeypatch.setattr(rivals_module, "whole_fit", lambda setup, t, weights: t.swing)
    monkeypatch.setattr(rivals_module, "errors", lambda setup, model, windows: SimpleNamespace(holdout=0.0))
    best, *others = (trial(off) for off in (0.0, 30.0, 50.0, 70.0, 390.0, 410.0))
    tried = SimpleNamespace(onto=trial(explained), trials=[best, *others])
    setup: Any = SimpleNamespace(simulator=None)
    found = rivals_module.near(setup, tried, best, best.swing)  # type: ignore[arg-type]
    assert [r.trial.swing.chi2 for r in found] == near


def test_rivals_are_looked_for_again_where_the_best_one_has_something_needless(monkeypatch: pytest.MonkeyPatch) -> None:
    def rival(*names: str) -> SimpleNamespace:
        return SimpleNamespace(trial=SimpleNamespace(names=names, parts=names), whole=f"whole of {names}")

    pair, twin, alone = rival("gain", "mass"), rival("mass", "drag"), rival("mass")
    named = Revision(pair.trial, "", ("of the pair",), ("said",))  # type: ignore[arg-type]
    shorter = Revision(alone.trial, alone.whole, ("of the mass",))  # type: ignore[arg-type]
    best = {("of the pair",): (twin, pair), ("of the mass",): (alone,)}
    monkeypatch.setattr(closing, "near_all", lambda setup, tried, trial, whole: best[tried])
    monkeypatch.setattr(closing, "_borne_out", lambda setup, near, trial, whole: near)
    asked, needless = [], [shorter, None]

    def without(setup: object, plain: object, stands: Revision, tried: object, tell: object) -> Revision | None:
        asked.append((stands.trial.names, stands.whole, stands.said))
        return needless.pop(0)

    monkeypatch.setattr(closing, "without_needless", without)

    def compared() -> tuple[Revision, tuple[Rival, ...]]:
        return closing._compared(None, None, named, [], quiet)  # type: ignore[arg-type]

    assert compared() == (shorter, (alone,))
    # One that needs all of its effects stands, as a rival of what was named; one that is what was named is not asked.
    assert compared() == (named, (twin, pair))
    assert asked == [(("mass", "drag"), twin.whole, ("said",))] * 2
    best[("of the pair",)] = (pair, twin)
    assert compared() == (named, (pair, twin)) and len(asked) == 2
    # What would be no shorter ends it.
    best[("of the pair",)], needless[:] = (twin, pair), [Revision(pair.trial, "", ())]  # type: ignore[arg-type]
    assert compared() == (named, (twin, pair))


def test_what_whole_records_brought_in_may_be_all_that_is_needed(monkeypatch: pytest.MonkeyPatch) -> None:
    """A gain of the base, found by whole records on top of a mass that swings had taken for it."""
    named, alone, rivals = Revision("both", "", ()), Revision("gain", "", ()), ("of both",)  # type: ignore[arg-type]
    answers = [alone, None]
    monkeypatch.setattr(closing, "without_needless", lambda *given: answers.pop(0))

    def asked() -> tuple[Revision, tuple[Rival, ...]]:
        return closing._all_needed(None, None, named, rivals, [], quiet)  # type: ignore[arg-type]

    assert asked() == (alone, ())
    assert asked() == (named, rivals)


def test_what_the_search_said_goes_with_what_it_took() -> None:
    path = SimpleNamespace(last=SimpleNamespace(names=("a", "b")), said=("of a with b",))
    assert closing._of_the_search(path, SimpleNamespace(names=("b", "a"))) == ("of a with b",)  # type: ignore[arg-type]
    assert closing._of_the_search(path, SimpleNamespace(names=("a",))) == ()  # type: ignore[arg-type]


@pytest.mark.slow
def test_a_stand_in_that_was_accepted_first_gives_way() -> None:
    """Rounded edges of 4 mm and drag were planted; a concave base, accepted first, comes near the edges."""
    setup, plain = planted(("radius", 0.004), ("quadratic", 0.05))
    first, stand_in = on_top(setup, plain, "concave_base", "rounded_edges", "viscous_damping")
    second, both = on_top(setup, stand_in, "quadratic_drag", "viscous_damping")
    made = revised(setup, plain, both, whole_fit(setup, both), [first, second], quiet)
    assert set(made.trial.effects) == {"rounded_edges", "quadratic_drag"}
    assert made.trial.swing.model.get("rounded_edges.radius") == pytest.approx(0.004, rel=0.05)
    assert "Concave base was accepted at first; beside the others Rounded edges explains more instead" in made.said
    assert bic(made.trial.swing) < bic(both.swing) - 60.0
    # Of each effect: what was tried beside the other one.
    assert [len(r.onto.parts) for r in made.rounds] == [1, 1]
    assert {r.onto.effects[0] for r in made.rounds} == {"rounded_edges", "quadratic_drag"}


@pytest.mark.slow
def test_an_effect_of_an_earlier_round_has_its_twin_named() -> None:
    """A floor that leans a little turns the block as a mass off the middle does; larger, it can be told apart."""
    setup, plain = planted(("tilt", 0.0003), ("quadratic", 0.05))
    first, tilt = on_top(setup, plain, "base_tilt", "eccentric_mass")
    second, both = on_top(setup, tilt, "quadratic_drag", "viscous_damping")
    whole = whole_fit(setup, both)
    made = revised(setup, plain, both, whole, [first, second], quiet)
    rivals = near_all(setup, made.rounds, made.trial, made.whole)
    assert {frozenset(r.trial.effects) for r in rivals[:2]} == {
        frozenset({"base_tilt", "quadratic_drag"}),
        frozenset({"eccentric_mass", "quadratic_drag"}),
    }
    [pair] = twins(rivals)
    assert set(pair) == {"base_tilt", "eccentric_mass"}


def test_one_effect_is_left_as_it_was() -> None:
    setup, plain = planted(("quadratic", 0.05))
    first, drag = on_top(setup, plain, "quadratic_drag", "viscous_damping")
    made = revised(setup, plain, drag, whole_fit(setup, drag), [first], quiet)
    assert made.trial is drag and made.rounds == (first,) and made.said == ()


@pytest.mark.slow
def test_two_effects_are_found_though_all_whole_records_are_lost_with_one() -> None:
    """A tilt of 6 mrad and a drag of 0.4 in five tests: with either alone no record is followed to its end."""
    finding = found.both()
    assert finding.verdict == "effect"
    assert set(finding.chosen.effects) == {"base_tilt", "quadratic_drag"}
    for name, truth in (("base_tilt.angle", found.TILT), ("quadratic_drag.coefficient", found.DRAG)):
        value, low, high = finding.intervals[name]
        assert low < truth < high
        assert value == pytest.approx(truth, rel=0.01)
    # The twin of the tilt may have been accepted before it; it is named.
    [twins_of_it] = finding.indistinguishable
    assert set(twins_of_it) == {"base_tilt", "eccentric_mass"}
    # Of each effect what was tried in its place is kept, and the tables have it.
    assert {r.onto.effects[0] for r in finding.deciding} in (
        {"base_tilt", "quadratic_drag"},
        {"eccentric_mass", "quadratic_drag"},
    )
    rows = {(row["effect"], *row["beside"]) for row in as_json(finding, "")["candidates"]}
    assert {("eccentric_mass", "quadratic_drag"), ("base_tilt", "quadratic_drag")} <= rows
    table = candidates(finding)
    assert table.sizes["round"] == len(finding.every_round) > len(finding.rounds)
    assert float(table.holdout_error.max()) < 1e-3


def stub(*names: str, chi2: float) -> Trial:
    parts = tuple(SimpleNamespace(name=n, effect=n, in_swings=True, costly=False) for n in names)
    swing = SimpleNamespace(chi2=chi2, parameters=names, samples=1000, windows=())
    return SimpleNamespace(  # type: ignore[return-value]
        names=names, effects=names, parts=parts, swing=swing, costly=False, score=math.nan
    )  # fmt: skip


def test_what_whole_records_refuse_neither_goes_nor_comes(monkeypatch: pytest.MonkeyPatch) -> None:
    """Swings would do without the lag and prefer drag to damping; whole records are explained far less so."""
    plain, lag = stub(chi2=5000.0), stub("lag", chi2=4000.0)
    both = stub("lag", "damping", chi2=1000.0)
    first, second = Round(plain, [lag]), Round(lag, [both, stub("lag", "drag", chi2=900.0)])
    alone = {"lag": stub("damping", chi2=1010.0), "damping": stub("lag", chi2=4000.0)}
    monkeypatch.setattr(revising, "taken_out", lambda s, p, trial, k: alone[trial.names[k]])
    monkeypatch.setattr(revising, "search", lambda s, onto, pool, tell: Round(onto, []))
    monkeypatch.setattr(revising, "whole_fit", lambda setup, trial, whole: trial.names)
    for name in ("_whole_without", "_whole_without_from_many"):
        monkeypatch.setattr(revising, name, lambda setup, less, stands: less.names)
    monkeypatch.setattr(revising, "explains_more", lambda setup, one, other: True)

    made = revised(SimpleNamespace(simulator=None, by_rotation=True), plain, both, both.names, [first, second], quiet)  # type: ignore[arg-type]
    assert made.trial is both and made.said == ()
    # What they refuse is no rival either, and keeps what it explained.
    assert [t.names for r in made.rounds for t in r.trials] == [both.names, both.names]
    assert [t.names for t in made.rounds[1].refused] == [("lag", "drag")]
    # The first round is that of the search and says so too, in every table.
    finding = SimpleNamespace(rounds=(first, second), deciding=made.rounds, rivals=(), units="rad")
    finding.every_round = closing.Finding.every_round.fget(finding)  # type: ignore[attr-defined]
    assert [r.onto for r in finding.every_round] == [plain, lag, alone["lag"]]
    [*kept, last] = finding_file._candidates(finding)  # type: ignore[arg-type]
    assert last["form"] == "drag" and last["evidence"] == 3100.0 and last["refused"] == finding_file.REFUSED
    assert not any("refused" in row for row in kept)
    table = candidates(finding)  # type: ignore[arg-type]
    assert table.refused.sel(form="drag").values.tolist() == [False, True, False]
    assert table.evidence.sel(form="drag").values[1] == 3100.0
    rows = [row for r in page._rounds(finding) for row in r["rows"] if row["form"] == "drag"]  # type: ignore[arg-type]
    assert [row["why"] for row in rows] == [finding_file.REFUSED]
    # A round that was gone through again with a few of its candidates keeps the others.
    once = Round(plain, [lag, stub("drag", chi2=4500.0), stub("tilt", chi2=4900.0)], {"mass": "score 1"})
    twice = Round(plain, [stub("lag", chi2=3990.0)], refused=(stub("drag", chi2=4400.0),))
    [merged] = closing.Finding.every_round.fget(SimpleNamespace(rounds=(once,), deciding=(twice,)))  # type: ignore[attr-defined]
    assert {t.names[0]: (t.swing.chi2, gone) for t, gone in merged.tried} == {
        "lag": (3990.0, False), "tilt": (4900.0, False), "drag": (4400.0, True),
    }  # fmt: skip
    assert merged.skipped == {"mass": "score 1"}
    # Accelerometers do not ask them.
    blind = SimpleNamespace(simulator=None, by_rotation=False)
    assert revised(blind, plain, both, both.names, [first, second], quiet).trial.names == ("damping",)  # type: ignore[arg-type]


def test_a_floor_that_was_put_off_does_not_come_in_without_whole_records(monkeypatch: pytest.MonkeyPatch) -> None:
    plain, lag = stub(chi2=5000.0), stub("lag", chi2=4000.0)
    both, floor = stub("lag", "damping", chi2=1000.0), stub("lag", "floor", chi2=900.0)
    floor.costly = True  # type: ignore[misc]
    monkeypatch.setattr(revising, "taken_out", lambda s, p, trial, k: stub(trial.names[1 - k], chi2=4000.0))
    monkeypatch.setattr(revising, "search", lambda s, onto, pool, tell: Round(onto, []))
    rounds = [Round(plain, [lag]), Round(lag, [both, floor])]
    made = revised(SimpleNamespace(simulator=None, by_rotation=True), plain, both, both.names, rounds, quiet)  # type: ignore[arg-type]
    assert made.trial is both and floor in made.rounds[1].trials


def test_one_effect_that_is_left_stays(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of a pair one is needed, another is better in its place, and without that one little more would be missed."""
    plain, first, both = stub(chi2=1075.0), stub("a", chi2=1070.0), stub("a", "b", chi2=1000.0)
    alone, better = stub("b", chi2=1055.0), stub("c", chi2=1030.0)

    def without(setup: object, block: Trial, trial: Trial, k: int) -> Trial:
        left = trial.names[1 - k] if len(trial.names) > 1 else ""
        return {"a": first, "b": alone, "": plain}[left]

    monkeypatch.setattr(revising, "taken_out", without)
    monkeypatch.setattr(revising, "search", lambda s, onto, pool, tell: Round(onto, [better]))
    monkeypatch.setattr(revising, "whole_fit", lambda setup, trial, whole: trial.names)
    for name in ("_whole_without", "_whole_without_from_many"):
        monkeypatch.setattr(revising, name, lambda setup, less, stands: less.names)
    rounds = [Round(plain, [first, alone]), Round(first, [both])]
    made = revised(SimpleNamespace(simulator=None, by_rotation=False), plain, both, both.names, rounds, quiet)  # type: ignore[arg-type]
    assert made.trial is better and len(made.said) == 2
    assert [r.onto.names for r in made.rounds] == [()]


def test_another_form_of_an_effect_may_take_its_place() -> None:
    pitch, drag = (SimpleNamespace(name=n, effect=e) for n, e in (("pitch[a]", "pitch"), ("drag", "drag")))
    trial = SimpleNamespace(parts=(pitch, drag))

    def tried(name: str, effect: str, chi2: float) -> SimpleNamespace:
        part = SimpleNamespace(name=name, effect=effect, in_swings=True, costly=False)
        return SimpleNamespace(parts=(part,), swing=SimpleNamespace(chi2=chi2, parameters=(), samples=100))

    source = SimpleNamespace(
        trials=[
            tried("pitch[a]", "pitch", 10.0), tried("pitch[b]", "pitch", 11.0), tried("drag", "drag", 12.0),
            tried("gain", "gain", 13.0),
        ]
    )  # fmt: skip
    assert [c.name for c in revising._near(source, trial, pitch)] == ["pitch[b]", "gain"]  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("left", "names", "verdict"),
    [(1.0, ("vdr",), "effect"), (1.0, (), "none"), (1.2, ("vdr",), "unexplained"), (1.2, (), "unexplained")],
)
@pytest.mark.parametrize(
    ("carries", "held_out", "why"),
    [
        (True, 0.001, ""),
        # sprung_table-102001, a plate: 0.2722 and 0.554 mrad with a pitch, 0.2746 and 0.324 with the plate.
        ("hardly", 0.010, ""),
        ("hardly", 0.018, "raises the error of the tests held out"),
        ("hardly, and whole records refuse it", 0.010, "does not carry over whole records"),
        (False, 0.001, "does not carry over whole records"),
        # Gusts: 11 and 17 mrad of tests that were fitted and held out, and 8 and 88 with a curve.  Here those fitted
        # are met 2 and 15 times better, those held out 24 times worse.
        (True, 0.4, "raises the error of the tests held out from 0.017 to 0.4 rad"),
        # sprung_table-101001, a plate: 0.80 and 1.1677 mrad without, 0.31 and 1.1678 with it.
        (True, 0.018, ""),
    ],
)
@pytest.mark.parametrize("by_search", [True, False])
def test_names_come_back_where_what_was_learned_does_not_carry(
    monkeypatch: pytest.MonkeyPatch, left: float, names: tuple[str, ...], verdict: str, carries: bool | str,
    held_out: float, why: str, by_search: bool,
) -> None:  # fmt: skip
    """It is compared with the effects whose place it took, not with the calibrated block; theirs is the verdict.

    They are in doubt where it explains more of the tests that were fitted (leaking_restitution-101001, which had come
    out as `velocity_dependent_restitution`).
    """
    plain, stands, memory = stub(chi2=5000.0), stub(*names, chi2=1000.0), stub("learned_memory", chi2=900.0)
    fit_error = {(): 0.03, ("vdr",): 0.004, ("learned_memory",): 0.002 if carries else 0.01 if names else 0.04}
    if carries not in (True, False):
        fit_error["learned_memory",] = 1.009 * fit_error[names]
    asked = []
    monkeypatch.setattr(closing, "_explained", lambda *_: (memory, "unexplained"))
    monkeypatch.setattr(closing, "settle", lambda setup, trial, whole: settled(trial.names))
    monkeypatch.setattr(closing, "_shaped", lambda setup, plain, found, tell: (found, "its"))
    monkeypatch.setattr(closing, "over_noise", lambda setup, trial: left)
    monkeypatch.setattr(closing, "structure", lambda setup: 1.03)

    def errors(setup: object, model: tuple[str, ...], windows: object) -> SimpleNamespace:
        asked.append(model)
        return SimpleNamespace(fit=fit_error[model], holdout=held_out if "learned_memory" in model else 0.017)

    monkeypatch.setattr(closing, "errors", errors)
    monkeypatch.setattr(
        closing, "explains_more", lambda setup, found, other: (found, other, carries) == ("its", "theirs", "hardly")
    )
    setup, path = SimpleNamespace(by_rotation=True), SimpleNamespace(term=None, fits=(None,))
    if by_search:  # then nothing has to be learned
        path.term = memory
        monkeypatch.setattr(closing, "_explained", None)
        monkeypatch.setattr(closing, "_further", lambda setup, plain, term, tell: term)
    kept, said_verdict, after, said = closing._kept(setup, plain, path, settled(()), stands, "theirs", quiet)  # type: ignore[arg-type]
    assert asked == [("learned_memory",), names]
    if not why:
        assert (kept, said_verdict, said) == (memory, "unexplained", ())
        assert after.whole.model == ("learned_memory",)
    else:
        doubted = bool(names) and carries in (True, "hardly")
        assert (kept, said_verdict) == (stands, "unexplained" if doubted else verdict)
        assert after.whole.model == names
        assert why in said[0]


def settled(names: tuple[str, ...]) -> SimpleNamespace:
    return SimpleNamespace(whole=SimpleNamespace(model=names, windows=()))


def rival(*names: str, criterion: float) -> Rival:
    return Rival(stub(*names, chi2=0.0), None, criterion, math.nan, math.nan)  # type: ignore[arg-type]


def test_twins_are_named_by_what_they_take_the_place_of() -> None:
    best = rival("tilt", "drag", criterion=100.0)
    close = (
        best,
        rival("mass", "drag", criterion=104.0),
        rival("tilt", "damping", criterion=108.0),
        rival("drag", "offset", criterion=111.0),
        rival("tilt", "layer", criterion=113.0),
        rival("tilt", criterion=101.0),  # one less: it takes nobody's place
    )
    assert twins(close) == (("tilt", "mass", "offset"), ("drag", "damping"))
    # A twin that comes first by a little leaves the others those of the trial about which they were tried.
    first = rival("drag", "mass", criterion=99.0)
    assert twins((first, *close), stub("tilt", "drag", chi2=0.0)) == (("tilt", "mass"), ("drag", "damping"))
