"""The public verb for assemblies: bodies on a moving table, carried through time in chunks of compiled steps.

Source  Winkler, Meguro & Yamazaki (1995)
Status  see the package head
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import asdict

import numpy as np

from dem import checks
from dem.assembly import Assembly
from dem.assembly_history import AssemblyHistory
from dem.assembly_settings import ContactJudgement, Criteria
from dem.assembly_skin import default_skin, longest_step
from dem.assembly_stability import assembly_critical_step
from dem.materials import Contact, Contacts
from dem.simulate import MOST_STEPS
from dem.table_motion import Motion, check_motion

SAFE_SHARE = 0.25  # default step, as a share of the critical one
SAMPLES = 2000  # about as many are kept unless the caller says otherwise


def simulate_assembly(
    assembly: Assembly,
    motion: Motion | None = None,
    *,
    t_end: float,
    contact: Contacts,
    dt: float | None = None,
    onset: str = "located",
    coulomb: str = "total",
    g: float = 9.80665,
    settle: bool | None = None,
    judgement: ContactJudgement | None = None,
    criteria: Criteria | None = None,
    pitch_about: tuple[float, float] = (0.0, 0.0),
    save_every: int | None = None,
    watch_every: int | None = None,
    keep: Sequence[int | str] | None = None,
    workers: int = 1,
    progress: bool | Callable[[float], object] = False,
) -> AssemblyHistory:
    """Simulate an assembly on a table that moves with `motion`, until a body falls or t_end.

    motion: called with times [s], float64, shape (step,); returns (a_x, a_z) [m/s^2] of the point `pitch_about` of the
        table, each of that shape. Where it has a method `pitch(t) -> (angle [rad], acceleration [rad/s^2])`, clockwise
        positive, table and walls turn about that point. None is a table at rest
    t_end: duration [s]; the run ends with the first step at or after it
    contact: parameters of all contacts, or a mapping of pairs of materials to parameters
    dt: step [s]; None: a quarter of the critical one (`assembly_critical_step`), less where bodies that fall could pass
        through each other in a step
    onset: 'located', 'overlap' or 'incremental', see `dem.contact_forces`
    coulomb: 'total': friction reaches mu times spring and dashpot together; 'spring': mu times the spring's force
    g: gravity [m/s^2], 0 allowed
    settle: let the bodies sink into their springs under gravity alone, with Cundall's local damping, before the run;
        None: where the assembly says that it stands
    judgement: when corners count as touching, when contacts are updated; criteria: what ends a run and what is noted
    pitch_about: point about which the table pitches [m]
    save_every: steps between samples (default: about 2,000 samples); keep: numbers or names of the bodies whose motion
        is kept (default: all)
    watch_every: steps between looks at the interfaces (default: about 1 ms)
    workers: threads that share the work of each step; the result is the same, to the bit
    progress: True shows a bar; a function is called with the time reached [s] after each chunk of steps

    An interrupt (Ctrl-C) ends the run and keeps what has been computed; so does a motion that blows up and a body that
    leaves the scene.
    Raises ValueError for a bad argument, for a motion of wrong shape or not finite, for dt at or above the critical
    step, and where a standing assembly does not come to rest under gravity alone.
    """
    checks.kind("assembly", assembly, Assembly, "an Assembly, as column(3, b, h, d, density) makes it")
    check_motion(motion)
    judgement = ContactJudgement() if judgement is None else judgement
    criteria = Criteria() if criteria is None else criteria
    checks.kind("judgement", judgement, ContactJudgement, "a ContactJudgement, or None")
    checks.kind("criteria", criteria, Criteria, "a Criteria, or None")
    if settle is not None and checks.real(settle) not in (0.0, 1.0):
        raise ValueError(f"settle={settle!r}: want True, False or None")
    checks.positive("t_end", t_end, "s")
    checks.not_negative("g", g, "m/s^2")
    if checks.numbers("pitch_about", pitch_about).shape != (2,):
        raise ValueError(f"pitch_about={pitch_about!r} m: want two numbers, x and z")
    for name, value in zip(("pitch_about x", "pitch_about z"), pitch_about, strict=True):
        checks.finite(name, value, "m")
    _one_of("onset", onset, ("located", "overlap", "incremental"))
    _one_of("coulomb", coulomb, ("total", "spring"))
    limit = assembly_critical_step(assembly, contact)
    dt = _step(dt, limit, min(longest_step(assembly, g, default_skin(assembly)), t_end))
    if t_end / dt > MOST_STEPS:
        raise ValueError(f"t_end={t_end} s, dt={dt} s: want at most {MOST_STEPS:g} steps")
    last_step = max(1, math.ceil(t_end / dt * (1.0 - 1e-12)))
    save_every = max(1, last_step // SAMPLES) if save_every is None else _whole("save_every", save_every)
    watch_every = max(1, round(1e-3 / dt)) if watch_every is None else _whole("watch_every", watch_every)
    settings: dict[str, float | str] = {
        "dt": dt, "critical_step": limit, "t_end": t_end, "g": g, "onset": onset, "coulomb": coulomb,
        "settle": float(assembly.standing if settle is None else settle), "save_every": save_every,
        "watch_every": watch_every, "pitch_about_x": float(pitch_about[0]), "pitch_about_z": float(pitch_about[1]),
        "workers": _whole("workers", workers), "contact": _describe(contact),
    }  # fmt: skip
    settings |= {f"judgement_{name}": _plain(value) for name, value in asdict(judgement).items()}
    settings |= {f"criteria_{name}": _plain(value) for name, value in asdict(criteria).items()}
    kept = _kept(assembly, keep)
    from dem.assembly_run import Run  # numba is slow to load

    table = assembly.contact_table(contact)
    run = Run(assembly, table, judgement, criteria, settings, last_step, kept)
    if settings["settle"]:
        run.settle()
    return run.through(motion, progress)


def _step(dt: float | None, limit: float, longest: float) -> float:
    if dt is None:
        return min(SAFE_SHARE * limit, longest)
    checks.positive("dt", dt, "s")
    if dt >= limit:
        raise ValueError(f"dt={dt} s: want a step below {limit:.6g} s, where this assembly becomes unstable")
    return float(dt)


def _one_of(name: str, value: str, choices: Sequence[str]) -> None:
    if value not in choices:
        wanted = " or ".join(filter(None, (", ".join(map(repr, choices[:-1])), repr(choices[-1]))))
        raise ValueError(f"{name}={value!r}: want {wanted}")


def _whole(name: str, value: int) -> int:
    return checks.whole(name, value, 1, 4096 if name == "workers" else 2**62)


def _kept(assembly: Assembly, keep: Sequence[int | str] | None) -> tuple[int, ...]:
    """Numbers of the bodies whose motion is kept."""
    if keep is None:
        return tuple(range(len(assembly.bodies)))
    numbers = []
    if isinstance(keep, str) or not isinstance(keep, Iterable):
        raise ValueError(f"keep={keep!r}: want a list of numbers or names of bodies")
    for item in keep:
        if isinstance(item, str) and item in assembly.names:
            numbers.append(assembly.names.index(item))
        elif isinstance(item, (int, np.integer)) and 0 <= item < len(assembly.bodies):
            numbers.append(int(item))
        else:
            raise ValueError(f"keep={item!r}: want the number or name of one of the {len(assembly.bodies)} bodies")
    return tuple(numbers)


def _plain(value: float | str | None) -> float | str:
    return "default" if value is None else value


def _describe(contact: Contacts) -> str:
    if isinstance(contact, Contact):
        return repr(contact)
    return "; ".join(f"{first} on {second}: {law!r}" for (first, second), law in contact.items())
