"""Where the search goes: to floors last of all, and back where something is left; rounds and fits are stubs."""

import math
from types import SimpleNamespace

import pytest

from studies.loop.search import rounds, searching
from studies.loop.swings.trials import Round
from studies.loop.whole import remaining


@pytest.fixture(autouse=True)
def no_record_is_lost(monkeypatch):
    """But where a test says so."""
    monkeypatch.setattr(searching, "one_is_lost", lambda whole: False)
    monkeypatch.setattr(searching, "rms_but_for_one", lambda whole: whole.rms)


@pytest.fixture(autouse=True)
def no_releases(monkeypatch):
    """But where a test says so."""
    monkeypatch.setattr(searching, "tell_of_floors", lambda setup: False)


@pytest.mark.parametrize(
    ("lost", "many", "others", "enough"),
    [
        # A restitution by side: one earthquake of six records was lost and the others met to 1.5 to 1.8 times their
        # noise; from another start all others are met to 1.04, and the base moves that one as much.
        (True, 1.04, 1.04, True),
        # Of a sensor that is not linear a ramp of six records falls from any start, and the others are met.
        (True, 139.0, 1.05, True),
        (True, 1.4, 1.4, False),
        (False, 1.04, 1.04, False),
    ],
)
def test_where_one_record_is_lost_a_coefficient_is_fitted_from_more_starts(monkeypatch, lost, many, others, enough):
    term, first, better = SimpleNamespace(parts=(), costly=False), *(
        SimpleNamespace(rms=rms, chi2=chi2) for rms, chi2 in ((5.6, 5600.0), (many, 1000.0))
    )  # fmt: skip
    for name, stub in {
        "_of_swings": lambda setup, term: True,
        "whole_fit": lambda setup, term, weights_of=None: first,
        "remembering_all": lambda setup, term, whole: (term, whole),
        "by_chance": lambda setup, term: True,
        "met": lambda setup, whole, within: whole.rms < within,
        "one_is_lost": lambda whole: lost,
        "rms_but_for_one": lambda whole: others if whole is better else 1.5,
        "whole_fit_from_many": lambda setup, term, whole: better,
    }.items():
        monkeypatch.setattr(searching, name, stub)
    assert searching._enough("setup", term) == ((term, better) if enough else None)


@pytest.fixture
def ways(monkeypatch):
    """A search in which floors are put off at first, and each case says what is accepted and what that leaves."""
    told = SimpleNamespace(
        chance=True, explains=True, rounds=[], accepted={}, put_off=(SimpleNamespace(name="floor"),), whole=1.4,
        trials={}, declared=True, term=False, promises=False, nothing=(),
        form=None, from_many=None, beside=None, alone=(), ahead=None, kinds=(), asked=[], by_swings=[],
    )  # fmt: skip

    def one_round(setup, onto, whole, pool, tell, known, later, by_swings=False):
        told.by_swings.append(by_swings)
        told.rounds.append((onto.names, later, known is not None))
        tried = known or Round(onto, list(told.trials.get(onto.names, ())), put_off=told.put_off)
        tried.put_off = told.put_off if later else ()
        nxt = told.accepted.get((onto.names, later))
        if nxt is not None and all(t is not nxt for t in tried.trials):
            tried.trials.append(nxt)
        return tried, nxt and (nxt, whole_of(told, nxt)), ()

    def searched(setup, plain, pool, tell, later):
        assert later
        return Round(plain, list(told.trials.get((), ())), put_off=told.put_off)

    monkeypatch.setattr(rounds, "_round", one_round)
    monkeypatch.setattr(searching, "searched", searched)
    monkeypatch.setattr(searching, "floor_promises", lambda simulator, found, tell: told.promises)
    monkeypatch.setattr(searching, "nothing_of_swings", lambda setup, trial: trial.names in told.nothing)
    monkeypatch.setattr(searching, "all_candidates", lambda model, friction: ())
    monkeypatch.setattr(searching, "whole_fit", lambda setup, trial, weights_of=None: whole_of(told, trial))
    monkeypatch.setattr(
        searching, "whole_fit_from_many",
        lambda setup, trial, whole: whole if told.from_many is None else SimpleNamespace(rms=told.from_many),
    )  # fmt: skip
    monkeypatch.setattr(searching, "met", lambda setup, whole, within: whole.rms < within)
    monkeypatch.setattr(searching, "explains_more", lambda setup, one, other: False)
    monkeypatch.setattr(searching, "declared_noise", lambda setup: told.declared)
    told.asked_for_a_term = searching._one_term_is_enough
    monkeypatch.setattr(searching, "_one_term_is_enough", lambda setup, plain, tell: told.term)
    told.asked_for_a_form = searching._form_in_place

    def form_in_place(setup, plain, path, kinds, lead, tell, refused):
        told.asked.append([kind.what for kind in kinds])
        return told.form

    monkeypatch.setattr(searching, "_form_in_place", form_in_place)
    told.kinds_of_forms = searching._kinds_of_forms
    monkeypatch.setattr(searching, "_kinds_of_forms", lambda setup, plain, path: list(told.kinds))
    told.asked_beside = searching._term_beside

    def beside(setup, plain, path, tell):
        told.asked.append("beside")
        return told.beside

    monkeypatch.setattr(searching, "_term_beside", beside)
    told.asked_ahead = searching._term_ahead
    monkeypatch.setattr(searching, "_term_ahead", lambda setup, path, rounds, lead: told.ahead)
    told.coefficient = searching._coefficient
    monkeypatch.setattr(searching, "_coefficient", lambda setup, plain, lead: None)
    for module in (rounds, searching):
        monkeypatch.setattr(module, "by_chance", lambda setup, trial: told.chance)
        monkeypatch.setattr(module, "explains", lambda setup, trial, whole: told.explains)
        monkeypatch.setattr(module, "stands_alone", lambda setup, trial, whole: trial.names in told.alone)
    return told


def setup_of(by_rotation):
    """A campaign that declares no friction."""
    campaign = SimpleNamespace(conditions=SimpleNamespace(friction=None))
    return SimpleNamespace(by_rotation=by_rotation, campaign=campaign, simulator=None)


def whole_of(told, trial):
    """A fit of the trial on whole records; `best` says which trial's is no better, if one was looked for."""
    return SimpleNamespace(rms=told.whole, of=trial.names, best=None)


def path_of(*names, costly=False, chi2=None):
    parts = tuple(SimpleNamespace(name=n, slips=n == "slide", in_swings=n != "adhesion", parameters=()) for n in names)
    chi2 = 10.0 * len(names) if chi2 is None else chi2
    swing = SimpleNamespace(model=None, rms=1.5, chi2=chi2, parameters=(), samples=1000)
    return SimpleNamespace(names=names, effects=names, parts=parts, parameters=(), swing=swing, costly=costly)


def searched():
    return searching.traced(setup_of(True), path_of(), lambda text: None)


def test_floors_are_not_tried_where_one_coefficient_without_a_name_leaves_nothing(ways):
    """They take long, and it explains what they might."""
    ways.explains = ways.chance = False
    ways.accepted = {((), True): path_of("a")}
    ways.term = True
    found = searched()
    assert not any(not later for _, later, _ in ways.rounds)
    assert all(r.skipped == {"floor": searching.ONE_TERM} for r in found.rounds)
    ways.term = False
    searched()
    assert any(not later for _, later, _ in ways.rounds)


@pytest.mark.parametrize(
    ("rotation", "declared", "found", "left", "chance", "whole", "enough"),
    [
        (True, True, True, 1.01, True, 1.29, True),
        (True, True, True, 1.01, True, 1.31, False),
        # A restitution by side of somebody else's block left 1.036 of 12.8, and met whole records to 0.97.
        (True, True, True, 1.036, False, 0.97, True),
        (True, True, True, 1.036, False, 1.15, False),
        (True, True, True, 1.06, False, 0.97, False),
        (True, True, False, 1.01, True, 1.0, False),
        (False, True, True, 1.01, True, 1.0, False),  # those of accelerometers are not asked
        (True, False, True, 1.01, True, 1.0, False),  # an estimated noise holds what it was estimated from
    ],
)
def test_one_coefficient_is_enough_where_it_leaves_noise_of_swings_and_whole_records(
    ways, monkeypatch, rotation, declared, found, left, chance, whole, enough
):
    ways.declared, ways.chance, ways.whole = declared, chance, whole
    plain, term = path_of(), path_of("learned[restitution_side]")
    monkeypatch.setattr(searching, "terms", lambda block: ("all of them",))
    monkeypatch.setattr(searching, "over_noise", lambda setup, trial: left)
    monkeypatch.setattr(searching, "unexplained", lambda setup: 1.05)
    plain.swing.model = SimpleNamespace(declared=None)

    def search(simulator, onto, pool, tell, leading=False):
        assert onto is plain and pool == ("all of them",)
        return Round(onto, [term] if found else [])

    monkeypatch.setattr(searching, "search", search)
    setup = setup_of(rotation)
    setup.simulator = None
    assert ways.asked_for_a_term(setup, plain, lambda text: None) is enough


@pytest.mark.parametrize(
    ("beside", "said"),
    [
        # Friction of guides beside a centre of mass off the middle; a sensor that is not linear needs no names.
        (("a", "learned[friction]"), searching.ONE_BESIDE),
        (("learned[reading cubic]",), searching.ONE_TERM),
        ((), searching.ONE_FORM),
    ],
)
def test_floors_are_not_tried_where_a_coefficient_beside_what_was_found_or_a_form_leaves_nothing(ways, beside, said):
    ways.explains = ways.chance = False
    ways.accepted = {((), True): path_of("a")}
    ways.beside, ways.form = path_of(*beside) if beside else None, path_of("learned[curve]")
    found = searched()
    assert found.term is (ways.beside or ways.form) and not any(not later for _, later, _ in ways.rounds)
    assert all(r.skipped == {"floor": said} for r in found.rounds)


@pytest.mark.parametrize(
    ("within", "curves", "form", "asked"),
    [
        # What a hysteretic layer promised, and a curve in its place: it is asked first of all.
        (4072.0, 3948.0, True, [["within"]]),
        (4072.0, 3948.0, False, [["within"], "beside", ["curves"]]),
        (4007.0, 3948.0, True, ["beside", ["within", "curves"]]),
        # And a magnet.
        (109.0, 3461.0, True, ["beside", ["curves", "within"]]),
        (109.0, -math.inf, True, ["beside", ["within"]]),
    ],
)
def test_what_goes_on_in_time_is_asked_first_where_it_promises_more(ways, within, curves, form, asked):
    ways.explains = ways.chance = False
    ways.accepted, ways.form = {((), True): path_of("a")}, path_of("learned") if form else None
    kinds = [searching._Kind("within", (), True, within), searching._Kind("curves", (), False, curves)]
    ways.kinds = sorted((k for k in kinds if k.promise > -math.inf), key=lambda k: -k.promise)
    found = searched()
    assert found.term is ways.form and ways.asked == asked


@pytest.mark.parametrize(
    ("chance", "left", "promises", "kept"),
    [
        (False, 1000.0, {"curves": 109.0, "within": 3461.0}, ["within", "curves"]),
        (False, 1000.0, {"curves": -1.0, "within": -math.inf}, ["curves", "within"]),
        # Air that is squeezed out from under a block: swings left what chance does, and no form could pay for itself.
        (True, 1000.0, {"curves": -6.0, "within": 12.0}, []),
        (True, 1000.0, {"curves": 61.0, "within": 59.0}, ["curves"]),
        # A path that explains 100 of them already has to be outdone by far.
        (True, 900.0, {"curves": 161.0, "within": 159.0}, ["curves"]),
    ],
)
def test_forms_are_asked_that_promise_something(ways, monkeypatch, chance, left, promises, kept):
    """Where much is left they promise roughly, and are asked all the same."""
    plain, path = path_of(chi2=1000.0), path_of("a", chi2=left)
    plain.swing.model, plain.swing.windows = SimpleNamespace(declared=None), ()
    times = []

    def promise(simulator, onto, pool, share):
        assert onto is plain
        times.append(share)
        return promises[pool]

    monkeypatch.setattr(searching, "promise", promise)
    monkeypatch.setattr(searching, "profiles", lambda block, windows: "curves")
    monkeypatch.setattr(searching, "inner", lambda block, released: "within")
    monkeypatch.setattr(searching, "by_chance", lambda setup, trial: chance and trial is plain)
    setup = setup_of(True)
    setup.simulator = SimpleNamespace(tests=[])
    found = ways.kinds_of_forms(setup, plain, SimpleNamespace(last=path, whole=SimpleNamespace(rms=2.0)))
    assert [kind.pool for kind in found] == kept
    assert times == [searching.SURELY if chance else 1.0] * 2


def test_a_coefficient_ahead_of_what_was_found_ends_the_search_for_names(ways):
    """Edges that crumble: it left 1.07 of the swings, and two effects that stood in for it 1.12 after 400 s."""
    ways.explains = ways.chance = False
    ways.accepted, ways.ahead = {((), True): path_of("a")}, path_of("learned[rounded_edges, wearing evenly]")
    found = searched()
    assert found.term is ways.ahead and not any(not later for _, later, _ in ways.rounds)
    assert all(r.skipped == {"floor": searching.ONE_AHEAD} for r in found.rounds)


@pytest.mark.parametrize(
    ("change", "taken"),
    [
        pytest.param({}, True, id="swings and whole records prefer it"),
        pytest.param({"found": False}, False, id="no coefficient"),
        pytest.param({"chi2": 945.0}, False, id="swings do not prefer it by far"),
        pytest.param({"preferred": False}, False, id="whole records do not prefer it"),
        pytest.param({"slips": True}, False, id="swings of what slips do not say"),
        pytest.param({"costly": True}, False, id="a floor was found"),
        pytest.param({"floors": "not asked"}, False, id="releases were not asked of floors"),
        pytest.param({"floors": "on top"}, False, id="they were asked on top of an effect alone"),
    ],
)
def test_a_coefficient_is_ahead_where_swings_and_whole_records_prefer_it(ways, monkeypatch, change, taken):
    told = SimpleNamespace(found=True, chi2=500.0, preferred=True, slips=False, costly=False, floors="refused")
    vars(told).update(change)
    plain, term = path_of(), path_of("learned", chi2=told.chi2)
    path = path_of("a", "b", chi2=1000.0, costly=told.costly)
    onto = path_of("a") if told.floors == "on top" else plain
    refused = {"floor": "another reason" if told.floors == "not asked" else searching.NOT_OF_RELEASES}
    monkeypatch.setattr(searching, "slips", lambda trial: told.slips)
    monkeypatch.setattr(searching, "remembering_all", lambda setup, trial, whole: (trial, whole))
    monkeypatch.setattr(
        searching, "explains_more",
        lambda setup, one, other: told.preferred and one.of == ("learned",) and other == "path's",
    )  # fmt: skip

    on_the_way = SimpleNamespace(last=path, whole="path's", trials=[plain, path])
    rounds_of_it = [Round(onto, skipped=refused)]
    found = ways.asked_ahead(setup_of(True), on_the_way, rounds_of_it, lambda: term if told.found else None)
    assert found is (term if taken else None)


@pytest.mark.parametrize(
    ("change", "taken"),
    [
        pytest.param({}, True, id="it leaves nothing"),
        pytest.param({"names": ()}, False, id="nothing was found"),
        pytest.param({"slips": True}, False, id="swings of what slips do not say"),
        pytest.param({"rotation": False}, False, id="accelerometers"),
        pytest.param({"declared": False}, False, id="estimated noise"),
        pytest.param({"found": False}, False, id="no coefficient"),
        pytest.param({"chi2": 945.0}, False, id="it does not pay"),
        # A sensor that is not linear left 3900 by itself, and 3932 beside two names.
        pytest.param({"alone": 555.0}, "alone", id="it needs no names"),
        pytest.param({"alone": None}, True, id="it leads nowhere without the names"),
        pytest.param({"left": 1.06}, False, id="it leaves structure"),
        pytest.param({"whole": 1.31}, False, id="it misses whole records"),
        pytest.param({"preferred": False}, False, id="whole records do not prefer it"),
        # A late base of 0.00 (-0.05 to 0.02) ms stood beside a mass off the middle and a restitution by the shaking.
        pytest.param({"less": 530.0}, "less", id="it does not need one of the names"),
        pytest.param({"less": 530.0, "refused": True}, True, id="whole records need that name"),
    ],
)
def test_a_coefficient_is_taken_beside_what_was_found_where_it_leaves_nothing(ways, monkeypatch, change, taken):
    told = SimpleNamespace(names=("a",), slips=False, rotation=True, declared=True, found=True, chi2=500.0, left=1.01)
    told.whole, told.preferred, told.alone, told.less, told.refused = 1.0, True, 565.0, 565.0, False
    vars(told).update(change)
    ways.declared, ways.whole, ways.chance = told.declared, told.whole, True
    path, term = path_of(*told.names, chi2=1000.0), path_of(*told.names, "learned", chi2=told.chi2)
    plain, alone = path_of(), path_of("learned", chi2=told.alone)
    less = path_of("b", "learned", chi2=told.less)
    if "less" in change:  # of two names the first one
        path, term = path_of("a", "b", chi2=1000.0), path_of("a", "b", "learned", chi2=told.chi2)
        monkeypatch.setattr(searching, "taken_out", lambda setup, plain, trial, k: less if k == 0 else alone)
    else:
        without = path_of("learned", chi2=told.alone or 1e9)
        monkeypatch.setattr(searching, "taken_out", lambda setup, plain, trial, k: without)
    monkeypatch.setattr(searching, "slips", lambda trial: told.slips)
    monkeypatch.setattr(searching, "by_itself", lambda simulator, onto: "all" if onto is path else "none")
    monkeypatch.setattr(searching, "open_to", lambda trial, pool: [pool] if trial is path else [])
    monkeypatch.setattr(searching, "over_noise", lambda setup, trial: told.left)
    monkeypatch.setattr(searching, "unexplained", lambda setup: 1.05)
    monkeypatch.setattr(
        searching,
        "explains_more",
        lambda setup, one, other: told.refused if other is not path else told.preferred and one.of == term.names,
    )

    def search(simulator, onto, pool, tell, repeated=False, leading=False):
        if onto is plain:
            assert pool == [term.parts[-1]]
            return Round(onto, [alone] if told.alone else [])
        assert (onto, pool, repeated, leading) == (path, ["all"], True, True)
        return Round(onto, [term] if told.found else [])

    monkeypatch.setattr(searching, "search", search)
    setup = setup_of(told.rotation)
    setup.simulator = None
    on_the_way = SimpleNamespace(last=path, whole=path)
    found = ways.asked_beside(setup, plain, on_the_way, lambda text: None)
    assert found is {True: term, False: None, "alone": alone, "less": less}[taken]


@pytest.mark.parametrize(
    ("change", "taken"),
    [
        pytest.param({}, True, id="it leaves nothing"),
        pytest.param({"rotation": False}, False, id="accelerometers"),
        pytest.param({"declared": False}, False, id="estimated noise"),
        pytest.param({"chance": True}, False, id="swings leave no more than chance and whole records nothing"),
        # Air that is squeezed out left 1.00 of the swings without it, and 5.8 times the noise of whole records.
        pytest.param({"chance": True, "missed": 5.8}, True, id="swings leave no more than chance"),
        pytest.param({"found": False}, False, id="no form"),
        pytest.param({"found": ("within", True)}, True, id="no curve"),
        pytest.param({"chi2": 995.0}, False, id="swings hardly prefer it"),
        pytest.param({"left": 1.06}, False, id="it leaves structure"),
        pytest.param({"whole": 1.31}, False, id="it misses whole records"),
        pytest.param({"refused": True}, False, id="whole records prefer the path"),
        # A joint whose friction grows with the lean: two coefficients left 1.00 of the swings, a curve of ten no less.
        pytest.param({"few": 495.0}, False, id="swings prefer a coefficient or two"),
        pytest.param({"few": 495.0, "prefer": True}, True, id="whole records prefer the form to them"),
        pytest.param({"few": 505.0}, True, id="a coefficient or two explain less"),
    ],
)
def test_a_form_is_taken_where_it_leaves_noise_of_swings_and_whole_records(ways, monkeypatch, change, taken):
    told = SimpleNamespace(rotation=True, found=True, chi2=500.0, left=1.01, whole=1.0, refused=False, declared=True)
    told.chance, told.missed, told.few, told.prefer = False, 1.2, None, False
    vars(told).update(change)
    ways.declared, ways.whole, ways.chance = told.declared, told.whole, told.chance
    monkeypatch.setattr(searching, "by_chance", lambda setup, trial: trial is not path or told.chance)
    plain, path, form = path_of(), path_of("a", "b", chi2=1000.0), path_of("learned", chi2=told.chi2)
    plain.swing.model, plain.swing.windows = SimpleNamespace(declared=None), ()
    monkeypatch.setattr(searching, "profiles", lambda block, windows: "curves")
    monkeypatch.setattr(searching, "inner", lambda block, released: ("within", released))
    monkeypatch.setattr(searching, "over_noise", lambda setup, trial: told.left)
    monkeypatch.setattr(searching, "unexplained", lambda setup: 1.05)
    monkeypatch.setattr(
        searching,
        "explains_more",
        lambda setup, one, other: (
            told.prefer if other.of == ("one or two",) else told.refused and one is its_whole and other.of == form.names
        ),
    )
    asked = []

    def search(simulator, onto, pool, tell, leading=False):
        assert onto is plain
        asked.append(pool)
        return Round(onto, [form] if told.found == pool or told.found is True else [])

    monkeypatch.setattr(searching, "search", search)
    its_whole = SimpleNamespace(rms=told.missed)
    on_the_way, setup = SimpleNamespace(last=path, whole=its_whole), setup_of(told.rotation)
    setup.simulator = SimpleNamespace(tests=[SimpleNamespace(kind="forced"), SimpleNamespace(kind="free")])
    few = None if told.few is None else path_of("one or two", chi2=told.few)
    monkeypatch.setattr(searching, "promise", lambda simulator, onto, pool, times: 1.0 * (pool == "curves"))
    kinds = ways.kinds_of_forms(setup, plain, on_the_way)
    found = ways.asked_for_a_form(setup, plain, on_the_way, kinds, lambda: few, lambda text: None, False)
    assert found is (form if taken else None)
    # What goes on in time is asked where curves do not explain it.
    if told.rotation and told.declared and (not told.chance or told.missed > searching.MISSED):
        ended = (taken or told.few is not None) and told.found is True  # they beat what goes on in time, too
        assert asked == (["curves"] if ended else ["curves", ("within", True)])
    else:
        assert asked == []


@pytest.mark.parametrize(
    ("behind", "wide_whole", "prefers", "taken"),
    [
        # Air that is squeezed out: a wide curve met swings best, by 20 of chi-square, and a finer one whole records.
        (0.9, 1.6, True, "fine"),
        (1.1, 1.6, True, None),
        # A magnet: a wide one met whole records to 1.02 times their noise, a finer one to 0.94.
        (0.9, 1.02, True, "fine"),
        (0.9, 1.02, False, "wide"),
        (1.1, 1.02, True, "wide"),
    ],
)
def test_of_forms_that_swings_do_not_tell_apart_whole_records_choose(
    ways, monkeypatch, behind, wide_whole, prefers, taken
):
    wide, fine = path_of("wide", chi2=500.0), path_of("fine", chi2=500.0 + behind * searching.PAYS)
    plain, path = path_of(), path_of("a", "b", chi2=1000.0)
    plain.swing.model, plain.swing.windows = SimpleNamespace(declared=None), ()
    monkeypatch.setattr(searching, "by_chance", lambda setup, trial: trial is not path)
    monkeypatch.setattr(searching, "profiles", lambda block, windows: "curves")
    monkeypatch.setattr(searching, "inner", lambda block, released: "within")
    monkeypatch.setattr(searching, "over_noise", lambda setup, trial: 1.0)
    monkeypatch.setattr(searching, "unexplained", lambda setup: 1.05)

    def whole_fit(setup, trial):
        rms = 0.94 if trial is fine else wide_whole
        return SimpleNamespace(rms=rms, of=trial.names, best=None)

    def more(setup, one, other):
        return prefers and (one.of, other.of) == (fine.names, wide.names)

    monkeypatch.setattr(searching, "whole_fit", whole_fit)
    monkeypatch.setattr(searching, "explains_more", more)
    found = {"curves": [fine, wide], "within": []}
    monkeypatch.setattr(searching, "search", lambda s, onto, pool, tell, leading: Round(onto, found[pool]))
    kinds = [SimpleNamespace(what=pool, pool=pool) for pool in found]
    chosen = ways.asked_for_a_form(
        setup_of(True), plain, SimpleNamespace(last=path, whole=whole_of(ways, path)), kinds, lambda: None,
        lambda text: None, False,
    )  # fmt: skip
    assert chosen is {"fine": fine, "wide": wide, None: None}[taken]


@pytest.mark.parametrize(
    ("refused", "chance", "left", "preferred", "taken"),
    [
        # A mass on a spring in a block, by an outsider: 1.008 of swings, and one shaken record 3.8 times its noise.
        (True, True, 4.0, True, True),
        (False, True, 4.0, True, False),
        (True, False, 4.0, True, False),
        (True, True, 1.05, True, False),
        (True, True, 4.0, False, False),
    ],
)
def test_a_form_far_ahead_need_not_meet_whole_records_where_releases_refuse_floors(
    ways, monkeypatch, refused, chance, left, preferred, taken
):
    form, plain, path = path_of("mode", chi2=500.0), path_of(), path_of("a", "b", chi2=20000.0)
    ways.whole = 3.0
    monkeypatch.setattr(searching, "search", lambda s, onto, pool, tell, leading: Round(onto, [form]))
    monkeypatch.setattr(searching, "by_chance", lambda setup, trial: chance and trial is form)
    monkeypatch.setattr(searching, "over_noise", lambda setup, trial: left if trial is path else 1.008)
    monkeypatch.setattr(searching, "unexplained", lambda setup: 1.05)
    monkeypatch.setattr(searching, "explains_more", lambda setup, one, other: preferred and one.of == form.names)
    monkeypatch.setattr(searching, "one_is_lost", lambda whole: False)
    found = ways.asked_for_a_form(
        setup_of(True), plain, SimpleNamespace(last=path, whole=whole_of(ways, path)),
        [SimpleNamespace(what="within", pool="within")], lambda: None, lambda text: None, refused,
    )  # fmt: skip
    assert found is (form if taken else None)


def test_floors_are_not_tried_where_two_effects_leave_nothing(ways):
    ways.accepted = {((), True): path_of("a"), (("a",), True): (both := path_of("a", "b"))}
    both.swing.rms, ways.whole = 1.0, 1.29
    assert [t.names for t in searched().trials] == [(), ("a",), ("a", "b")]
    assert ways.rounds == [((), True, True), (("a",), True, False)]


# Whole records are rugged: one fit of them that is stuck is not what the effects leave.
MET = pytest.mark.parametrize("whole, from_many, asked", [(1.29, None, False), (1.31, 1.31, True), (1.31, 1.29, False)])


@MET
def test_floors_are_tried_where_two_effects_leave_nothing_of_swings_and_miss_whole_records(
    ways, whole, from_many, asked
):
    ways.whole, ways.from_many = whole, from_many
    ways.accepted = {((), True): path_of("a"), (("a",), True): path_of("a", "b")}
    searched()
    assert any(not later for _, later, _ in ways.rounds) == asked


@MET
def test_of_two_effects_of_a_block_that_slips_whole_records_say_whether_floors_are_asked(ways, whole, from_many, asked):
    ways.chance, ways.explains, ways.whole, ways.from_many = False, True, whole, from_many
    ways.accepted = {((), True): path_of("a"), (("a",), True): path_of("a", "slide")}
    searched()
    assert any(not later for _, later, _ in ways.rounds) == asked


@pytest.mark.parametrize("chance, explains", [(False, True), (True, False)])
def test_floors_are_tried_in_the_same_rounds_where_two_effects_leave_something(ways, chance, explains):
    ways.chance, ways.explains = chance, explains
    first, floor = path_of("a"), path_of("floor", costly=True)
    ways.accepted = {((), True): first, (("a",), True): path_of("a", "b"), ((), False): floor}
    found = searched()
    # A floor in the first round: what came after the other effect there is not asked again.
    assert [t.names for t in found.trials] == [(), ("floor",)]
    again = [entry for entry in ways.rounds if not entry[1]]
    # A third effect comes first, where none was asked for yet.
    assert again[: 2 - chance] == [*([] if chance else [(("a", "b"), False, False)]), ((), False, True)]
    # Two effects have to be enough at first.
    assert ((("a", "b")), True, False) not in ways.rounds or chance


def test_floors_come_on_top_of_the_same_effect_where_that_stays(ways):
    ways.chance = ways.explains = False
    first = path_of("a")
    ways.accepted = {((), True): first, ((), False): first, (("a",), False): path_of("a", "floor", costly=True)}
    assert [t.names for t in searched().trials] == [(), ("a",), ("a", "floor")]
    assert [entry for entry in ways.rounds if not entry[1]][:2] == [((), False, True), (("a",), False, True)]


def test_one_effect_that_leaves_nothing_needs_no_floor(ways):
    # Nor does the clean block; a sum of squares that is a little large by chance does not ask for one.
    ways.chance = False
    ways.accepted = {((), True): path_of("a")}
    assert [t.names for t in searched().trials] == [(), ("a",)] and all(later for _, later, _ in ways.rounds)
    ways.explains = False
    ways.put_off = ()
    searched()
    assert all(later for _, later, _ in ways.rounds)


@pytest.fixture
def springs(ways, monkeypatch):
    """A floor on springs that promises to explain all that no other effect does, and does."""
    ways.promises, ways.chance, ways.whole = True, False, 1.0
    ways.roughly = False
    floor = path_of("springs", costly=True)
    ways.accepted = {((), True): path_of("a"), ((), False): floor, (("a",), False): path_of("a", "springs")}
    monkeypatch.setattr(searching, "explains", lambda setup, trial, whole: ways.explains and trial is floor)
    monkeypatch.setattr(searching, "roughly_begun", lambda setup, trial, whole: ways.roughly)
    return ways


def test_a_floor_that_explains_all_by_itself_ends_the_search_before_others_are_asked(springs):
    found = searched()
    assert [t.names for t in found.trials] == [(), ("springs",)]
    assert springs.rounds == [((), False, True)]
    springs.explains, springs.roughly = False, True
    assert searched().last.names == ("springs",)


@pytest.mark.parametrize(
    "change",
    [
        pytest.param({"promises": False}, id="not of some swings"),
        pytest.param({"promises": True, "explains": False}, id="it leaves as much as another effect"),
        pytest.param({"declared": False}, id="the noise is estimated"),
        pytest.param({"nothing": [("a",)]}, id="another effect leaves nothing of the swings"),
        pytest.param({"nothing": [()]}, id="the calibrated block leaves nothing of the swings"),
        pytest.param({"whole": 1.31}, id="it misses whole records"),
        pytest.param({"explains": False}, id="it leaves something of the swings"),
    ],
)
def test_others_are_asked_first_where_a_floor_does_not_explain_all(springs, change):
    springs.trials = {(): [path_of("a")]}
    for name, value in change.items():
        setattr(springs, name, value)
    searched()
    assert ((), True, True) in springs.rounds


@pytest.fixture
def told(ways, monkeypatch):
    """Releases that tell of a floor, by what it is tried on top of, where swings leave something."""
    ways.explains = ways.chance = False
    ways.promises = True  # which is not asked
    ways.of_releases, ways.onto, ways.gain = {}, [], 0.5
    ways.accepted = {((), True): path_of("a")}
    floor = SimpleNamespace(name="floor", costly=True, effect="floor")
    monkeypatch.setattr(searching, "all_candidates", lambda model, friction: (floor,))
    monkeypatch.setattr(searching, "tell_of_floors", lambda setup: True)
    monkeypatch.setattr(searching, "gain", lambda setup, without, whole: ways.gain)

    def from_releases(setup, onto, pool, tell):
        ways.onto.append(onto.names)
        assert [c.name for c in pool] == ["floor"]
        found = ways.of_releases.get(onto.names)
        return found and (found, whole_of(ways, found))

    monkeypatch.setattr(searching, "from_releases", from_releases)
    return ways


def test_a_floor_that_meets_all_releases_ends_the_search_where_it_stands_alone(told):
    told.of_releases[()], told.alone = path_of("floor", costly=True), [("floor",)]
    found = searched()
    assert [t.names for t in found.trials] == [(), ("floor",)]
    assert told.onto == [()] and told.rounds == []
    assert [t.names for t in found.rounds[0].trials] == [("floor",)] and not found.rounds[0].put_off


@pytest.mark.parametrize("gained", [None, searching.LEAST_GAIN])
def test_no_floor_is_tried_on_swings_where_releases_tell_of_none(told, gained):
    if gained is not None:
        told.of_releases, told.gain = {(): path_of("floor", costly=True)}, gained
    found = searched()
    assert found.last.names == ("a",)
    assert all(later for _, later, _ in told.rounds)
    # Alone it was asked first, and last on top of what was found.
    assert told.onto == [(), ("a",)]
    assert [r.skipped["floor"] for r in found.rounds] == [searching.NOT_OF_RELEASES] * 2


def test_releases_are_asked_of_a_floor_on_top_of_the_first_effect(told):
    told.of_releases[("a",)], told.alone = path_of("a", "floor", costly=True), [("a", "floor")]
    found = searched()
    assert [t.names for t in found.trials] == [(), ("a",), ("a", "floor")]


@pytest.mark.parametrize(
    ("whole", "nothing", "better", "asked"),
    [
        # Springs of 10 MN/m, of which swings are met by another effect and whole records are not.
        (1.4, [("a",)], True, [()]),
        # As well as these meet whole records a floor is asked again when all else was.
        (1.4, [("a",)], False, [(), ()]),
        # What whole records are met by is not doubted, nor is a floor the reason of what the block leaves nothing of.
        (1.29, [("a",)], True, [()]),
        (1.4, [(), ("a",)], True, [()]),
    ],
)
def test_a_floor_is_asked_where_another_effect_explains_swings_alone(told, monkeypatch, whole, nothing, better, asked):
    told.trials, told.nothing, told.whole = {(): [path_of("a")]}, nothing, whole
    told.of_releases[()], told.alone = path_of("floor", costly=True), [("floor",)]
    monkeypatch.setattr(searching, "explains_more", lambda setup, one, other: better and one.of == ("floor",))
    late: list[bool] = []
    monkeypatch.setattr(searching, "_one_term_is_enough", lambda setup, plain, tell: bool(late.append(True)))
    assert searched().last.names == ("floor",)
    assert told.onto == asked
    at_once = whole > 1.3 and nothing == [("a",)] and better
    # A second effect is asked before it, and all else where the floor is asked last.
    assert len(told.rounds) == 2 and (not late) is at_once


@pytest.mark.parametrize("left", [False, True])
def test_no_floor_is_asked_behind_an_effect_where_a_second_one_leaves_nothing(told, monkeypatch, left):
    """Worn edges and a damping: the first one alone leaves nothing of swings, and misses whole records."""
    told.trials, told.nothing, told.whole = {(): [path_of("a")]}, [("a",)], 1.4
    told.accepted = {((), True): path_of("a"), (("a",), True): path_of("a", "b")}
    told.of_releases[()], told.alone = path_of("floor", costly=True), [("floor",)]
    monkeypatch.setattr(searching, "explains_more", lambda setup, one, other: one.of == ("floor",))
    monkeypatch.setattr(searching, "_leaves_nothing", lambda setup, path: path.last.names == ("a", "b") and not left)
    monkeypatch.setattr(searching, "_nothing_is_left", lambda setup, path: not left)
    assert searched().last.names == (("floor",) if left else ("a", "b"))
    assert told.onto == ([()] if left else [])


def test_a_floor_that_explains_by_far_more_than_others_is_gone_on_from(springs, monkeypatch):
    springs.promises, springs.explains = True, False
    springs.trials = {(): [path_of("a", chi2=1000.0)]}
    springs.accepted[((), False)] = floor = path_of("springs", costly=True, chi2=330.0)
    springs.accepted[((), True)] = path_of("a", chi2=1000.0)
    springs.accepted[(("springs",), False)] = on = path_of("springs", "a", costly=True, chi2=300.0)
    springs.accepted[(("a",), True)] = pair = path_of("a", "b", chi2=290.0)
    plain = path_of(chi2=2000.0)

    def found():
        springs.rounds.clear()
        return searching.traced(setup_of(True), plain, lambda text: None)

    floor_and_quick = [(), ("springs",), (), ("a",)]
    assert [t.names for t in found().trials] == [(), ("springs",), ("springs", "a")]
    assert [onto for onto, *_ in springs.rounds] == floor_and_quick
    # What is quickly tried is not asked at all where the floor leaves nothing with what it is gone on from to.
    monkeypatch.setattr(searching, "explains", lambda setup, trial, whole: trial is on)
    assert found().last is on
    assert [onto for onto, *_ in springs.rounds] == [(), ("springs",)]
    # Two other effects that serve better by far take its place; floors are tried on top of them last of all.
    monkeypatch.setattr(searching, "explains", lambda setup, trial, whole: False)
    pair.swing.chi2 = 100.0
    found()
    assert [onto for onto, *_ in springs.rounds][:4] == floor_and_quick and len(springs.rounds) > 4
    # It is not gone on from where fits to the end do not bear out what some swings promised.
    floor.swing.chi2 = 340.0
    found()
    assert [onto for onto, *_ in springs.rounds][:2] == [(), ()]


def test_a_floor_that_leaves_no_more_than_chance_ends_the_search_where_whole_records_are_not_missed_by_far(springs):
    """Springs of 9 MN/m left 1.0055 times the noise of swings, and of whole records 1.313 times theirs."""
    springs.whole, springs.chance = 1.313, True
    assert searched().last.names == ("springs",)
    assert springs.rounds == [((), False, True)]


def test_a_floor_that_explains_swings_and_misses_whole_records_is_not_gone_on_from(springs):
    springs.promises, springs.whole = True, 2.0
    springs.trials = {(): [path_of("a", chi2=1000.0)]}
    springs.accepted[((), False)].swing.chi2 = 100.0
    searching.traced(setup_of(True), path_of(chi2=2000.0), lambda text: None)
    assert ((), True, True) in springs.rounds


def test_no_floor_is_asked_where_one_coefficient_without_a_name_leaves_nothing(springs, monkeypatch):
    """Floors take a minute or two, the coefficient a quarter of that; it explains more than effects with a name do."""
    springs.promises, springs.explains = True, False
    springs.trials = {(): [path_of("a", chi2=1000.0)]}
    springs.accepted[((), False)] = path_of("springs", costly=True, chi2=100.0)
    coefficient, other, seen = (path_of("term", chi2=500.0), object()), object(), []

    def without_names(setup, plain, first, pool, found, tell):
        seen.append((first.last.names, found))
        return other

    monkeypatch.setattr(searching, "_coefficient", lambda setup, plain, lead: coefficient)
    monkeypatch.setattr(searching, "_without_names", without_names)
    assert searching.traced(setup_of(True), path_of(chi2=2000.0), lambda text: None) is other
    assert seen == [(("a",), coefficient)] and not any(not later for _, later, _ in springs.rounds)


def test_whole_records_are_asked_after_all_where_names_stay_beside_such_a_coefficient(ways, monkeypatch):
    ways.trials = {(): [path_of("a", chi2=1000.0)]}
    ways.accepted, ways.explains = {((), True): path_of("a")}, False
    term = path_of("term", chi2=900.0), object()
    monkeypatch.setattr(searching, "_coefficient", lambda setup, plain, lead: term)
    monkeypatch.setattr(searching, "_without_names", lambda *_: None)
    searching.traced(setup_of(True), path_of(chi2=2000.0), lambda text: None)
    assert ways.by_swings[:2] == [True, False] and not any(ways.by_swings[2:])
    assert ways.rounds[:2] == [((), True, True)] * 2
    # Where swings do not tell a name from the coefficient, whole records are asked at once.
    term[0].swing.chi2 = 950.0
    ways.by_swings.clear()
    searching.traced(setup_of(True), path_of(chi2=2000.0), lambda text: None)
    assert not any(ways.by_swings)


def test_one_effect_that_slips_puts_no_floor_off(ways):
    """What it leaves is a median over the windows."""
    ways.chance = False
    ways.accepted = {((), True): path_of("slide"), ((), False): path_of("floor", costly=True)}
    assert [t.names for t in searched().trials] == [(), ("floor",)]
    ways.whole = 1.2  # whole records are explained
    assert [t.names for t in searched().trials] == [(), ("slide",)]


def test_rounds_are_gone_on_with_where_whole_records_made_the_trial_anew(ways, monkeypatch):
    """As the same effects, fitted alike; what they brought in besides is left to them again."""
    ways.explains = False
    ways.accepted = {((), True): path_of("a"), ((), False): path_of("a"), (("a",), True): path_of("a", "adhesion")}
    begun = []
    one_round = rounds._round

    def noted(setup, onto, whole, pool, tell, known, later, by_swings):
        begun.append(known and [t.names for t in known.trials])
        return one_round(setup, onto, whole, pool, tell, known, later, by_swings)

    monkeypatch.setattr(rounds, "_round", noted)
    searched()
    assert ways.rounds[-2:] == [((), False, True), (("a",), False, True)]
    assert begun[-2:] == [[("a",)], []]


@pytest.fixture
def stand_in(ways, monkeypatch):
    """The effect `both` explains by itself most of what `a` and `b` do together, and nothing is left to add to it.

    Before any effect chi-square is 10,000.  `a` and `b` came near `both`, by more than half of what that explains;
    `half` did not, `slow` takes long, and a second form of `a` is worse than the first.
    """
    sizes = {"both": 1000.0, "a": 1200.0, "b": 3000.0, "half": 5600.0}
    first = {name: path_of(name, chi2=chi2) for name, chi2 in sizes.items()}
    form = path_of("a", chi2=1300.0)
    form.names = ("a[form]",)
    ways.pair = path_of("a", "b", chi2=500.0)
    ways.plain, ways.first = path_of(chi2=10000.0), first
    ways.trials = {(): [form, path_of("slow", chi2=1100.0, costly=True), *reversed(first.values())]}
    ways.accepted = {((), True): first["both"], (("a",), True): ways.pair}
    ways.put_off, ways.by_rotation, ways.enough = (), True, ways.pair
    ways.whole_prefers, ways.whole = None, 1.0
    monkeypatch.setattr(rounds, "by_chance", lambda setup, trial: len(trial.names) == 2)
    monkeypatch.setattr(searching, "by_chance", lambda setup, trial: trial is ways.enough)
    for module in (rounds, searching):
        monkeypatch.setattr(module, "explains", lambda setup, trial, whole: trial is ways.enough)
    monkeypatch.setattr(
        searching, "explains_more", lambda setup, one, other: one.of == ways.whole_prefers != other.best
    )
    monkeypatch.setattr(searching, "whole_fit_from_many", lambda setup, trial, whole: ways.again(trial))
    ways.again = lambda trial: whole_of(ways, trial)

    def search():
        ways.rounds.clear()
        return searching.traced(setup_of(ways.by_rotation), ways.plain, lambda text: None)

    ways.searched = search
    return ways


def ontos(found):
    return [r.onto.names for r in found.rounds]


def test_where_something_is_left_the_search_goes_back_to_what_came_near_the_first(stand_in):
    found = stand_in.searched()
    assert [t.names for t in found.trials] == [(), ("a",), ("a", "b")]
    assert [fit.of for fit in found.fits] == [t.names for t in found.trials]
    # What leaves nothing ends the search: `b` is not gone on from.
    assert [onto for onto, *_ in stand_in.rounds] == [(), ("both",), ("a",), ("a", "b")]
    # The rounds of the path that is taken come first, one for each effect, and none is lost.
    assert ontos(found) == [(), ("a",), ("a", "b"), ("both",)]
    assert found.said == ("Both explains most by itself, A with B explain more together",)


@pytest.mark.parametrize(
    ("change", "back"),
    [
        pytest.param({}, False, id="nothing left"),
        pytest.param({"by_chance": False}, True, id="more than by chance, and less than structure"),
        pytest.param({"whole": 1.4}, True, id="whole records missed"),
        pytest.param({"whole": 1.4, "by_rotation": False}, False, id="those of accelerometers"),
        # Less is known of what is left: what would be structure counts, and records that are missed by far.
        pytest.param({"by_chance": False, "whole": 1.4, "declared": False}, False, id="estimated noise"),
        pytest.param({"by_chance": False, "whole": 1.4, "slips": True}, False, id="slip"),
        pytest.param({"declared": False, "structure": True}, True, id="estimated noise and structure"),
        pytest.param({"slips": True, "structure": True}, True, id="slip and structure"),
    ],
)
def test_little_is_enough_to_go_back(stand_in, monkeypatch, change, back):
    """What stands in for two effects leaves little of them."""
    both = stand_in.first["both"]
    monkeypatch.setattr(searching, "by_chance", lambda setup, trial: change.get("by_chance", True))
    for module in (rounds, searching):
        monkeypatch.setattr(module, "explains", lambda setup, trial, whole: not change.get("structure", False))
    stand_in.whole, stand_in.declared = change.get("whole", 1.0), change.get("declared", True)
    stand_in.by_rotation = change.get("by_rotation", True)
    both.parts[0].slips = change.get("slips", False)
    stand_in.searched()
    assert (("a",) in [onto for onto, *_ in stand_in.rounds]) is back


def test_two_at_the_most_are_gone_on_from_and_none_that_explains_less_than_half(stand_in):
    stand_in.enough = None
    stand_in.searched()
    assert [onto for onto, *_ in stand_in.rounds] == [(), ("both",), ("a",), ("a", "b"), ("b",)]
    # Less than half of what the best one does, in place of `b`, and then one of three that are near enough.
    stand_in.first["b"].swing.chi2 = 5501.0
    stand_in.searched()
    assert ("b",) not in [onto for onto, *_ in stand_in.rounds]
    for name in ("b", "half"):
        stand_in.first[name].swing.chi2 = 5499.0
    stand_in.searched()
    assert len([onto for onto, *_ in stand_in.rounds if onto in (("b",), ("half",))]) == 1


def test_what_does_not_pay_or_is_there_already_is_not_gone_on_from(stand_in):
    # Nine parts in ten of the best one, and no more than 60 of chi-square.
    stand_in.enough = None
    stand_in.plain.swing.chi2, stand_in.first["a"].swing.chi2 = 1056.0, 1004.0
    stand_in.searched()
    assert [onto for onto, *_ in stand_in.rounds] == [(), ("both",)]
    stand_in.plain.swing.chi2, stand_in.first["a"].swing.chi2 = 10000.0, 1200.0
    stand_in.accepted[("both",), True] = path_of("both", "a", chi2=900.0)
    stand_in.searched()
    assert [onto for onto, *_ in stand_in.rounds] == [(), ("both",), ("both", "a"), ("b",)]


@pytest.mark.parametrize(
    ("chi2", "prefers", "by_rotation", "taken"),
    [
        pytest.param(500.0, None, True, True, id="swings"),
        pytest.param(500.0, ("both",), True, False, id="whole records against it"),
        pytest.param(500.0, ("both",), False, True, id="accelerometers, whose whole records say little"),
        pytest.param(945.0, None, True, False, id="too little"),
        pytest.param(945.0, ("a", "b"), True, True, id="too little, whole records for it"),
        pytest.param(1055.0, ("a", "b"), True, True, id="whole records alone"),
        pytest.param(1065.0, ("a", "b"), True, False, id="whole records, swings against it"),
        pytest.param(945.0, ("a", "b"), False, False, id="too little, accelerometers"),
    ],
)
def test_swings_or_whole_records_have_to_speak_for_the_way_back_by_far(stand_in, chi2, prefers, by_rotation, taken):
    stand_in.pair.swing.chi2, stand_in.whole_prefers, stand_in.by_rotation = chi2, prefers, by_rotation
    stand_in.pair.swing.samples = stand_in.first["both"].swing.samples = 2000
    found = stand_in.searched()
    assert found.last.names == (("a", "b") if taken else ("both",))
    assert sorted(ontos(found)) == [(), ("a",), ("a", "b"), ("both",)]
    left = next(r for r in found.rounds if r.onto.names == ("a",))
    if taken:
        assert found.said == ("Both explains most by itself, A with B explain more together",)
    elif chi2 == 500.0:
        assert found.said == ("A with B would explain more of the swings than Both; whole records speak against it",)
        assert left.refused == (stand_in.pair,) and not left.trials
    else:
        assert found.said == ()


def test_what_whole_records_would_refuse_is_fitted_to_them_from_more_starts_first(stand_in):
    stand_in.pair.swing.chi2, stand_in.whole_prefers = 945.0, ("a", "b")
    assert stand_in.searched().last.names == ("a", "b")
    # From another start the one effect explains them as well.
    stand_in.again = lambda trial: SimpleNamespace(rms=1.0, of=trial.names, best=("a", "b"))
    assert stand_in.searched().last.names == ("both",)


def test_a_path_that_has_all_of_another_and_more_is_not_taken(stand_in):
    """What it has more was tried on top of the other one and did not pay, or whole records spoke against it."""
    stand_in.accepted[("a",), True] = path_of("a", "both", chi2=500.0)
    assert stand_in.searched().last.names == ("both",)


def test_by_far_is_by_more_where_more_is_left(stand_in):
    """60 times chi-square over the samples, as for one effect more."""
    stand_in.pair.swing.chi2, stand_in.pair.swing.samples = 500.0, 60
    assert stand_in.searched().last.names == ("both",)  # 500 less, of 60 * 500 / 60
    stand_in.pair.swing.samples = 61
    assert stand_in.searched().last.names == ("a", "b")


def test_what_swings_do_not_tell_apart_is_said(stand_in):
    stand_in.pair.swing.chi2 = 990.0
    assert stand_in.searched().said == ("swings do not tell A with B from Both",)
    stand_in.whole_prefers = ("a", "b")
    assert stand_in.searched().said == ("swings do not tell Both from A with B; whole records speak for the latter",)


def test_the_search_does_not_go_back_where_nothing_is_left_or_nothing_pays(stand_in):
    both = stand_in.first["both"]
    stand_in.accepted, stand_in.enough = {((), True): both}, both
    stand_in.searched()
    assert [onto for onto, *_ in stand_in.rounds] == [(), ("both",)]
    for found in stand_in.trials[()]:
        found.swing.chi2 = 9999.0
    stand_in.accepted = {}
    stand_in.searched()
    assert [onto for onto, *_ in stand_in.rounds] == [()]


def test_what_whole_records_refused_is_gone_on_from_where_swings_speak_for_it(stand_in):
    """A string beside a loss that grows with speed: by itself it spoils records that the ideal block met by chance."""
    del stand_in.accepted[(), True]
    found = stand_in.searched()
    assert [t.names for t in found.trials] == [(), ("a",), ("a", "b")]
    assert [onto for onto, *_ in stand_in.rounds] == [(), ("both",), ("a",), ("a", "b")]
    # What is refused on top of it as well leaves the search where it was.
    stand_in.accepted = {}
    assert [t.names for t in stand_in.searched().trials] == [()]


@pytest.fixture
def floors(stand_in):
    """The same where floors were put off, and all paths leave something."""
    stand_in.put_off, stand_in.enough = (SimpleNamespace(name="floor"),), None
    stand_in.accepted[(), False] = stand_in.first["both"]
    return stand_in


@pytest.mark.parametrize("floor", [100.0, 455.0])
def test_floors_have_to_serve_better_than_what_going_back_found(floors, floor):
    """What they do beside the greedy path is no reason to lose the other one."""
    floors.accepted[("both",), False] = path_of("both", "floor", costly=True, chi2=floor)
    floors.accepted[("a",), False] = floors.pair
    found = floors.searched()
    names = ("both", "floor") if floor < 440.0 else ("a", "b")
    assert [t.names for t in found.trials] == [(), names[:1], names]
    assert ontos(found)[:2] == [(), names[:1]]
    assert set(ontos(found)) == {(), ("both",), ("a",), ("a", "b"), ("b",)}
    assert len(found.rounds) == 5
    # Of each round it is said whether floors were tried on top of it.
    said = {r.onto.names: r.skipped.get("floor") for r in found.rounds}
    assert said.pop(("b",)) == searching.NOT_ON_TOP
    assert set(said.values()) == {None}


@pytest.mark.parametrize(
    ("leaves_nothing", "whole", "again"), [(True, 1.0, 3.0), (True, 2.0, 1.2), (True, 2.0, 1.4), (False, 1.0, 1.0)]
)
def test_a_third_effect_is_asked_for_before_floors_and_has_to_leave_nothing(
    floors, monkeypatch, leaves_nothing, whole, again
):
    """Nothing of the swings but by chance, and whole records met; these are fitted from more starts if they are not."""
    floors.again = lambda trial: SimpleNamespace(rms=again, of=trial.names, best=None)
    monkeypatch.setattr(rounds, "by_chance", lambda setup, trial: False)
    third = floors.accepted[("a", "b"), False] = path_of("a", "b", "c", chi2=300.0)
    floors.enough, floors.whole = third if leaves_nothing else None, whole
    found = floors.searched()
    asked_of_floors = any(known and not later for _, later, known in floors.rounds)
    assert asked_of_floors == (not leaves_nothing or min(whole, again) > 1.3)
    if not asked_of_floors:
        assert found.last is third and ontos(found)[:3] == [(), ("a",), ("a", "b")]
        assert {r.skipped.get("floor") for r in found.rounds if r.put_off} == {searching.NOT_ON_TOP}


def test_floors_are_tried_on_top_of_the_first_effect_of_the_way_back(floors):
    floors.accepted[("a",), False] = path_of("a", "floor", costly=True, chi2=200.0)
    assert floors.searched().last.names == ("a", "floor")


def test_nothing_is_tried_on_top_of_a_floor_that_stands_alone_nor_beside_it(floors):
    """A corner that bounced for long was found after 440 s, and something else looked for until 900 s had gone."""
    floors.accepted[(), False] = path_of("floor", costly=True, chi2=100.0)
    floors.alone = [("floor",)]
    found = floors.searched()
    assert found.last.names == ("floor",)
    assert [onto for onto, later, _ in floors.rounds if not later] == [()]


def test_floors_beside_the_greedy_path_are_kept_where_going_back_led_nowhere(floors):
    """As before: they were put to swings and whole records when they were tried."""
    del floors.accepted[("a",), True]
    floors.accepted[("both",), False] = path_of("both", "floor", costly=True, chi2=990.0)
    assert floors.searched().last.names == ("both", "floor")


def test_one_effect_alone_that_was_left_in_the_first_round_is_not_taken_by_going_back(stand_in):
    """Swings would have taken it at first; what is asked of whole records there is more."""
    stand_in.enough = None
    stand_in.first["a"].swing.chi2 = 400.0
    del stand_in.accepted[("a",), True]
    assert stand_in.searched().last.names == ("both",)


def test_what_either_way_through_a_round_tried_is_kept_in_the_round(floors):
    """Whole records brought `adhesion` in at first, the second time it was not asked for."""
    floors.accepted = {((), True): path_of("adhesion", chi2=700.0), ((), False): path_of("floor", chi2=500.0)}
    found = floors.searched()
    assert found.last.names == ("floor",)
    names = [t.names for t in found.rounds[0].trials]
    assert len(names) == len(set(names))
    assert {("adhesion",), ("floor",), ("a",), ("both",)} <= set(names)
    # Without effects nothing was put off any more; after `adhesion` floors were not tried.
    assert found.rounds[0].put_off == () and "floor" not in found.rounds[0].skipped
    (after,) = (r for r in found.rounds if r.onto.names == ("adhesion",))
    assert after.skipped == {"floor": searching.NOT_ON_TOP}


def test_the_trial_that_is_taken_is_itself_in_its_round(floors):
    """The second way through a round may fit the same effect anew; rivals are compared with the one that is taken."""
    floors.accepted[(), False] = path_of("a", chi2=1200.0)
    floors.accepted[("both",), False] = path_of("both", "floor", chi2=990.0)
    found = floors.searched()
    assert found.last is floors.pair
    for tried, trial in zip(found.rounds, found.trials[1:], strict=False):
        assert sum(t.names == trial.names for t in tried.trials) == 1
        assert any(t is trial for t in tried.trials)
    # After the last effect too there is all that was tried.
    floors.trials[("a", "b")] = [path_of("a", "b", "c", chi2=495.0)]
    floors.accepted[("a",), False] = floors.pair
    last = floors.searched().rounds[2]
    assert last.onto is floors.pair and not last.put_off


def test_one_effect_that_is_taken_is_not_said_to_explain_more_together(floors):
    floors.accepted[(), False] = path_of("floor", costly=True, chi2=100.0)
    found = floors.searched()
    assert found.last.names == ("floor",) and found.said == ()


def test_what_was_left_explains_most_by_itself_only_if_it_does(stand_in):
    """Whole records may have brought it in before one that explains more of the swings."""
    stand_in.trials[()].append(path_of("c", chi2=990.0))
    found = stand_in.searched()
    assert found.last.names == ("a", "b") and found.said == ()


@pytest.fixture
def term(stand_in, monkeypatch):
    """One coefficient without a name leaves nothing; `both` leaves something, with the smooth `b` on top of it too."""
    found = path_of("learned[side]", chi2=450.0)
    names = ("both", "a", "b", "rough")
    pool = [SimpleNamespace(name=n, effect=n, smooth=n != "rough", in_swings=True, costly=False) for n in names]
    stand_in.pools, stand_in.enough = [], None
    stand_in.accepted = {((), True): stand_in.first["both"], (("both",), True): path_of("both", "b", chi2=600.0)}
    stand_in.put_off = (SimpleNamespace(name="floor"),)
    stand_in.left, stand_in.found, stand_in.its_whole = 1.01, found, 1.0
    one_round = rounds._round

    def noted(setup, onto, whole, pool, tell, known, later, by_swings):
        stand_in.pools.append([c.name for c in pool])
        return one_round(setup, onto, whole, pool, tell, known, later, by_swings)

    def search(simulator, onto, pool, tell, leading=False):
        assert onto is stand_in.plain and pool == ("those without a name",)
        return Round(onto, [stand_in.found] if stand_in.found else [])

    monkeypatch.setattr(rounds, "_round", noted)
    monkeypatch.setattr(searching, "all_candidates", lambda model, friction: tuple(pool))
    monkeypatch.setattr(searching, "_coefficient", stand_in.coefficient)
    monkeypatch.setattr(searching, "by_itself", lambda simulator, trial: ("those without a name",))
    monkeypatch.setattr(searching, "search", search)
    monkeypatch.setattr(searching, "over_noise", lambda setup, trial: stand_in.left)
    monkeypatch.setattr(searching, "unexplained", lambda setup: 1.05)
    monkeypatch.setattr(
        searching,
        "whole_fit",
        lambda setup, trial: (
            SimpleNamespace(rms=stand_in.its_whole, of=trial.names, best=None)
            if trial is found
            else whole_of(stand_in, trial)
        ),
    )
    stand_in.plain.swing.model = SimpleNamespace(declared=None)

    def searched():
        stand_in.rounds.clear()
        stand_in.pools.clear()
        setup = setup_of(stand_in.by_rotation)
        setup.simulator = None
        return searching.traced(setup, stand_in.plain, lambda text: None)

    stand_in.searched = searched
    return stand_in


def test_where_one_coefficient_leaves_nothing_that_smooth_effects_leave_the_search_ends(term):
    found = term.searched()
    assert found.term is term.found
    # On top of the first effect smooth ones alone were tried, and no way back was gone.
    assert [onto for onto, *_ in term.rounds] == [(), ("both",)]
    assert term.pools == [["both", "a", "b", "rough"], ["both", "a", "b"]]
    assert [t.names for t in found.trials] == [(), ("both",), ("both", "b")]
    # Of effects that swings only hint at whole records were not asked.
    assert term.by_swings == [True, True]
    # Of each round it is said what was not tried, and why.
    assert [set(r.skipped) for r in found.rounds] == [{"floor"}, {"floor", "rough"}]
    assert all(why == searching.ONE_TERM for r in found.rounds for why in r.skipped.values())
    assert not any(r.put_off for r in found.rounds)


@pytest.mark.parametrize(("nothing", "explains"), [((), False), ([("both",)], False), ([("both",)], True)])
def test_one_coefficient_is_asked_unless_an_effect_with_a_name_explains_swings_and_whole_records(
    term, monkeypatch, nothing, explains
):
    """Once: at first where all leave something of the swings, else where whole records are missed.

    explains: whether the effect that leaves nothing of the swings explains whole records as well.
    """
    asked, coefficient = [], searching._coefficient

    def counted(setup, plain, lead):
        asked.append(plain)
        return coefficient(setup, plain, lead)

    monkeypatch.setattr(searching, "_coefficient", counted)
    term.nothing, term.explains = nothing, explains
    term.enough = term.first["both"] if explains else None
    assert (term.searched().term is term.found) is (not explains)
    assert len(asked) == (not explains)


@pytest.mark.parametrize(
    ("change", "asked"),
    [
        pytest.param({"by_rotation": False}, False, id="accelerometers"),
        pytest.param({"declared": False}, False, id="estimated noise"),
        pytest.param({"found": None}, False, id="no coefficient"),
        pytest.param({"found": path_of("learned[side]", chi2=9950.0)}, False, id="it does not pay"),
        pytest.param({"left": 1.06}, False, id="it leaves structure"),
        pytest.param({"its_whole": 1.31}, False, id="it misses whole records"),
        pytest.param({"pair": True}, True, id="smooth effects leave nothing"),
        pytest.param({"found": path_of("learned[side]", chi2=541.0)}, True, id="swings do not prefer it by far"),
        pytest.param({"whole_prefers": ("both", "b")}, True, id="whole records refuse it"),
    ],
)
def test_names_are_searched_for_to_the_end_unless_the_coefficient_has_all_for_it(term, change, asked):
    """asked: whether smooth effects were tried on top of the first one before."""
    term.left = 1.01
    if change.pop("pair", False):
        term.enough = term.accepted[("both",), True]
    for name, value in change.items():
        setattr(term, name, value)
    found = term.searched()
    assert found.term is None
    assert ["both", "a", "b"] in term.pools if asked else ["both", "a", "b"] not in term.pools
    assert term.pools[-1] == ["both", "a", "b", "rough"]


def test_two_names_that_explain_all_give_way_to_one_coefficient_that_whole_records_prefer(term):
    """A plate of 13 Hz was named as pitch with a late record: 1.03 was left of the swings, 1.9 of whole records."""
    term.enough, term.whole_prefers = term.accepted[("both",), True], ("learned[side]",)
    assert term.searched().term is term.found


@pytest.mark.parametrize(("many", "taken"), [(False, True), (True, False)])
def test_two_names_that_swings_hardly_refuse_give_way_as_well(term, monkeypatch, many, taken):
    """Two effects stood in for a restitution that differs by side: worse by 56 in swings, by far in whole records.

    many: whether the two meet whole records after all, begun from more starts.
    """
    term.enough, term.found.swing.chi2 = term.accepted[("both",), True], 541.0
    again = SimpleNamespace(rms=1.0, of=("both", "b"), best=None)
    monkeypatch.setattr(searching, "whole_fit_from_many", lambda setup, trial, whole: again if many else whole)
    monkeypatch.setattr(
        searching, "explains_more", lambda setup, one, other: one.of == ("learned[side]",) and other is not again
    )  # fmt: skip
    assert (term.searched().term is term.found) is taken


@pytest.mark.parametrize(("left", "its_whole", "taken"), [(1.3, 1.0, True), (5.8, 1.014, True), (1.3, 1.2, False)])
def test_behind_a_sensor_with_play_whole_records_say_what_swings_leave(term, left, its_whole, taken):
    """Play of 2.2 mrad left 1.22 of the noise of swings, of 4.8 mrad 5.8: where they begin is told but roughly."""
    term.left, term.its_whole = left, its_whole
    term.found.parts[0].parameters = (SimpleNamespace(name=remaining.PLAY),)
    assert (term.searched().term is term.found) is taken


def test_a_first_effect_that_explains_all_stands_beside_a_coefficient_that_leaves_nothing(term):
    term.enough = term.first["both"]
    assert term.searched().term is None


def test_where_no_effect_was_accepted_one_coefficient_may_be_the_answer(term):
    term.accepted = {}
    found = term.searched()
    assert found.term is term.found
    assert [t.names for t in found.trials] == [()] and [onto for onto, *_ in term.rounds] == [()]
