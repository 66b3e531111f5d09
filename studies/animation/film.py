"""What is shown of a run: outlines, where they are at each sample, the base's motion and when what happened.

Everything comes from the dataset of a run (`to_xarray()` of a history, or a saved file), in the frame of the table: x
to the right, z up, rotation clockwise.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import xarray as xr

import dem
from studies.running.files import load_dataset

FloatArray = npt.NDArray[np.float64]
NEEDED = ("x", "z", "theta", "outline_x", "outline_z", "outline_of")
MARGIN = 0.06
"""Space around what is shown, as a share of its size."""

WIDEST = 3.0
"""What moves away is followed until the view is so many times as large as the scene at the start."""

Run = dem.History | dem.AssemblyHistory | xr.Dataset


@dataclass(frozen=True)
class Film:
    """A run as it is shown.

    time [s], shape (time,); x, z [m], theta [rad]: shape (time, body); base_ax, base_az [m/s^2], shape (time,), or None
    outlines: corners of each body from its centroid where theta = 0 [m]; walls: corners of each in the frame of the
        table [m]; floor: whether there is one at z = 0
    names: of the bodies; events: (time [s], sentence), in order of time; ending: how the run ended
    """

    time: FloatArray
    x: FloatArray
    z: FloatArray
    theta: FloatArray
    outlines: tuple[FloatArray, ...]
    walls: tuple[FloatArray, ...]
    floor: bool
    names: tuple[str, ...]
    base_ax: FloatArray | None
    base_az: FloatArray | None
    title: str
    ending: str
    events: tuple[tuple[float, str], ...]

    def __repr__(self) -> str:
        span = f"{self.time[0]:.4g} to {self.time[-1]:.4g} s" if self.time.size else "no time"
        return f"<Film {self.title!r}: {len(self.outlines)} bodies, {self.time.size} samples, {span}>"

    def corners(self, sample: int, body: int) -> FloatArray:
        """Corners of a body at a sample [m], shape (corner, 2)."""
        return placed(
            self.outlines[body], self.x[sample, body], self.z[sample, body], self.theta[sample, body]
        )  # fmt: skip

    def outlines_at(self, time: float) -> list[FloatArray]:
        """Corners of each body at a time [s], straight between samples [m], each of shape (corner, 2)."""
        after = int(np.clip(np.searchsorted(self.time, time), 1, max(1, self.time.size - 1)))
        before = after - 1
        after = min(after, self.time.size - 1)
        way = self.time[after] - self.time[before]
        share = float(np.clip((time - self.time[before]) / way, 0.0, 1.0)) if way > 0.0 else 0.0
        pose = [(1.0 - share) * row[before] + share * row[after] for row in (self.x, self.z, self.theta)]
        return [placed(outline, *place) for outline, *place in zip(self.outlines, *pose, strict=True)]

    def titled(self, title: str | None) -> Film:
        """The same with another heading, where one is given."""
        return self if title is None else replace(self, title=title)

    def between(self, start: float, end: float) -> Film:
        """The samples from start to end [s], and the events among them.

        Raises:
            ValueError: there is no sample among them.
        """
        kept = (self.time >= start) & (self.time <= end)
        if not kept.any():
            raise ValueError(f"{start:.6g} to {end:.6g} s: want a stretch with a sample in it")
        return replace(
            self, time=self.time[kept], x=self.x[kept], z=self.z[kept], theta=self.theta[kept],
            base_ax=None if self.base_ax is None else self.base_ax[kept],
            base_az=None if self.base_az is None else self.base_az[kept],
            events=tuple(event for event in self.events if start <= event[0] <= end),
        )  # fmt: skip

    def sample_at(self, time: float) -> int:
        """The sample nearest to a time [s].

        Raises:
            ValueError: the run has no such time.
        """
        first, last = float(self.time[0]), float(self.time[-1])
        slack = 0.5 * (last - first) / max(1, self.time.size - 1)
        if not first - slack <= time <= last + slack:
            raise ValueError(f"time={time} s: want {first:.6g} to {last:.6g} s, which the run covers")
        return int(np.argmin(np.abs(self.time - time)))

    def view(self, samples: Sequence[int] | None = None) -> tuple[float, float, float, float]:
        """x from, x to, z from, z to [m] that hold everything at these samples (default: all), within `WIDEST`."""
        start = _box([self.corners(0, b) for b in range(len(self.names))] + list(self.walls), self.floor)
        reach = np.array([np.hypot(*outline.T).max() for outline in self.outlines])
        chosen = slice(None) if samples is None else list(samples)
        x, z = self.x[chosen], self.z[chosen]
        # Each body turns within its circle.
        low = [float((x - reach).min()), float((z - reach).min())]
        high = [float((x + reach).max()), float((z + reach).max())]
        size = max(start[1] - start[0], start[3] - start[2])
        room = WIDEST * size
        middle_x, top = 0.5 * (start[0] + start[1]), start[3]
        box = [
            max(min(start[0], low[0]), middle_x - 0.5 * room),
            min(max(start[1], high[0]), middle_x + 0.5 * room),
            max(min(start[2], low[1]), start[2] - (0.0 if self.floor else 0.5 * room)),
            min(max(start[3], high[1]), top + 0.5 * room),
        ]
        margin = MARGIN * max(box[1] - box[0], box[3] - box[2])
        return box[0] - margin, box[1] + margin, box[2] - margin, box[3] + margin


def placed(outline: FloatArray, x: float, z: float, theta: float) -> FloatArray:
    """Corners [m] of a body whose centroid is at x, z [m] and which has turned clockwise by theta [rad]."""
    cos, sin = math.cos(theta), math.sin(theta)
    along, up = outline.T
    return np.column_stack([x + along * cos + up * sin, z + up * cos - along * sin])


def film_of(run: Run | str | Path, *, title: str | None = None) -> Film:
    """What is shown of a history, its dataset, or a file that holds one.

    Raises:
        ValueError: the dataset is not one of a run, or has no samples.
    """
    if isinstance(run, (str, Path)):
        ds = load_dataset(Path(run))
    else:
        ds = run if isinstance(run, xr.Dataset) else run.to_xarray()
    missing = [name for name in NEEDED if name not in ds]
    if missing or "time" not in ds.coords:
        raise ValueError(
            f"dataset without {', '.join(missing or ['time'])}: want that of a run of distinct elements, as "
            "`to_xarray()` makes it"
        )
    if not ds.sizes["time"]:
        raise ValueError("dataset without samples: want at least one")
    time = _numbers(ds, "time")
    if time.ndim != 1 or not np.all(np.isfinite(time)) or np.any(np.diff(time) < 0.0):
        raise ValueError("time: want finite times that ascend [s]")
    motion = {name: np.atleast_2d(_numbers(ds, name).T).T for name in ("x", "z", "theta")}
    for name, values in motion.items():
        if values.shape != (time.size, motion["x"].shape[1]):
            raise ValueError(f"{name} of shape {values.shape}: want {(time.size, motion['x'].shape[1])}, time and body")
        if not np.isfinite(values).all():
            sample, body = np.argwhere(~np.isfinite(values))[0]
            raise ValueError(f"{name} of body {body} is {values[sample, body]} at sample {sample}: want finite numbers")
    count = motion["x"].shape[1]
    things = _outlines(ds, count)
    names = tuple(str(name) for name in np.atleast_1d(ds.body.values)) if "body" in ds.coords else ("block",)
    if len(names) != count:
        raise ValueError(f"body: {len(names)} names, want {count}, one for each body")
    return Film(
        time=time,
        **motion,
        outlines=tuple(things[:count]),
        walls=tuple(things[count:]),
        floor=bool(ds.attrs.get("floor", 1)),
        names=names,
        base_ax=ds.base_ax.values if "base_ax" in ds else None,
        base_az=ds.base_az.values if "base_az" in ds else None,
        title=str(ds.attrs.get("title", "single block")) if title is None else title,
        ending=_ending(ds.attrs),
        events=_events(ds, names),
    )


def _numbers(ds: xr.Dataset, name: str) -> FloatArray:
    """A variable as numbers; ValueError where it holds something else."""
    if ds[name].dtype.kind not in "fiub":
        raise ValueError(f"{name} of type {ds[name].dtype}: want numbers")
    return np.asarray(ds[name].values, dtype=np.float64)


def _outlines(ds: xr.Dataset, bodies: int) -> list[FloatArray]:
    """Corners of each body and wall [m], each of shape (corner, 2)."""
    corners = [_numbers(ds, name) for name in ("outline_x", "outline_z")]
    owners = _numbers(ds, "outline_of")
    if owners.ndim != 1 or any(values.shape != owners.shape for values in corners):
        raise ValueError(f"outline_of of shape {owners.shape}: want one of outline_x and outline_z, (corner,)")
    present = np.unique(owners)
    # As many things as have corners: no number in a stranger's file makes a loop long.
    if present.size < bodies or not np.array_equal(present, np.arange(present.size)):
        raise ValueError(f"outline_of: want the numbers 0 to {bodies - 1} or more, each thing with its corners")
    if not all(np.isfinite(values).all() for values in corners):
        raise ValueError("outline_x, outline_z: want finite numbers [m]")
    return [np.column_stack([values[owners == number] for values in corners]) for number in present]


def _box(outlines: Sequence[FloatArray], floor: bool) -> tuple[float, float, float, float]:
    points = np.concatenate(list(outlines))
    low = 0.0 if floor else float(points[:, 1].min())  # a wall may reach below the floor
    return float(points[:, 0].min()), float(points[:, 0].max()), low, float(points[:, 1].max())


def _ending(attributes: Mapping[Any, Any]) -> str:
    if "reason" in attributes:
        return str(attributes["reason"])
    outcome = str(attributes.get("outcome", ""))
    known = dem.Outcome.__members__.get(outcome)
    return known.value if known else outcome


def _events(ds: xr.Dataset, names: Sequence[str]) -> tuple[tuple[float, str], ...]:
    """Falls and openings, in order."""
    found: list[tuple[float, str]] = []
    if "overturning_time" in ds:
        falls = zip(names, np.atleast_1d(ds.overturning_time.values), strict=True)
        found += [(float(time), f"{name} overturns") for name, time in falls]
    elif "overturning_time" in ds.attrs:
        found.append((float(ds.attrs["overturning_time"]), f"{names[0]} overturns"))
    if "separation_time" in ds:
        pairs = zip(ds.interface.values, ds.separation_time.values, strict=True)
        found += [(float(time), f"{_opening(str(pair))} opens") for pair, time in pairs]
    return tuple(sorted((event for event in found if math.isfinite(event[0])), key=lambda event: event[0]))


def _opening(pair: str) -> str:
    return f"the joint of {pair}"
