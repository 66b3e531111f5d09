"""What no candidate explains: the residual learned as a term, one coefficient after the other.

Each coefficient of `rocking.effects.learned_term`, a drift of restitution from test to test, the curves of
`rocking.effects.learned_curve`, `rocking.effects.learned_damping` and `rocking.effects.learned_friction`, the
restitution with a memory of `rocking.effects.learned_memory`, what is off in a rotation sensor of
`rocking.effects.learned_reading` and its clock of `rocking.effects.learned_timing`, the plate of
`rocking.effects.learned_base`, what a base sensor loses of
`rocking.effects.learned_coupling`, the mass inside of `rocking.effects.learned_mode`, the torque that lags of
`rocking.effects.learned_hysteresis` and what pushes at the same times of every test (`studies.loop.swings.pushing`)
are parameters whose default is nothing, fitted with the same machinery as the effects; so are changes of effects with a
name in the course of a campaign (`studies.loop.swings.changing`).
The greedy search stops when the next one does not lower the residual by `LEAST_GAIN`, nor most of what is
over the noise.

Status   two modes, two of what swings, yields or remembers at once, and a curve beside what swings or yields, are
         outside of the span.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from rocking import G_STANDARD
from rocking.effects.learned_curve import EVEN, ODD
from rocking.effects.learned_damping import DAMPING
from rocking.effects.learned_friction import FRICTION
from rocking.effects.learned_reading import MARKS
from studies.campaigns import DeclaredBlock
from studies.campaigns.swings import OPEN
from studies.loop.models.candidates import OF_THE_ROTATION_SENSOR, Candidate, candidates
from studies.loop.models.model import CHANGE, DRIFT, FADING
from studies.loop.models.parameters import Parameter
from studies.loop.observed.windows import SIDE, Window
from studies.loop.runs.simulation import Simulator
from studies.loop.swings.changing import changing
from studies.loop.swings.pushing import pushing
from studies.loop.swings.tracing import search
from studies.loop.swings.trials import PAYS, Trial, bic, pays
from studies.loop.swings.trying import SOME, every_so_many, ranked_by_score

LEAST_GAIN = 0.03
"""Share by which the rms of the swings has to fall for one more coefficient."""

LEAST_LEFT = 0.98
"""Rms of the swings over what pure noise leaves of them that no term brings them below: two standard deviations."""

LITTLE_LEFT = 1.05
"""Rms of the swings over what pure noise leaves of them below which no forms are tried whose states go on from swing
to swing: their runs take long."""

MOST_TERMS = 4

MOST_ALIKE = 4
"""Forms that swings hardly tell from what was learned of them that whole records are asked about."""

MANY = 4
"""Coefficients of a form beyond which it is a curve that bends to much."""

FEW = 2
"""Coefficients and curves that are the better answer where they leave no more than noise, whatever else would."""

LEAST_OF_ALL = 0.5
"""Share of what is over the noise that `FEW` of them explain, or a curve that bends to much, or more are not looked
for: what acts is in no span."""

LITTLE = 0.2
"""The same share of a single one: of three things that act the greatest is a third."""

HOPELESS = 1
"""Coefficients after which half of what is to be reached has to be."""

TERM, CURVE, LOSS, RUBBING, MEMORY, READING, TIMING, RESPONSE, BASE, COUPLING, MODE, HYSTERESIS, PUSH = _EFFECTS = (
    "learned_term", "learned_curve", "learned_damping", "learned_friction", "learned_memory", "learned_reading",
    "learned_timing", "learned_response", "learned_base", "learned_coupling", "learned_mode", "learned_hysteresis",
    "learned_push",
)  # fmt: skip
LEARNED = (*_EFFECTS, CHANGE)
"""Effects that say how a residual looks and not what it comes from."""

WITH_A_NAME = frozenset(f"{TERM}.{name}" for name in ("bias", "damping", "drag", "base", "restitution_speed"))
"""Coefficients that are effects with a name."""

WITHIN = (MODE, HYSTERESIS)
"""Those of them that swing or yield, which goes on from swing to swing."""

FREEDOMS = (MEMORY, *WITHIN)
"""Those of them with states of their own, of which a block has one set."""

FURTHEST = 1.02
"""Where a curve ends, over the largest peak of the swings."""

NEAR_UPRIGHT = 0.2
"""And where one ends that acts near upright."""

MODES = 0.4 * 1.15 ** np.arange(24)
"""Circular frequencies over the block's p from which a mode is tried, up to 10: what swings for long, and far, is found
from no further off than a tenth."""

MODES_BEGUN = 4
"""Those of them that are begun from."""

SENSORS = (5.0, 15.0, 40.0)
"""Frequencies [Hz] at which fits of a slow sensor of the rotation begin."""

PLATES = (3.0, 5.0, 8.0, 13.0, 20.0, 32.0)
"""Frequencies from which a plate is tried [Hz]."""

RESONANCES = 1.2 ** np.arange(20)
"""Frequencies from which a table that resonates is tried, 1 to 32 Hz: closer, since such a resonance is sharp."""

RESONANCE = 0.05
"""Damping ratio from which it is tried."""

RESONANCES_FITTED = 2
"""Frequencies from which it is fitted."""

PLATES_FITTED = 3
"""Starts of it that are fitted: those that explain most as they are."""

HIGHEST = 2.0
"""Height of a mass inside over that of the centre of mass that is not passed."""

WEARS = (0.1, 1.0)
"""Use over that of the whole campaign in which a block may wear."""

WIDTHS = (0.02, 0.1, 0.5)
"""Strains over the slenderness angle at which something may slip."""

SHARPEST = 10.0
"""Exponent beyond which a slip is sudden."""

TIMES = (0.1, 0.5, 2.0)
"""Times over 1/p in which something may relax."""


def terms(block: DeclaredBlock) -> tuple[Candidate, ...]:
    """Every coefficient as a candidate, with sizes that a usual campaign would show."""
    p2, alpha = block.p() ** 2, block.alpha
    omega = 0.5 * block.p() * alpha
    torque = 0.02 * p2 * alpha
    sizes = {
        "bias": torque,
        "side": torque,
        "spring": torque / alpha,
        "cubic": torque / alpha**3,
        "friction": torque,
        "damping": torque / omega,
        "side_damping": torque / omega,
        "drag": torque / omega**2,
        "cubic_damping": torque / omega**3,
        "base": 0.01 * p2 / 9.81,
        "restitution_side": 0.01,
        "restitution_speed": 0.01 / omega,
        "restitution_square": 0.01 / omega**2,
        "structural": torque / alpha,
        "side_friction": torque,
        "outward": torque / omega,
    }
    found = {name: _term(f"{TERM}.{name}", size) for name, size in sizes.items()}
    # What rubs or drags on one side alone is half of each of two coefficients, neither of which tells much by itself.
    by_side = (
        Candidate(
            f"learned[{name} by side]", TERM, (*found[name].parameters, *found[f"side_{name}"].parameters), (), {}
        )
        for name in ("friction", "damping")
    )
    # Of a joint that is pressed harder the further it turns, at rest or not.
    rubbing = (*found["friction"].parameters, *found["structural"].parameters)
    growing = Candidate("learned[friction that grows]", TERM, rubbing, (), {})
    return (*found.values(), *by_side, growing, _term(DRIFT, 0.002), _fading())


def _fading() -> Candidate:
    """A restitution that goes to another one in the course of the campaign, as of contacts that bed in."""
    starts = tuple({DRIFT: size, FADING: fading} for fading in (0.15, 0.6) for size in (0.003, -0.003))
    own = Parameter(DRIFT, 0.002, -0.1, 0.1), Parameter(FADING, 0.3, 0.02, 3.0, log=True)
    return Candidate(f"{DRIFT}, fading", TERM, own, starts, {}, smooth=False)


def unnamed(block: DeclaredBlock) -> list[Candidate]:
    """Single coefficients that are none of the effects with a name."""
    return [c for c in terms(block) if not WITH_A_NAME & {p.name for p in c.parameters} or len(c.parameters) > 1]


def by_itself(simulator: Simulator, onto: Trial) -> list[Candidate]:
    """What has no name, is said by a number or two, or acts now and then alone, and may be all that acts."""
    declared, windows = onto.swing.model.declared, onto.swing.windows
    few = [c for c in readings(declared, windows) if len(c.parameters) == 1]
    between_them = *between(simulator, windows), *resonating(simulator, onto), *_changes(simulator, onto)
    pushes = pushing(simulator, onto)
    return [*unnamed(declared), *few, *answering(windows), *memories(declared, windows), *between_them, *pushes]


def _changes(simulator: Simulator, onto: Trial) -> list[Candidate]:
    """Effects with a name, and coefficients without one, that change in the course of the campaign."""
    read, declared = _rotation_was_read(onto.swing.windows), onto.swing.model.declared
    pool = [c for c in candidates(declared) if read or c.effect not in OF_THE_ROTATION_SENSOR]
    single = [c for c in unnamed(declared) if c.smooth and len(c.parameters) == 1 and c.parameters[0].name != DRIFT]
    return changing(simulator, onto, [*pool, *single])


def _term(full: str, size: float) -> Candidate:
    parameter = Parameter(full, size, -50.0 * size, 50.0 * size)
    name = full if full == DRIFT else f"learned[{full.partition('.')[2]}]"
    return Candidate(name, TERM, (parameter,), (), {})  # it enters linearly: nothing is start enough


def readings(block: DeclaredBlock, windows: Sequence[Window]) -> tuple[Candidate, ...]:
    """What a rotation sensor adds to the rotation, where one was read."""
    if not _rotation_was_read(windows):
        return ()
    sizes = {"square": 0.02 / block.alpha, "cubic": 0.02 / block.alpha**2, "drift": 0.001 * block.alpha * block.p()}
    sizes["base"] = 0.001 * block.alpha / (G_STANDARD * math.tan(block.alpha))
    series = [Parameter(f"{READING}.{name}", size, -10.0 * size, 10.0 * size) for name, size in sizes.items()]
    series.append(Parameter(f"{READING}.play", 0.002 * block.alpha, 0.0, 0.1 * block.alpha))
    found = [Candidate(f"learned[reading {p.name.partition('.')[2]}]", READING, (p,), (), {}) for p in series]
    size, ends = 0.005 * block.alpha, _as_far_as_read(READING, windows)
    for shape, n in (("smooth", 8), ("fine", 32)):
        own = tuple(Parameter(f"{READING}.{name}", size, -50.0 * size, 50.0 * size) for name in MARKS[: n + 1])
        fixed = {**ends, f"{READING}.intervals": float(n)}
        found.append(Candidate(f"learned[reading, {shape}]", READING, own, (), fixed))
    return tuple(found)


def _rotation_was_read(windows: Sequence[Window]) -> bool:
    return any(not w.accelerometers or any(c.kind == "rotation" and c is not SIDE for c in w.channels) for w in windows)


def answering(windows: Sequence[Window]) -> tuple[Candidate, ...]:
    """A rotation sensor that answers as a low-pass, where one was read."""
    if not _rotation_was_read(windows):
        return ()
    frequency, damping = f"{RESPONSE}.frequency", f"{RESPONSE}.damping_ratio"
    own = Parameter(frequency, 0.1, 0.5, 100.0, log=True), Parameter(damping, 0.3, 0.05, 10.0, log=True)
    starts = tuple({frequency: f, damping: 0.7} for f in SENSORS)
    return (Candidate("learned[slow sensor]", RESPONSE, own, starts, {}, smooth=False),)


def profiles(block: DeclaredBlock, windows: Sequence[Window]) -> tuple[Candidate, ...]:
    """Torques, dampings and frictions of any shape against rotation: near upright, or as far as the swings go.

    Torques and dampings alike on both sides or not, or with a shape of their own on either side, as frictions have:
    what acts on one side alone is half of each of two curves, neither of which tells much by itself.
    """
    p, alpha = block.p(), block.alpha
    torque = 0.02 * p**2 * alpha
    reach = min(FURTHEST * max(abs(w.theta) for w in windows), 0.5 * math.pi)
    shapes = (("near upright", NEAR_UPRIGHT, 4), ("smooth", 1.0, 4), ("fine to the middle", 0.5, 8), ("fine", 1.0, 16))
    kinds = (
        ("curve alike on both sides", CURVE, "odd_", ODD, torque),
        ("curve by side", CURVE, "even_", EVEN, torque),
        ("damping by rotation", LOSS, "", DAMPING, torque / (0.5 * p * alpha)),
    )
    found = []
    for label, effect, kind, names, size in kinds:
        for shape, share, n in shapes:
            own = tuple(Parameter(f"{effect}.{name}", size, -50.0 * size, 50.0 * size) for name in names[: n + 1])
            fixed = {f"{effect}.{kind}reach": share * reach, f"{effect}.{kind}intervals": float(n)}
            found.append(Candidate(f"learned[{label}, {shape}]", effect, own, (), fixed))
    curves = {c.name: c for c in found}
    for shape, _, n in shapes:
        if n > MANY:
            continue
        odd, even = (curves[f"learned[curve {kind}, {shape}]"] for kind in ("alike on both sides", "by side"))
        both, fixed = (*odd.parameters, *even.parameters), {**odd.fixed, **even.fixed}
        found.append(Candidate(f"learned[curve, each side its own, {shape}]", CURVE, both, (), fixed))
    for label, effect, names, size, end in (
        ("damping by rotation, each side its own", LOSS, DAMPING, torque / (0.5 * p * alpha), "reach"),
        ("friction by rotation", RUBBING, FRICTION, torque, "high"),
    ):
        ends = _as_far_as_read(effect, windows, end)
        if effect == LOSS and 0.0 in ends.values():
            continue  # of one side alone that by how far it leans says all
        for shape, n in (("smooth", 8), ("fine", 16)):
            own = tuple(Parameter(f"{effect}.{name}", size, -50.0 * size, 50.0 * size) for name in names[: n + 1])
            fixed = {**ends, f"{effect}.intervals": float(n)}
            found.append(Candidate(f"learned[{label}, {shape}]", effect, own, (), fixed))
    return tuple(found)


def _as_far_as_read(effect: str, windows: Sequence[Window], end: str = "high") -> dict[str, float]:
    """Ends of a curve: not further to one side than the block went; what nothing was read of would be anything."""
    peaks = [w.theta for w in windows]
    return {f"{effect}.low": FURTHEST * min(0.0, *peaks), f"{effect}.{end}": FURTHEST * max(0.0, *peaks)}


def memories(block: DeclaredBlock, windows: Sequence[Window]) -> tuple[Candidate, ...]:
    """A restitution that depends on the impacts before: how many in the test, how long ago, or on what all have worn.

    Those count that end a swing, as in a record: smaller ones are not seen there, and may be hundreds in a run.  Or on
    how the base is accelerated at an impact, in the sense in which the block falls or in either.
    """
    noise = max((float(w.noise.max()) for w in windows if not w.accelerometers), default=0.0)
    speed = {f"{MEMORY}.least_speed": block.p() * math.sqrt(2.0 * block.alpha * OPEN * noise)}
    found = []
    for label, depth, span, sizes in (
        ("of the first impacts", "first", "first_impacts", (2.0, 8.0)),
        ("after a short pause", "recent", "recent_time", (0.5 / block.p(), 1.5 / block.p())),
    ):
        d, w = f"{MEMORY}.{depth}", f"{MEMORY}.{span}"
        low, high = 0.25 * sizes[0], 4.0 * sizes[1]
        starts = tuple({d: size, w: width} for width in sizes for size in (0.01, -0.01))
        own = (Parameter(d, 0.01, -0.5, 0.5), Parameter(w, 0.3, low, high, log=True))
        found.append(Candidate(f"learned[restitution {label}]", MEMORY, own, starts, speed))
    d, w = f"{MEMORY}.worn", f"{MEMORY}.worn_use"
    for label, exponent in (("with each impact", 0.0), ("with what impacts took", 2.0)):
        most = max((window.struck.use(exponent) for window in windows), default=0.0)
        if most <= 0.0:
            continue
        starts = tuple({d: size, w: share * most} for share in WEARS for size in (0.02, -0.02))
        own = (Parameter(d, 0.01, -0.5, 0.5), Parameter(w, 0.3, 0.01 * most, 20.0 * most, log=True))
        fixed = {**speed, f"{MEMORY}.worn_exponent": exponent}
        found.append(Candidate(f"learned[restitution worn {label}]", MEMORY, own, starts, fixed))
    for label, name in (("pushed by the base", "pushed"), ("as the base is shaken", "shaken")):
        one = Parameter(f"{MEMORY}.{name}", 0.01 / (G_STANDARD * block.alpha), -0.05, 0.05)
        found.append(Candidate(f"learned[restitution {label}]", MEMORY, (one,), (), speed))
    return tuple(found)


def between(simulator: Simulator, windows: Sequence[Window]) -> tuple[Candidate, ...]:
    """Something between the shaking and its record, where a base was shaken: a plate that gives, a coupled sensor, or
    another clock than that of the rotation's record."""
    if not any(simulator.tests[test].kind == "forced" for test in {w.test for w in windows}):
        return ()
    frequency, damping = f"{BASE}.frequency", f"{BASE}.damping_ratio"
    own = Parameter(frequency, 0.1, 0.5, 100.0, log=True), Parameter(damping, 0.3, 1e-3, 3.0, log=True)
    starts = tuple({frequency: f, damping: share} for f in PLATES for share in (0.05, 0.5))
    plate = Candidate("learned[plate]", BASE, own, starts, {f"{BASE}.share": 1.0}, smooth=False, screened=PLATES_FITTED)
    corner = Parameter(f"{COUPLING}.corner_frequency", 0.02, 0.0, 10.0)
    clock = Parameter(f"{TIMING}.pace", 0.001, -0.1, 0.1), Parameter(f"{TIMING}.lag", 0.001, -0.2, 0.2)
    clocks = (
        Candidate(name, TIMING, own, (), {})
        for name, own in (
            ("learned[late]", clock[1:]),
            ("learned[clock]", clock[:1]),
            ("learned[clock, late]", clock),
        )
    )
    read = not any(w.accelerometers for w in windows)
    coupled = Candidate("learned[coupled base sensor]", COUPLING, (corner,), (), {})
    return plate, coupled, *(clocks if read else ())


def resonating(simulator: Simulator, onto: Trial) -> tuple[Candidate, ...]:
    """A table that resonates, where a base was shaken, begun from the frequencies that a score test ranks first.

    Its resonance is sharp, and from beside it no fit goes there; the size enters linearly.
    """
    windows = onto.swing.windows
    shaken = [i for i, w in enumerate(windows) if simulator.tests[w.test].kind == "forced"]
    if not shaken:
        return ()
    fitted = onto.swing.of([shaken[k] for k in every_so_many(len(shaken), SOME)])
    share, frequency, damping = (f"{BASE}.{name}" for name in ("share", "frequency", "damping_ratio"))
    size = Parameter(share, 0.05, -2.0, 0.9)
    starts = [{frequency: float(f), damping: RESONANCE, share: 0.0} for f in RESONANCES]
    models = {str(k): onto.swing.model.changed(start) for k, start in enumerate(starts)}
    best = ranked_by_score(simulator, fitted, (size,), models)[:RESONANCES_FITTED]
    own = Parameter(frequency, 0.1, 0.5, 100.0, log=True), Parameter(damping, 0.3, 1e-3, 3.0, log=True)
    begun = tuple(starts[int(k)] for k in best)
    return (Candidate("learned[table resonates]", BASE, (size, *own), begun, {}, smooth=False, scouts=(share,)),)


def inner(block: DeclaredBlock, released: bool) -> tuple[Candidate, ...]:
    """What goes on in time within a block or beside it: a mass that swings, something that slips or that creeps.

    None enters linearly but by its size, which is what is fitted first.

    released: whether a block was let go from a lean, to which it had been pulled.
    """
    H = block.centre_height
    # Within the block, and with less than the moment of inertia of the whole.
    heaviest = min(0.4, 0.8 * (block.I_c / block.mass + H**2) / ((HIGHEST * H) ** 2 + (0.5 * block.breadth) ** 2))
    p, alpha, moment = block.p(), block.alpha, block.mass * G_STANDARD * block.R
    size, height, frequency, damping = (
        f"{MODE}.{name}" for name in ("mass_ratio", "height_ratio", "frequency", "damping_ratio")
    )
    # What is little off in the centre of the block acts as much as all that swings in it.
    apart, hangs = f"{MODE}.apart", f"{MODE}.hanging"
    swinging = Candidate(
        "learned[mode]", MODE,
        (
            Parameter(size, 0.005, 0.0, heaviest), Parameter(height, 0.2, 0.0, HIGHEST),
            Parameter(frequency, 0.1, 0.02 * p, 3.0 * p, log=True), Parameter(damping, 0.3, 1e-3, 3.0, log=True),
            Parameter(apart, 0.3, 0.0, 1.0),
        ),
        tuple(
            {size: 0.005, height: 1.0, frequency: float(share) * p / (2.0 * math.pi), damping: 0.1, apart: 0.5}
            for share in MODES
        ),
        {hangs: 0.0}, smooth=False, scouts=(size,), scored=MODES_BEGUN,
    )  # fmt: skip
    hanging = replace(swinging, name="learned[mode, hanging]", fixed={hangs: 1.0}, after=swinging.name)
    size, width, time, strained, exponent = (
        f"{HYSTERESIS}.{name}" for name in ("stiffness", "width", "time", "strained", "exponent")
    )
    held = Parameter(size, 0.01 * moment, 0.0, 100.0 * moment)
    pulled = (Parameter(strained, 0.3, 0.0, 1.0),) if released else ()
    half = {strained: 0.5} if released else {}
    slipping = Candidate(
        "learned[hysteresis]", HYSTERESIS,
        (
            held, Parameter(width, 0.3, 1e-4 * alpha, 10.0 * alpha, log=True),
            Parameter(exponent, 0.3, 1.0, SHARPEST, log=True), *pulled,
        ),
        tuple({size: 0.02 * moment, width: share * alpha, exponent: 1.5, **half} for share in WIDTHS),
        {}, smooth=False, scouts=(size,),
    )  # fmt: skip
    creeping = Candidate(
        "learned[relaxation]", HYSTERESIS,
        (held, Parameter(time, 0.3, 1e-3 / p, 1e3 / p, log=True), *pulled),
        tuple({size: 0.02 * moment, time: share / p, **half} for share in TIMES),
        {}, smooth=False, scouts=(size,),
    )  # fmt: skip
    # What flows to the low side draws it further down, and at once does nothing: a spring that pushes, and yields.
    pushed = 0.02 * moment / block.I_O
    beside = Parameter(f"{TERM}.spring", pushed, -50.0 * pushed, 50.0 * pushed)
    flowing = replace(
        creeping, name="learned[relaxation beside a spring]", parameters=(*creeping.parameters, beside),
        starts=tuple({**start, beside.name: pushed, **(dict.fromkeys(half, 1.0))} for start in creeping.starts),
        after=creeping.name, also=(TERM,),
    )  # fmt: skip
    return swinging, hanging, slipping, creeping, flowing


def open_to(trial: Trial, pool: Sequence[Candidate]) -> list[Candidate]:
    """Those of a pool that have no parameter of the trial, and no states of their own beside what has some already.

    Nor curves of more than `MANY` coefficients beside what goes on from swing to swing, of which each run takes long.
    """
    fitted, within = {p.name for p in trial.parameters}, {effect for effect in trial.effects if effect in FREEDOMS}
    most = MANY if within & set(WITHIN) else math.inf
    return [
        c for c in pool
        if not fitted & {p.name for p in c.parameters} and (c.effect not in FREEDOMS or within <= {c.effect})
        and len(c.parameters) <= most
    ]  # fmt: skip


def learn(
    simulator: Simulator, onto: Trial, tell: Callable[[str], None], rival: Trial | None = None, going_on: bool = True
) -> Trial:
    """The trial with the coefficients that pay; itself if none does.

    rival: what has to be reached; the search ends early where it plainly is not.
    going_on: whether forms with states that go on from swing to swing are tried too, where `FEW` without leave more
        than noise, or are a curve and more; their runs take long.
    """
    declared, released = onto.swing.model.declared, any(test.kind == "free" for test in simulator.tests)
    at_hand = _at_hand(simulator, onto)
    known: dict[tuple[str, ...], Trial | None] = {}
    found = _grown(simulator, onto, [(at_hand, known)], tell, rival, FEW if going_on else MOST_TERMS)
    if not going_on or not (_laboured(onto, found) or (_more_to_learn(found) and _over_noise(found) >= LITTLE_LEFT)):
        return found
    return _grown(simulator, onto, [(at_hand, known), (inner(declared, released), {})], tell, rival, MOST_TERMS)


def _laboured(onto: Trial, found: Trial) -> bool:
    """Whether it took a curve with many coefficients and something else besides, so that less may say it as well."""
    learned = found.parts[len(onto.parts) :]
    return len(learned) > 1 and any(map(bends_much, learned))


def bends_much(part: Candidate) -> bool:
    """Whether it is a curve with many coefficients."""
    return len(part.parameters) > MANY and part.effect not in WITHIN


def _at_hand(simulator: Simulator, onto: Trial) -> tuple[Candidate, ...]:
    """What has no states that go on from swing to swing."""
    declared, windows = onto.swing.model.declared, onto.swing.windows
    forms = (c for form in (readings, profiles, memories) for c in form(declared, windows))
    between_them = *between(simulator, windows), *resonating(simulator, onto), *_changes(simulator, onto)
    return (*terms(declared), *forms, *answering(windows), *between_them, *pushing(simulator, onto))


def alike(simulator: Simulator, without: Trial, found: Trial, tell: Callable[[str], None]) -> list[Trial]:
    """What swings hardly tell from what was learned last, the best first.

    without: the trial without that.
    """
    last = found.parts[-1]
    others = [c for c in open_to(without, _at_hand(simulator, without)) if c.name != last.name]
    tried = search(simulator, without, others, tell, repeated=True, leading=True).trials
    near = [t for t in tried if bic(t.swing) < bic(found.swing) + PAYS]
    return sorted(near, key=lambda t: bic(t.swing))[:MOST_ALIKE]


def _grown(
    simulator: Simulator,
    onto: Trial,
    pools: Sequence[tuple[Sequence[Candidate], dict[tuple[str, ...], Trial | None]]],
    tell: Callable[[str], None],
    rival: Trial | None,
    most: int,
) -> Trial:
    """The trial with the best of the pools added to it, one after the other, as long as they pay.

    pools: each with what was the best of it on top of trials with such names; more is noted there.
    """
    current = onto
    for count in range(most):
        gained = onto.swing.chi2 - current.swing.chi2
        if rival is not None and count >= HOPELESS and gained < 0.5 * (onto.swing.chi2 - rival.swing.chi2):
            break
        if not _more_to_learn(current) or gained < _least(onto, current) * (onto.swing.chi2 - _noise(onto)):
            break
        for pool, known in pools:
            if current.names not in known:
                left = open_to(current, pool)
                known[current.names] = search(simulator, current, left, tell, repeated=True, leading=True).best
        bests = [known[current.names] for _, known in pools]
        best = min((t for t in bests if t is not None), key=lambda t: bic(t.swing), default=None)
        if best is None or not pays(current.swing, best.swing):
            break
        if not np.isfinite(best.swing.rms) or not _lowers(current, best):
            break
        current = best
    return current


def _lowers(current: Trial, best: Trial) -> bool:
    """Whether the rms of the swings falls by enough, or to less than half of the way to what noise leaves of them."""
    if best.swing.rms <= (1.0 - LEAST_GAIN) * current.swing.rms:
        return True
    return current.swing.chi2 - best.swing.chi2 >= LEAST_OF_ALL * (current.swing.chi2 - _noise(current))


def _least(onto: Trial, found: Trial) -> float:
    """Share of what is over the noise that was to be explained so far, for more to be looked for."""
    learned = found.parts[len(onto.parts) :]
    if len(learned) >= FEW or any(map(bends_much, learned)):
        return LEAST_OF_ALL
    return LITTLE if learned else 0.0


def says_much(onto: Trial, found: Trial) -> bool:
    """Whether what was learned explains as much of what is over the noise as something in the span should."""
    return onto.swing.chi2 - found.swing.chi2 >= LEAST_OF_ALL * (onto.swing.chi2 - _noise(onto))


def renames(trial: Trial) -> bool:
    """Whether it has a coefficient that is an effect with a name."""
    return any(p.name in WITH_A_NAME for p in trial.parameters)


def _more_to_learn(trial: Trial) -> bool:
    """Whether a term that lowers the rms of the swings enough would not bring it below that of noise."""
    return _over_noise(trial) * (1.0 - LEAST_GAIN) >= LEAST_LEFT


def _noise(trial: Trial) -> float:
    """Chi-square that pure noise leaves of the swings, whose states are fitted."""
    swings = trial.swing
    return float(swings.samples - 2 * len(swings.windows) - len(swings.parameters))


def _over_noise(trial: Trial) -> float:
    """Rms of the swings over what pure noise leaves of them."""
    left = _noise(trial) / max(trial.swing.samples, 1)
    return trial.swing.rms / math.sqrt(left) if left > 0.0 else math.inf
