"""A run of an assembly: arrays that the compiled loop carries from chunk to chunk, and what became of the bodies.

Source  none, own convention
Status  chunks and workers leave no trace in the result (tests)
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np
from tqdm import tqdm

from dem import arrays as q
from dem import assembly_setup, assembly_skin, assembly_step, assembly_threads, contact_forces, narrow_phase
from dem.arrays import Lists, Saved, Watched, lists_of
from dem.assembly import Assembly
from dem.assembly_history import AssemblyHistory, Ending, Fall, Separation
from dem.assembly_stability import all_touches
from dem.history import Energies
from dem.materials import ContactTable
from dem.motion_of_bodies import BLOWN_UP, FALLEN, LEFT, Field, Limits
from dem.table_motion import Motion, accelerations, frame_at, pitch_angle, pitches

if TYPE_CHECKING:
    from dem.assembly_settings import ContactJudgement, Criteria

HEADROOM = 10.0  # a run this many times faster than its forces can make it has blown up
LARGEST_WAY = 0.475  # two bodies come nearer by twice this share of the skin before contacts are listed again
SETTLING = 0.7  # share of the unbalanced force that works against the motion while bodies settle
AT_REST = 1e-8  # bodies have settled when the unbalanced force is below this share of their weight
SETTLING_STEPS = 400_000
SPEEDS = [q.VX, q.VZ, q.OMEGA]
ONSETS = {
    "located": contact_forces.LOCATED,
    "overlap": contact_forces.OVERLAPPING,
    "incremental": contact_forces.INCREMENTAL,
}


class Run:
    """State of a run; `settle` and `through` advance it."""

    def __init__(
        self,
        assembly: Assembly,
        table: ContactTable,
        judgement: ContactJudgement,
        criteria: Criteria,
        settings: dict[str, float | str],
        last_step: int,
        kept: tuple[int, ...],
    ) -> None:
        self.assembly, self.criteria, self.settings, self.last_step, self.kept = (
            assembly, criteria, settings, last_step, kept
        )  # fmt: skip
        self.dt, self.g, self.workers = float(settings["dt"]), float(settings["g"]), int(settings["workers"])
        self.movable = len(assembly.bodies)
        self.bodies = assembly_setup.bodies_of(assembly)
        self.outline = assembly_setup.outline_of(assembly)
        self.materials = assembly_setup.materials_of(assembly, table)
        skin = assembly_skin.default_skin(assembly) if judgement.skin is None else judgement.skin
        widest = assembly_skin.widest_skin(assembly)
        if skin > widest * (1.0 + 1e-9):
            raise ValueError(
                f"skin={skin:.6g} m: want at most {widest:.6g} m, half of the shortest edge or least breadth of the "
                "scene"
            )
        latest = min(LARGEST_WAY * skin, assembly_skin.way_of_turning(assembly, narrow_phase.LOOSE - judgement.facing))
        update_after = latest if judgement.update_after is None else judgement.update_after
        if update_after > latest:
            raise ValueError(f"update_after={update_after} m: want at most {latest:.6g} m in this scene with this skin")
        settings |= {"judgement_skin": skin, "judgement_update_after": update_after}
        self.judgement = narrow_phase.Judgement(
            skin, update_after, judgement.reach, judgement.end_slack, judgement.facing
        )
        self.rule = contact_forces.Rule(ONSETS[str(settings["onset"])], settings["coulomb"] == "spring")
        self.cell = assembly_setup.cell_size(assembly, skin)
        self.counts = np.zeros(8, np.int64)
        self.counters = np.zeros(16 * self.workers, np.int64)
        self.told = np.zeros(assembly_step.APART * self.workers, np.int64)
        least = assembly_skin.narrowest_skin(assembly, self.g, self.dt)
        if skin < least * (1.0 - 1e-9):
            raise ValueError(
                f"skin={skin:.6g} m: want at least {least:.6g} m, or a smaller step: bodies that move by more than "
                "that in a step may pass through each other"
            )
        self.limits = self._limits(math.inf, 0.0)
        self.speed = assembly_skin.natural_speed(assembly, self.g, self.limits.z_low)
        self.lists: list[Lists] = []
        self._take_room(assembly_setup.room_for(assembly))

    def _take_room(self, room: assembly_setup.Room) -> None:
        total = self.bodies.shape[1]
        self.lists = [assembly_setup.larger(old, total, room) for old in self.lists] or [
            lists_of(total, room.pairs, room.slots) for _ in range(2)
        ]
        self.room, self.grid = room, assembly_setup.grid_of(total, room)

    def _limits(self, speed: float, settling: float) -> Limits:
        corners = np.concatenate([thing.vertices for thing in self.assembly.things])
        low, high = corners.min(axis=0), corners.max(axis=0)
        margin = self.criteria.margin
        if margin is None:
            margin = 10.0 * float(np.hypot(*(high - low))) + 10.0
        drop = self.criteria.drop
        drops = np.array(
            [drop or 0.5 * assembly_skin.least_breadth(body.shape) for body in self.assembly.bodies], np.float64
        )
        return Limits(
            speed,
            float(low[0]) - margin,
            float(high[0]) + margin,
            float(low[1]) - margin,
            float(high[1]) + margin,
            self.criteria.tilt,
            drops,
            settling,
        )

    def _begin(self, samples: int) -> None:
        """Counts and sample space for a new series of steps."""
        column = np.full(self.bodies.shape[1], -1, np.int64)
        column[list(self.kept)] = np.arange(len(self.kept))
        self.saved = Saved(
            np.zeros(samples), np.zeros((samples, len(self.kept), 6)), np.zeros((samples, 7)), column
        )  # fmt: skip
        due, listed = self.counts[assembly_step.DUE], self.counts[assembly_step.LISTED]
        which = self.counts[assembly_step.WHICH]
        self.counts[:] = 0
        self.counts[assembly_step.UNTIL_SAVE], self.counts[assembly_step.WHICH] = 1, which
        self.counts[assembly_step.DUE], self.counts[assembly_step.LISTED] = due, listed

    def _advance(self, field: Field, clock: assembly_step.Clock) -> int:
        """One chunk; makes more room for lists until it suffices."""
        opening = assembly_step.Opening(self.criteria.gap, self.criteria.rotation)
        begun = int(self.counts[assembly_step.STEP])
        while True:
            done = int(self.counts[assembly_step.STEP]) - begun
            rest = field._replace(**{name: getattr(field, name)[done:] for name in ("x", "z", "rate", "turn")})
            arguments = (
                self.workers, self.counters, self.told, rest, self.bodies, self.outline, *self.lists, self.grid,
                self.cell, self.movable, self.materials, self.judgement, self.rule, self.limits, clock, opening,
                self.watched, self.saved, self.counts,
            )  # fmt: skip
            ending = assembly_threads.by_workers(self.workers, arguments)
            if ending != assembly_step.NO_ROOM:
                return ending
            self._take_room(self.room.doubled())

    def _chunk(self) -> int:
        """Steps between looks at the base motion, interrupts and the bar: about a tenth of a second."""
        return max(200, 100_000 // self.movable)

    def settle(self) -> None:
        """Let the bodies come to rest under gravity alone, by local damping; velocities given are kept for the run.

        Raises ValueError where they do not.
        """
        bodies, velocities = self.bodies, self.bodies[SPEEDS].copy()
        bodies[SPEEDS] = 0.0
        self._begin(2)
        self.counts[assembly_step.DUE], self.counts[assembly_step.FIRST] = 1, 1
        self.watched = assembly_setup.watched_interfaces([], self.outline, bodies[q.THETA])
        self.limits = self._limits(HEADROOM * self.speed, SETTLING)
        clock = assembly_step.Clock(self.dt, -1, 2**62, 2**62, self.g, 1)
        self.counts[assembly_step.UNTIL_SAVE] = 2**62
        still = np.zeros(max(2000, self._chunk() // 4))
        field = Field(still, still + self.g, still, still, 0.0, 0.0, False)
        while self.counts[assembly_step.STEP] < SETTLING_STEPS:
            ending = self._advance(field, clock)
            unbalance = bodies[q.UNBALANCE, : self.movable]
            worst = int(np.argmax(unbalance))
            if ending != assembly_step.RUNNING:
                break
            if unbalance[worst] < AT_REST:
                break
        if ending != assembly_step.RUNNING or not unbalance[worst] < AT_REST:
            raise ValueError(
                f"{self.assembly.names[worst]} (number {worst}) does not come to rest under gravity alone: want an "
                "assembly that stands, or settle=False"
            )
        bodies[[q.DASHPOT, q.FRICTION, q.ONSET, q.WORK, q.FIELD_X, q.FIELD_TURN]] = 0.0
        bodies[q.FIELD_Z] = self.g
        bodies[SPEEDS] = velocities

    def through(self, motion: Motion | None, progress: bool | Callable[[float], object]) -> AssemblyHistory:
        """The whole run, chunk by chunk."""
        save_every, watch_every = int(self.settings["save_every"]), int(self.settings["watch_every"])
        falls = {"fall": 1, "all": self.movable, "never": 0}[self.criteria.stop]
        clock = assembly_step.Clock(self.dt, self.last_step, save_every, watch_every, self.g, falls)
        self._begin(self.last_step // save_every + 3)
        settled = bool(self.settings["settle"])
        if not settled:
            self.counts[assembly_step.DUE], self.counts[assembly_step.FIRST] = 1, 1
        self.watched = self._interfaces(settled)
        tell, close = _teller(progress, self.dt * self.last_step)
        ending = assembly_step.RUNNING
        try:
            while ending == assembly_step.RUNNING:
                step = int(self.counts[assembly_step.STEP])
                steps = min(self._chunk(), self.last_step + 1 - step)
                ending = self._advance(self._field(motion, step, steps), clock)
                tell(float(self.counts[assembly_step.STEP]) * self.dt)
        except KeyboardInterrupt:
            return self._history(Ending.INTERRUPTED, motion)
        finally:
            close()
        endings = {FALLEN: Ending.FELL, LEFT: Ending.LEFT, BLOWN_UP: Ending.UNSTABLE}
        return self._history(endings.get(ending, Ending.REACHED_END), motion)

    def _interfaces(self, settled: bool) -> Watched:
        """Those where contacts press now, or, before the first step, where things touch as they are laid."""
        if settled:
            touching = assembly_setup.pressing(self.lists[int(self.counts[assembly_step.WHICH])])
        else:
            touch = all_touches(self.assembly, self.judgement.reach)
            touching = assembly_setup.touching(touch, self.outline)
        return assembly_setup.watched_interfaces(touching, self.outline, self.bodies[q.THETA])

    def _field(self, motion: Motion | None, first: int, steps: int) -> Field:
        times = np.arange(first, first + steps, dtype=np.float64) * self.dt
        frame = frame_at(motion, times, self.dt, self.g)
        # Forces of the table cannot add more speed than the time integral of its acceleration.
        size = float(np.hypot(self.limits.x_high - self.limits.x_low, self.limits.z_high - self.limits.z_low))
        pushes = np.abs(frame.x).sum() + np.abs(frame.z - self.g).sum() + size * np.abs(frame.turn).sum()
        self.speed += self.dt * float(pushes)
        self.limits = self._limits(HEADROOM * self.speed, 0.0) if first == 0 else self.limits
        self.limits = self.limits._replace(speed=HEADROOM * self.speed, settling=0.0)
        about = (float(self.settings["pitch_about_x"]), float(self.settings["pitch_about_z"]))
        return Field(frame.x, frame.z, frame.rate, frame.turn, *about, pitches(motion))

    def _history(self, ending: Ending, motion: Motion | None) -> AssemblyHistory:
        count = int(self.counts[assembly_step.SAVED])
        time, saved = self.saved.time[:count].copy(), self.saved.motion[:count]
        energy = self.saved.energy[:count]
        names = ("x", "z", "theta", "vx", "vz", "omega")
        columns: dict[str, Any] = {name: np.ascontiguousarray(saved[:, :, i]) for i, name in enumerate(names)}
        base_ax, base_az = accelerations(motion, time)
        end_time = float(time[-1]) if count else 0.0
        falls = self._falls()
        separations = self._separations()
        return AssemblyHistory(
            time=time,
            **columns,
            base_ax=base_ax,
            base_az=base_az,
            base_pitch=pitch_angle(motion, time),
            bodies=self.kept,
            names=tuple(self.assembly.names[number] for number in self.kept),
            energies=Energies(*(np.ascontiguousarray(column) for column in energy.T)),
            ending=ending,
            reason=self._reason(ending, end_time, falls),
            end_time=end_time,
            falls=falls,
            separations=separations,
            assembly=self.assembly,
            settings=self.settings | self._lists_at_the_end(),
        )

    def _lists_at_the_end(self) -> dict[str, float | str]:
        """How often contacts were listed, and the contacts and places for contacts in the last list."""
        lists = self.lists[int(self.counts[assembly_step.WHICH])]
        slots = int(lists.size[1])
        touching = int(np.count_nonzero(lists.slot[:slots, q.ACTIVE] >= 0))
        return {"lists_made": int(self.counts[assembly_step.LISTED]), "contacts": touching, "places": slots}

    def _falls(self) -> tuple[Fall, ...]:
        found = []
        for number, name in enumerate(self.assembly.names):
            time = float(self.bodies[q.FELL, number])
            if math.isnan(time):
                continue
            tipped = self.bodies[q.BEYOND, number] == 1.0
            found.append(Fall(number, name, float(self.bodies[q.CROSSED, number]) if tipped else time, time))
        return tuple(sorted(found, key=lambda fall: (fall.overturning_time, fall.body)))

    def _separations(self) -> tuple[Separation, ...]:
        walls = [wall.name or f"wall {number}" for number, wall in enumerate(self.assembly.walls)]
        names = [*self.assembly.names, *walls, "floor"]
        watched = self.watched
        return tuple(
            Separation(names[i], names[j], float(time))
            for i, j, time in zip(*watched.between.T, watched.opened, strict=True)
        )

    def _reason(self, ending: Ending, end_time: float, falls: tuple[Fall, ...]) -> str:
        at = f"at t = {end_time:.6g} s"
        if ending is Ending.FELL:
            return f"{falls[0].name} overturned at t = {falls[0].overturning_time:.6g} s; stopped {at}"
        if ending is Ending.LEFT or ending is Ending.UNSTABLE:
            number, value = self._culprit(ending)
            return f"{ending.value}: {self.assembly.names[number]} (number {number}), {value}, {at}"
        return f"{ending.value} {at}"

    def _culprit(self, ending: Ending) -> tuple[int, str]:
        """The first body that left or blew up, and its value."""
        b, limits = self.bodies[:, : self.movable], self.limits
        if ending is Ending.LEFT:
            x, z = b[q.X], b[q.Z]
            inside = (limits.x_low < x) & (x < limits.x_high) & (limits.z_low < z) & (z < limits.z_high)
            number = int(np.argmin(inside))
            return number, f"x = {x[number]:.6g} m, z = {z[number]:.6g} m"
        speed = np.abs(b[q.VX]) + np.abs(b[q.VZ]) + b[q.RADIUS] * np.abs(b[q.OMEGA])
        number = int(np.argmin(speed < limits.speed))
        return number, f"speed = {speed[number]:.6g} m/s where at most {limits.speed:.6g} m/s is possible"


def _teller(
    progress: bool | Callable[[float], object], end: float
) -> tuple[Callable[[float], object], Callable[[], object]]:
    """(what is called with the time reached, what is called in the end)."""
    if callable(progress):
        return progress, lambda: None
    if not progress:
        return lambda _: None, lambda: None
    bar = tqdm(total=end, unit="s", bar_format="{l_bar}{bar}| {n:.2f}/{total:.2f} s [{elapsed}<{remaining}]")

    def tell(time: float) -> None:
        bar.update(min(time, end) - bar.n)

    return tell, bar.close
