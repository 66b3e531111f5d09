"""What stands beside its rivals, the verdict, and what is learned in the place of names; all fits are stubs."""

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from studies.campaigns import DeclaredBlock
from studies.loop import closing
from studies.loop.models.parameters import Parameter
from studies.loop.swings import learning
from studies.loop.swings.learning import unnamed
from studies.loop.swings.trials import Round
from studies.loop.whole import remaining
from studies.loop.whole.rivals import Rival, other_forms, twins

from .stubs import FLOOR, TILT, rival, trial, whole


def test_what_whole_records_refused_does_not_come_back_as_a_rival(monkeypatch):
    """The cheaper trial leaves a little less of the swings than the floor that whole records brought in."""
    monkeypatch.setattr(closing, "explains_more", lambda _, one, other: one.rms < other.rms)
    floor, tilt = rival(FLOOR, 900.0, whole(1.0, 1.2)), rival(TILT, 890.0, whole(30.0, 40.0))
    bed = rival(trial("bed", 905.0, 0.98, costly=True), 905.0, whole(1.5, 1.6))
    setup = SimpleNamespace(by_rotation=True)
    kept = closing._borne_out(setup, (tilt, floor, bed), FLOOR, floor.whole)
    assert [r.trial.names[-1] for r in kept] == ["floor", "bed"]


@pytest.fixture(autouse=True)
def _quiet_base(monkeypatch):
    """What the base does to a record is known, and little: stubs say how far records are missed."""
    monkeypatch.setattr(closing, "met", lambda setup, whole, within: whole.rms < within)
    monkeypatch.setattr(remaining, "_moved", lambda setup, whole, records: np.ones(records.sum()))


@pytest.mark.parametrize("by_rotation", [True, False])
@pytest.mark.parametrize(
    ("criterion", "left", "kept", "alike"),
    [
        # Swings prefer the mass by a little, whole records refuse it: it is a twin, and not the answer.
        (895.0, 30.0, [("tilt", False), ("mass", False)], (("tilt", "mass"),)),
        # Swings prefer it by far: the two disagree, and it is no twin.
        (850.0, 30.0, [("tilt", False), ("mass", True)], ()),
        (895.0, 1.0, [("mass", False), ("tilt", False)], (("mass", "tilt"),)),
        # Swings prefer the tilt by a little, whole records the mass by far: of twins they say which comes first.
        (905.0, 0.3, [("mass", False), ("tilt", False)], (("mass", "tilt"),)),
        # It is no twin, and swings have said enough.
        (930.0, 0.3, [("tilt", False), ("mass", False)], ()),
    ],
)
def test_what_whole_records_refuse_does_not_come_first(monkeypatch, criterion, left, by_rotation, kept, alike):
    """Nor of accelerometers, of which whole records are when the side changes."""
    monkeypatch.setattr(closing, "explains_more", lambda _, one, other: one.rms < 0.5 * other.rms)
    monkeypatch.setattr(closing, "twins_from_many", lambda _, rivals, whole: rivals)  # no start is better here
    tilt = rival(TILT, 900.0, whole(1.0, 1.2))
    mass = rival(trial("mass", criterion, 1.0), criterion, whole(left, left))
    found = closing._borne_out(SimpleNamespace(by_rotation=by_rotation), (mass, tilt), TILT, tilt.whole)
    assert [(r.trial.names[-1], r.refused) for r in found] == kept
    assert twins(found) == alike


def test_what_whole_records_refused_is_no_twin():
    """Its criterion is the lower one, of what is predictable; one that they do not refuse cannot be told apart."""
    first = Rival(TILT, None, 100.0, 900.0, 0.1)
    slide, lag = (Rival(trial(name, 0.0, 1.0), None, 99.0, 5000.0, 0.1, True) for name in ("slide", "lag"))
    assert twins((first, slide, lag)) == ()
    assert twins((first, slide, replace(lag, refused=False))) == (("tilt", "lag"),)


def test_another_form_that_fits_as_well_is_said_and_one_that_fits_worse_is_not():
    def of(name, criterion, refused=False):
        parts = (SimpleNamespace(effect="tilt"), SimpleNamespace(effect=name.partition("[")[0]))
        there = SimpleNamespace(names=("tilt", name), effects=tuple(p.effect for p in parts))
        return Rival(there, None, criterion, 0.0, 0.1, refused)

    first = of("slide", 100.0)
    assert other_forms(()) == () == other_forms((first,))
    found = (
        first,
        of("slide[ratio]", 111.0),
        of("slide[far]", 113.0),
        of("slide[refused]", 101.0, True),
        of("lag", 101.0),
    )
    assert other_forms(found) == (("slide", "slide[ratio]"),)
    [said] = closing._of_forms(found)
    assert said.startswith("Slide or slide (ratio): these data do not tell which")


@pytest.mark.parametrize(
    "verdict, rms, ends, said",
    [
        ("effect", (1.0, 1.1, 1.0), "effect", ""),
        ("effect", (1.0, 9.0, 8.0), "effect", "2 of 3 whole records are missed by more than 3 times their noise"),
        ("none", (1.0, 9.0, 8.0), "unexplained", "whole records are missed by 7.0 times"),
        ("unexplained", (1.0, 9.0, 8.0), "unexplained", ""),
    ],
)
def test_whole_records_that_are_missed_are_said(verdict, rms, ends, said):
    found, notes = closing._of_whole_records(SimpleNamespace(by_rotation=True), TILT, verdict, whole(*rms), ())
    assert found == ends and len(notes) == bool(said) and said in "".join(notes)
    _, notes = closing._of_whole_records(SimpleNamespace(by_rotation=True), TILT, verdict, whole(*rms), {"tilt"})
    assert "settle on tilt" in notes[0]


# A block that slipped a little was called a table that pitches, which two of six records were missed by far with.
@pytest.mark.parametrize(
    ("rms", "moved", "ends"),
    [
        ((1.0, 1.0, 9.0, 8.0), True, "effect"),
        ((1.0, 1.0, 9.0, 8.0), False, "unexplained"),
        ((1.0, 9.0, 8.0), False, "unexplained"),
    ],
)
def test_what_whole_records_alone_speak_for_has_to_explain_them_as_far_as_the_base_lets_it(
    monkeypatch, rms, moved, ends
):
    """Moved: whether the noise of the base does as much to those that are missed."""
    by = 9.5 if moved else 1.0
    monkeypatch.setattr(remaining, "_moved", lambda setup, whole, records: np.full(records.sum(), by))
    setup = SimpleNamespace(by_rotation=True)
    assert closing._of_whole_records(setup, TILT, "effect", whole(*rms), {"tilt"})[0] == ends
    # Of an effect that swings show, records that are lost do not speak against it.
    assert closing._of_whole_records(setup, TILT, "effect", whole(*rms), {"lag"})[0] == "effect"
    both = SimpleNamespace(names=("drag", "tilt"))
    assert closing._of_whole_records(setup, both, "effect", whole(*rms), {"tilt"})[0] == "effect"


def explained_trial(chi2, *effects):
    parts = tuple(SimpleNamespace(effect=effect, slips=False, costly=False, parameters=()) for effect in effects)
    swing = SimpleNamespace(
        chi2=chi2, parameters=effects, samples=10_000, model=SimpleNamespace(declared=None), windows=()
    )
    return SimpleNamespace(names=effects, effects=effects, parts=parts, swing=swing, costly=False, parameters=())


@pytest.mark.parametrize(
    ("named", "better", "rms", "ends"),
    [
        # A coefficient may be an effect with a name: a tie is the name's, though the term has a parameter less.
        (("rounded_edges", "viscous_damping"), 40.0, 1.0, "effect"),
        (("rounded_edges", "viscous_damping"), 80.0, 1.0, "unexplained"),
        # Speeds and pauses fall together in a decay: one that explains far more is the better answer.
        (("velocity_dependent_restitution",), 40.0, 1.0, "effect"),
        (("velocity_dependent_restitution",), 250.0, 1.0, "unexplained"),
        # Swings do not tell them apart, but the name misses whole records, and the other one meets them.
        (("velocity_dependent_restitution",), 40.0, 3.0, "unexplained"),
        (("velocity_dependent_restitution",), -40.0, 3.0, "unexplained"),
        (("velocity_dependent_restitution",), -250.0, 3.0, "effect"),
        # Not a law of what is lost.
        (("base_tilt",), 250.0, 3.0, "effect"),
    ],
)
def test_what_was_learned_takes_the_place_of_names_where_it_explains_far_more(monkeypatch, named, better, rms, ends):
    plain, found = explained_trial(20_000.0), explained_trial(9_000.0, *named)
    other = explained_trial(9_000.0 - better, "learned_memory")
    monkeypatch.setattr(closing, "over_noise", lambda setup, trial: 1.0)
    monkeypatch.setattr(closing, "structure", lambda setup: 1.03)
    monkeypatch.setattr(closing, "by_chance", lambda setup, trial: False)
    monkeypatch.setattr(closing, "memories", lambda block, windows: ())
    monkeypatch.setattr(closing, "profiles", lambda block, windows: ())
    monkeypatch.setattr(closing, "whole_fit", lambda setup, trial, whole=None: whole)
    monkeypatch.setattr(closing, "explains_more", lambda setup, one, other: True)
    monkeypatch.setattr(closing, "search", lambda *_: Round(plain, [other]))
    monkeypatch.setattr(closing, "unnamed", lambda block: ())
    monkeypatch.setattr(closing, "_one_in_place_of", lambda *_: None)  # tried by itself below
    monkeypatch.setattr(closing, "hinted", lambda setup, onto, bare, tried: ())
    monkeypatch.setattr(
        closing, "learn", lambda simulator, onto, tell, rival=None, going_on=True: other if onto is plain else onto
    )
    setup = SimpleNamespace(by_rotation=True, simulator=None, records=[], swings=())
    chosen, verdict = closing._explained(setup, plain, None, found, records(rms), lambda text: None)
    assert verdict == ends
    assert chosen is (found if ends == "effect" else other)


def records(rms, lost=()):
    """What is left of whole records: of four alike, and of some that are lost."""
    by_window = np.array([*[rms] * 4, *lost])
    return SimpleNamespace(rms=math.sqrt(np.mean(by_window**2)), by_window=by_window, chi2=float(np.sum(by_window**2)))


@pytest.fixture(autouse=True)
def no_start_is_better(monkeypatch):
    """Fits of whole records from other starts, which change nothing but where a test says so; all swings hint."""
    monkeypatch.setattr(closing, "whole_fit_from_many", lambda setup, trial, whole: whole)
    monkeypatch.setattr(closing, "hints", lambda onto, tried: tried.trials)


@pytest.mark.parametrize(
    ("lost", "left"), [((), 1.05), ((129.0,), 1.05), ((129.0, 60.0), math.sqrt((4 * 1.05**2 + 129**2 + 60**2) / 6))]
)
def test_one_record_that_is_lost_is_no_doubt_of_what_was_found(lost, left):
    """So one was of the laboratory under the true model itself; by hand."""
    assert remaining.rms_but_for_one(records(1.05, lost)) == pytest.approx(left, rel=1e-12)


@pytest.mark.parametrize(
    ("named", "rms", "says", "ends"),
    [
        # Two effects may explain more of the swings by far, and be wrong; one effect that does so is not doubted.
        (("viscous_damping", "velocity_dependent_restitution"), 1.5, True, "unexplained"),
        (("viscous_damping", "velocity_dependent_restitution"), 1.5, False, "effect"),
        # Hinge friction: two laws of loss met whole records to 1.15 times the noise, its own coefficient to 1.03.
        (("viscous_damping", "velocity_dependent_restitution"), 1.15, True, "unexplained"),
        (("viscous_damping", "velocity_dependent_restitution"), 1.05, True, "effect"),  # they are met
        (("viscous_damping",), 1.15, True, "unexplained"),
        (("viscous_damping",), 1.5, True, "unexplained"),
        # A restitution by side was named so: two effects may stand in for one of any kind, a single one may not.
        (("base_tilt", "eccentric_mass"), 1.5, True, "unexplained"),
        (("base_tilt", "eccentric_mass"), 1.05, True, "effect"),
        (("base_tilt",), 1.5, True, "effect"),
    ],
)
def test_a_law_that_has_no_name_is_asked_of_whole_records_that_names_miss(monkeypatch, named, rms, says, ends):
    """Friction on one side alone hardly shows in swings, where two other losses stand for it."""
    plain, found = explained_trial(20_000.0), explained_trial(9_000.0, *named)
    term, asked = explained_trial(9_100.0 if len(named) > 1 else 9_050.0, "learned_term"), []
    monkeypatch.setattr(closing, "over_noise", lambda setup, trial: 1.0)
    monkeypatch.setattr(closing, "structure", lambda setup: 1.03)
    monkeypatch.setattr(closing, "by_chance", lambda setup, trial: True)
    monkeypatch.setattr(closing, "memories", lambda block, windows: ())
    monkeypatch.setattr(closing, "profiles", lambda block, windows: ())
    pool = unnamed(DeclaredBlock(0.2, 0.8, 0.4, 40.0))
    monkeypatch.setattr(closing, "unnamed", lambda block: pool)
    monkeypatch.setattr(closing, "by_itself", lambda simulator, trial: pool)
    monkeypatch.setattr(closing, "explains_more", lambda setup, one, other: says and one == "its")

    def search(simulator, onto, pool, tell, leading=False):
        asked.extend(c.name for c in pool)
        return Round(onto, [term] if pool else [])

    def hinted(setup, onto, bare, tried):
        assert (onto, bare, tried.trials) == (plain, "bare", [term])
        return (SimpleNamespace(trial=term, whole="its"),)

    monkeypatch.setattr(closing, "search", search)
    monkeypatch.setattr(closing, "hinted", hinted)
    setup = SimpleNamespace(by_rotation=True, simulator=None, records=[], swings=())
    chosen, verdict = closing._explained(setup, plain, "bare", found, records(rms), lambda text: None)
    assert verdict == ends and chosen is (term if ends == "unexplained" else found)
    if asked:
        assert "learned[friction by side]" in asked and "learned[damping]" not in asked


@pytest.mark.parametrize(
    ("again", "left", "asked"),
    [
        # rounded_edges-68001: met to 1.28 times the noise from where swings end, to 1.0 from another start; a
        # restitution that differs by side, which explains the swings less by 190, was said to be it.
        (1.05, 50.0, None),
        (1.5, 50.0, ["learned_term"]),
        (1.5, 70.0, []),
    ],
)
def test_a_single_effect_is_doubted_only_where_no_start_meets_whole_records_and_swings_allow(
    monkeypatch, again, left, asked
):
    plain, found = explained_trial(20_000.0), explained_trial(9_000.0, "rounded_edges")
    term, seen = explained_trial(9_000.0 + left, "learned_term"), []
    monkeypatch.setattr(closing, "over_noise", lambda setup, trial: 1.0)
    monkeypatch.setattr(closing, "structure", lambda setup: 1.03)
    monkeypatch.setattr(closing, "memories", lambda block, windows: ())
    monkeypatch.setattr(closing, "profiles", lambda block, windows: ())
    monkeypatch.setattr(closing, "unnamed", lambda block: ("a term",))
    monkeypatch.setattr(closing, "whole_fit_from_many", lambda setup, trial, whole: records(again))
    monkeypatch.setattr(closing, "explains_more", lambda setup, one, other: False)
    monkeypatch.setattr(closing, "whole_fit", lambda setup, trial, whole: whole)
    monkeypatch.setattr(closing, "search", lambda simulator, onto, pool, tell: Round(onto, [term] if pool else []))
    monkeypatch.setattr(
        closing, "hinted", lambda setup, onto, bare, tried: seen.append([t.names[0] for t in tried.trials]) or ()
    )
    setup = SimpleNamespace(by_rotation=True, simulator=None, records=[], swings=())
    closing._explained(setup, plain, "bare", found, records(1.5), lambda text: None)
    assert seen == ([] if asked is None else [asked])


@pytest.mark.parametrize(
    ("left", "rms", "costly", "by_rotation", "ends"),
    [
        # compliant_base-65001: whole records met to 1.04, yet called unexplained for 1.6 times the noise in swings.
        (1.6, 1.04, True, True, "effect"),
        # bouncing-96001: the right numbers to 0.2 %, met to 1.25 but for one of seven records, 1.8 times in swings.
        (1.8, 1.25, True, True, "effect"),
        (1.6, 1.35, True, True, "unexplained"),
        (1.6, 1.04, False, True, "unexplained"),
        (1.6, 1.04, True, False, "unexplained"),
    ],
)
def test_what_swings_on_a_floor_that_gives_leave_is_that_of_how_they_begin_where_whole_records_are_met(
    monkeypatch, left, rms, costly, by_rotation, ends
):
    plain, found = explained_trial(20_000.0), explained_trial(9_000.0, "compliant_base")
    found.costly = found.parts[0].costly = costly
    monkeypatch.setattr(closing, "over_noise", lambda setup, trial: left)
    monkeypatch.setattr(closing, "structure", lambda setup: 1.03)
    monkeypatch.setattr(closing, "unexplained", lambda setup: 1.05)
    monkeypatch.setattr(closing, "learn", lambda *_, **__: plain)
    setup = SimpleNamespace(simulator=None, records=[], swings=(), by_rotation=by_rotation)
    assert closing._explained(setup, plain, None, found, records(rms), lambda text: None) == (found, ends)


@pytest.mark.parametrize(
    ("effect", "rms", "by_rotation", "before", "ends"),
    [
        ("learned_curve", 7.5, True, 12000.0, "near upright"),
        ("learned_curve", 1.2, True, 12000.0, "smooth"),
        ("learned_curve", 7.5, False, 12000.0, "smooth"),
        ("learned_mode", 7.5, True, 12000.0, "smooth"),
        ("learned_curve", 7.5, True, 8600.0, "near upright"),
        ("learned_curve", 7.5, True, 8400.0, "smooth"),
    ],
)
def test_whole_records_choose_among_forms_that_swings_hardly_tell_apart(
    monkeypatch, effect, rms, by_rotation, before, ends
):
    """As measured on a magnet near upright: 4666, 4670 and 4654 of swings, 7.5, 0.95 and 4.3 of whole records.

    Noise leaves 800 of what is left before: of less than half of the rest there is no form to choose.
    """
    forms = {"smooth": (4666.0, rms), "near upright": (4670.0, 0.95), "fine": (4654.0, 4.3), "far": (9000.0, 0.5)}

    def form(name):
        part = SimpleNamespace(name=name, effect=effect)
        swing = SimpleNamespace(chi2=forms[name][0], parameters=(), samples=4900)
        names = ("tilt", name)
        return SimpleNamespace(names=names, parts=(None, part), swing=swing, costly=False, effects=(), parameters=())

    def alike(simulator, less, found, tell):
        assert less == ("without", 1) and found.names[-1] == "smooth"
        return [form("near upright"), form("fine")]

    monkeypatch.setattr(closing, "taken_out", lambda setup, plain, found, k: ("without", k))
    monkeypatch.setattr(closing, "alike", alike)
    monkeypatch.setattr(closing, "whole_fit", lambda setup, t: SimpleNamespace(rms=forms[t.names[-1]][1]))
    monkeypatch.setattr(closing, "explains_more", lambda setup, one, other: one.rms < other.rms)
    setup = SimpleNamespace(by_rotation=by_rotation, simulator=None)
    plain = SimpleNamespace(swing=SimpleNamespace(chi2=before, samples=900, windows=(None,) * 50, parameters=()))
    found, whole = closing._shaped(setup, plain, form("smooth"), lambda text: None)
    assert found.names[-1] == ends and whole.rms == forms[ends][1]


def test_alike_is_what_swings_hardly_tell_from_what_was_learned(monkeypatch):
    def form(name, chi2):
        swing = SimpleNamespace(chi2=chi2, parameters=(), samples=4900)
        return SimpleNamespace(name=name, parts=(SimpleNamespace(name=name),), swing=swing)

    found = form("smooth", 4666.0)
    tried = [form("far", 4727.0), form("near upright", 4670.0), form("fine", 4654.0)]
    pool = [SimpleNamespace(name=name) for name in ("smooth", "fine")]
    monkeypatch.setattr(learning, "_at_hand", lambda simulator, onto: pool)
    monkeypatch.setattr(learning, "open_to", lambda onto, among: list(among))

    def search(simulator, onto, among, tell, repeated, leading):
        assert onto == "less" and [c.name for c in among] == ["fine"] and repeated
        return SimpleNamespace(trials=tried)

    monkeypatch.setattr(learning, "search", search)
    assert [t.name for t in learning.alike(None, "less", found, None)] == ["fine", "near upright"]


@pytest.mark.parametrize(
    ("by_swings", "rms", "prefers", "taken"),
    [
        # A weak magnet near upright, which no swing shows: a gain of the base sensor left 1.27 of whole records, a
        # curve near upright 0.99.
        (0.0, 1.27, True, True),
        (0.0, 1.27, False, False),
        (0.0, 1.05, True, False),  # met closely
        (100.0, 1.27, True, False),  # swings speak for the name
    ],
)
def test_a_name_of_whole_records_alone_that_does_not_meet_them_gives_way(monkeypatch, by_swings, rms, prefers, taken):
    plain, found = explained_trial(9_000.0), explained_trial(9_000.0 - by_swings, "base_motion_gain")
    curve = explained_trial(9_000.0, "learned_curve")
    monkeypatch.setattr(closing, "over_noise", lambda setup, trial: 1.0)
    monkeypatch.setattr(closing, "structure", lambda setup: 1.03)
    monkeypatch.setattr(closing, "met", lambda setup, whole, within: whole.rms < within)
    monkeypatch.setattr(closing, "_one_in_place_of", lambda *_: None)
    monkeypatch.setattr(closing, "unseen", lambda setup, onto, bare, tell: curve if bare == "bare" else None)
    monkeypatch.setattr(closing, "whole_fit", lambda setup, trial, whole: trial)
    monkeypatch.setattr(closing, "explains_more", lambda setup, one, other: one is curve and prefers)
    setup = SimpleNamespace(by_rotation=True, simulator=None, records=[], swings=())
    chosen = closing._explained(setup, plain, "bare", found, records(rms), lambda text: None)
    assert chosen == ((curve, "unexplained") if taken else (found, "effect"))


@pytest.mark.parametrize(
    ("coefficients", "better", "by_name"),
    [
        (("bias", "friction"), 20.0, True),  # what tilts is in the bias: its name stays, beside the friction
        (("bias", "friction"), 80.0, False),
        (("side", "friction"), 20.0, False),  # none of these has a name
    ],
)
def test_a_name_is_kept_beside_what_has_none(monkeypatch, coefficients, better, by_name):
    plain, found = explained_trial(20_000.0), explained_trial(9_000.0, "base_tilt")
    own = tuple(Parameter(f"learned_term.{name}", 1.0, -1.0, 1.0) for name in coefficients)
    alone = SimpleNamespace(**vars(explained_trial(8_000.0 - better, "learned_term")) | {"parameters": own})
    beside = explained_trial(8_000.0, "base_tilt", "learned_term")
    monkeypatch.setattr(closing, "over_noise", lambda setup, trial: 1.04)
    monkeypatch.setattr(closing, "structure", lambda setup: 1.03)
    monkeypatch.setattr(closing, "learn", lambda _, onto, *__, **___: alone if onto is plain else beside)
    setup, missed = SimpleNamespace(simulator=None, records=[], swings=()), records(2.0)
    chosen = closing._explained(setup, plain, None, found, missed, lambda text: None)
    assert chosen == (beside if by_name else alone, "unexplained")


def test_what_only_undoes_an_effect_is_not_learned(monkeypatch):
    """Whole records brought an effect in that the swings are no better for: a term that takes it back is none."""
    plain, found, other = (
        explained_trial(8_950.0),
        explained_trial(9_050.0, "lag"),
        explained_trial(8_940.0, "learned_term"),
    )
    monkeypatch.setattr(closing, "over_noise", lambda setup, trial: 1.04)
    monkeypatch.setattr(closing, "structure", lambda setup: 1.03)
    monkeypatch.setattr(closing, "unexplained", lambda setup: 1.05)
    monkeypatch.setattr(closing, "learn", lambda _, onto, *__, **___: plain if onto is plain else other)
    setup, met = SimpleNamespace(simulator=None, records=[], swings=()), records(1.0)
    assert closing._explained(setup, plain, None, found, met, lambda text: None) == (found, "effect")


@pytest.mark.parametrize(
    ("chi2", "says", "ends"),
    [
        (9_004.0, True, "unexplained"),  # one parameter less is worth 9.2
        (9_011.0, True, "unexplained"),  # swings do not tell
        (9_014.0, True, "effect"),
        (9_004.0, False, "effect"),
        (None, True, "effect"),
    ],
)
def test_one_coefficient_takes_the_place_of_two_names_that_swings_and_whole_records_prefer_it_to(
    monkeypatch, chi2, says, ends
):
    """A restitution by side was named as eccentric mass and tilt, which met whole records to 1.04 times their noise."""
    plain, found = explained_trial(20_000.0), explained_trial(9_000.0, "base_tilt", "eccentric_mass")
    one = None if chi2 is None else explained_trial(chi2, "learned_term")
    monkeypatch.setattr(closing, "over_noise", lambda setup, trial: 1.0)
    monkeypatch.setattr(closing, "structure", lambda setup: 1.03)
    monkeypatch.setattr(closing, "by_chance", lambda setup, trial: True)
    pool = unnamed(DeclaredBlock(0.2, 0.8, 0.4, 40.0))
    monkeypatch.setattr(closing, "by_itself", lambda simulator, trial: pool)
    monkeypatch.setattr(closing, "whole_fit", lambda setup, trial, whole: trial)
    monkeypatch.setattr(closing, "explains_more", lambda setup, fitted, other: says and fitted is one)

    def search(simulator, onto, pool, tell, leading=False):
        names = [c.name for c in pool]
        assert onto is plain and "learned[restitution_side]" in names and "learned[damping]" not in names
        return Round(onto, [] if one is None else [one])

    monkeypatch.setattr(closing, "search", search)
    setup = SimpleNamespace(by_rotation=True, simulator=None, records=[], swings=())
    chosen, verdict = closing._explained(setup, plain, None, found, records(1.04), lambda text: None)
    assert verdict == ends and chosen is (one if ends == "unexplained" else found)


@pytest.mark.parametrize(
    ("rms", "by_base", "chi2", "says", "ends"),
    [
        pytest.param(1.2, False, 8_980.0, True, "unexplained", id="all for it"),
        pytest.param(1.04, False, 8_980.0, True, "effect", id="the string meets whole records"),
        pytest.param(1.2, True, 8_980.0, True, "effect", id="as far as the base lets it"),
        pytest.param(1.2, False, 9_014.0, True, "effect", id="swings prefer the string"),
        pytest.param(1.2, False, 8_980.0, False, "effect", id="whole records do not prefer the coefficient"),
    ],
)
def test_one_coefficient_takes_the_place_of_a_string_that_misses_whole_records(
    monkeypatch, rms, by_base, chi2, says, ends
):
    """A torque with the cube of the rotation came out as a tether: worse by 21 in swings, 1.2 times the noise whole."""
    plain, found = explained_trial(20_000.0), explained_trial(9_000.0, "tether")
    one = explained_trial(chi2, "learned_term")
    monkeypatch.setattr(closing, "met", lambda setup, whole, within: by_base or whole.rms < within)
    monkeypatch.setattr(closing, "over_noise", lambda setup, trial: 1.0)
    monkeypatch.setattr(closing, "structure", lambda setup: 1.03)
    monkeypatch.setattr(closing, "by_chance", lambda setup, trial: True)
    monkeypatch.setattr(closing, "by_itself", lambda simulator, trial: ())
    monkeypatch.setattr(closing, "whole_fit", lambda setup, trial, whole: trial)
    monkeypatch.setattr(closing, "whole_fit_from_many", lambda setup, trial, whole: whole)
    monkeypatch.setattr(closing, "explains_more", lambda setup, fitted, other: says and fitted is one)
    monkeypatch.setattr(closing, "search", lambda simulator, onto, pool, tell, leading: Round(onto, [one]))
    setup = SimpleNamespace(by_rotation=True, simulator=None, records=[], swings=())
    chosen, verdict = closing._explained(setup, plain, None, found, records(rms), lambda text: None)
    assert verdict == ends and chosen is (one if ends == "unexplained" else found)


@pytest.mark.parametrize(("parameters", "halved", "preferred"), [(1, False, True), (2, False, False), (2, True, True)])
def test_a_law_of_more_parameters_than_the_name_has_to_mend_whole_records(monkeypatch, parameters, halved, preferred):
    """A damping by rotation of five knots stood for a viscous one, of a campaign with a record that the base moved."""
    monkeypatch.setattr(closing, "explains_more", lambda setup, fitted, other: (fitted, other) == ("law's", "name's"))
    monkeypatch.setattr(closing, "halves", lambda setup, fitted, other: halved)
    law, name = SimpleNamespace(parameters=("one",) * parameters), SimpleNamespace(parameters=("one",))
    assert closing._preferred(None, law, "law's", name, "name's") is preferred


@pytest.mark.parametrize(
    ("left", "roughly", "chi2", "more"),
    [
        pytest.param(1.07, False, 8_000.0, True, id="it leaves something, of which more is learned"),
        pytest.param(1.07, False, 8_950.0, False, id="nothing more is learned"),
        pytest.param(1.04, False, 8_000.0, False, id="it explains all"),
        pytest.param(1.07, True, 8_000.0, False, id="swings begin roughly"),
    ],
)
def test_of_what_is_ahead_of_all_names_more_is_learned_where_it_is_not_all(monkeypatch, left, roughly, chi2, more):
    plain, term, learned = (explained_trial(chi2, "learned_term") for chi2 in (20_000.0, 9_000.0, chi2))
    monkeypatch.setattr(closing, "over_noise", lambda setup, trial: left)
    monkeypatch.setattr(closing, "unexplained", lambda setup: 1.05)
    monkeypatch.setattr(closing, "begins_roughly", lambda trial: roughly)
    monkeypatch.setattr(closing, "learn", lambda simulator, onto, tell: learned if onto is plain else None)
    found = closing._further(SimpleNamespace(simulator=None), plain, term, lambda text: None)
    assert found is (learned if more else term)


@pytest.mark.parametrize(
    ("name", "rms", "chi2", "says", "ends"),
    [
        # A plate on springs under the block, of 17 Hz: swings 7844 and 7846, whole records 0.98 and 0.90 times theirs.
        pytest.param("table_pitch", 0.98, 8_994.0, True, "unexplained", id="swings do not tell, whole records do"),
        pytest.param("table_pitch", 0.98, 9_011.0, True, "unexplained", id="twins in swings"),
        # An outsider's plate of 11 Hz: 8 apart in swings, whole records 1.77 and 0.89 times theirs.
        pytest.param("table_pitch", 1.77, 9_008.0, True, "unexplained", id="whole records miss the name"),
        # A table that pitches: a plate left 23 more of swings, and 1.40 of whole records where it left 0.93.
        pytest.param("table_pitch", 0.93, 9_023.0, False, "effect", id="both prefer the name"),
        pytest.param("table_pitch", 0.98, 9_014.0, True, "effect", id="swings prefer the name"),
        pytest.param("table_pitch", 0.98, 9_002.0, False, "effect", id="whole records do not tell either"),
        pytest.param("base_tilt", 0.98, 9_002.0, True, "effect", id="it is not of how the base moves"),
    ],
)
def test_something_under_the_block_takes_the_place_of_an_effect_on_how_the_base_moves(
    monkeypatch, name, rms, chi2, says, ends
):
    plain, found, plate = (explained_trial(c, *n) for c, n in ((20_000.0, ()), (9_000.0, (name,)), (chi2, ("plate",))))
    monkeypatch.setattr(closing, "over_noise", lambda setup, trial: 1.0)
    monkeypatch.setattr(closing, "structure", lambda setup: 1.03)
    monkeypatch.setattr(closing, "between", lambda simulator, windows: ("plate",))
    monkeypatch.setattr(closing, "whole_fit", lambda setup, trial, whole: trial)
    monkeypatch.setattr(closing, "whole_fit_from_many", lambda setup, trial, whole: whole)
    monkeypatch.setattr(closing, "explains_more", lambda setup, fitted, other: says and fitted is plate)

    def search(simulator, onto, pool, tell, leading):
        assert onto is plain and pool == ("plate",)
        return Round(onto, [plate])

    monkeypatch.setattr(closing, "search", search)
    setup = SimpleNamespace(by_rotation=True, simulator=None, records=[], swings=())
    chosen, verdict = closing._explained(setup, plain, None, found, records(rms), lambda text: None)
    assert verdict == ends and chosen is (plate if ends == "unexplained" else found)


def test_nothing_is_learned_where_two_effects_leave_what_noise_leaves(monkeypatch):
    plain, found = explained_trial(20_000.0), explained_trial(9_000.0, "rounded_edges", "viscous_damping")
    monkeypatch.setattr(closing, "over_noise", lambda setup, trial: 1.01)
    monkeypatch.setattr(closing, "structure", lambda setup: 1.03)
    monkeypatch.setattr(closing, "by_itself", lambda simulator, trial: ())
    monkeypatch.setattr(closing, "search", lambda simulator, onto, pool, tell, leading: Round(onto))
    asked = []
    monkeypatch.setattr(closing, "learn", lambda *_, **__: asked.append(1) or plain)
    for by_chance, learned in ((True, 0), (False, 2)):
        monkeypatch.setattr(closing, "by_chance", lambda setup, trial, is_so=by_chance: is_so)
        setup = SimpleNamespace(simulator=None, records=[], swings=(), by_rotation=True)
        whole = records(1.0)
        assert closing._explained(setup, plain, None, found, whole, lambda text: None) == (found, "effect")
        assert len(asked) == learned


@pytest.mark.parametrize(("rms", "by_rotation", "learned"), [(1.29, True, 0), (1.31, True, 2), (1.29, False, 2)])
def test_of_a_block_that_slips_whole_records_say_whether_two_effects_leave_anything(
    monkeypatch, rms, by_rotation, learned
):
    plain, found = explained_trial(20_000.0), explained_trial(9_000.0, "sliding", "viscous_damping")
    for part in found.parts:
        part.slips = part.effect == "sliding"
    monkeypatch.setattr(closing, "over_noise", lambda setup, trial: 1.01)
    monkeypatch.setattr(closing, "structure", lambda setup: 1.03)
    asked = []
    monkeypatch.setattr(closing, "learn", lambda *_, **__: asked.append(1) or plain)
    setup = SimpleNamespace(simulator=None, records=[], swings=(), by_rotation=by_rotation)
    whole = SimpleNamespace(rms=rms)
    assert closing._explained(setup, plain, None, found, whole, lambda text: None) == (found, "effect")
    assert len(asked) == learned


def noise_alone(rng, windows, of, slips=False, noise=1e-4):
    """A trial that leaves noise alone of each of its windows: each has fitted two states of its own."""
    record = SimpleNamespace(test=0, noise=1e-6, channels=(SimpleNamespace(noise=noise),))
    residuals = tuple(rng.standard_normal(of) for _ in range(windows))
    for r in residuals:
        r[:2] = 0.0
    swing = SimpleNamespace(
        windows=(SimpleNamespace(theta=0.1, test=0, by_base=0.0, data=np.zeros(of)),) * windows,
        residuals=residuals,
        parameters=(),
        samples=windows * of,
    )
    parts = (SimpleNamespace(slips=slips),)
    return SimpleNamespace(records=[record]), SimpleNamespace(swing=swing, parts=parts)


def test_noise_alone_leaves_by_chance_what_its_distribution_says():
    """One sum of squares in 44 is beyond two standard deviations: of 500 sets 11.4, give or take 3.3."""
    rng = np.random.default_rng(20)
    sets = [noise_alone(rng, 40, 40) for _ in range(500)]
    beyond = sum(not remaining.by_chance(setup, trial) for setup, trial in sets)
    assert 11.4 - 3 * 3.3 < beyond < 11.4 + 3 * 3.3
    setup, trial = sets[0]
    assert remaining.by_chance(setup, trial)
    larger = SimpleNamespace(**{**vars(trial.swing), "residuals": tuple(1.05 * r for r in trial.swing.residuals)})
    assert not remaining.by_chance(setup, SimpleNamespace(swing=larger, parts=trial.parts))
    # An estimated noise was taken from the same records; of what slips a median is known alone.
    rng = np.random.default_rng(20)
    assert not remaining.by_chance(*noise_alone(rng, 40, 40, noise=None))
    assert not remaining.by_chance(*noise_alone(rng, 40, 40, slips=True))


@pytest.mark.parametrize(
    ("fits", "by_rotation", "by_far", "carries"),
    [
        ((0.0011, 0.0026), True, False, False),
        ((0.0048, 0.0012), True, False, True),
        # Of a restitution by side the median was 0.0026, since ends of records hang on the noise of the base; their
        # chi-square fell from 21643 to 18285.
        ((0.0011, 0.0026), True, True, True),
        ((0.0011, 0.0026), False, True, False),
    ],
)
def test_what_was_learned_of_swings_has_to_bring_whole_records_nearer(monkeypatch, fits, by_rotation, by_far, carries):
    monkeypatch.setattr(closing, "explains_more", lambda setup, one, other: by_far and one.model == "after")
    before, after = (SimpleNamespace(whole=SimpleNamespace(model=name, windows=())) for name in ("before", "after"))
    then, now = fits
    assert closing._carries(SimpleNamespace(by_rotation=by_rotation), before, after, now, then) is carries


def test_what_was_taken_for_known_is_said():
    held = SimpleNamespace(assumed={"bouncing.friction": 1.0})
    chosen = SimpleNamespace(
        parts=(SimpleNamespace(assumed={}), held), swing=SimpleNamespace(model={"bouncing.friction": 2.0})
    )
    assert closing._of_what_is_assumed(chosen) == (
        "bouncing.friction was not fitted but taken as 2; intervals reach as far as 1 would carry the estimates",
    )
