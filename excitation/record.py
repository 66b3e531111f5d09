"""A measured or made acceleration history of one component, with where it is from.

A record is what files hold and what the processing functions of the package take; `motion()` makes it a base motion.

Status   velocity and displacement are the exact integrals of the cubic spline through the samples, the same curve that
         the motion follows.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from excitation.checks import between, positive, samples
from excitation.sampled import PiecewiseLinear, SampledMotion

if TYPE_CHECKING:
    import xarray as xr


class RecordFileError(ValueError):
    """A file is not what its format promises: says file, line, what was found and what was wanted."""


@dataclass(frozen=True, eq=False)
class Record:
    """One component of an acceleration history, equally spaced in time.

    Args:
        time_step: time between samples [s], positive.
        acceleration: [m/s^2], shape (time,), two samples or more.
        component: the direction as the source names it: `N-S`, `90`, `UP`.
        azimuth_deg: direction of the positive axis, degrees clockwise from north, 0 to 360; None if vertical or
            unknown.
        vertical: whether it is the vertical component, positive upward.
        station, event, start_time: as the source states them; start_time in ISO 8601, UTC; empty if not stated.
        source: name of the file or the recipe it was made with.
        format: name of the file format; empty if it was made here.
        file_units: unit of acceleration in the file.
        sha256: digest of the file's bytes.
        metadata: the rest of what the header says, as text.

    Raises:
        ValueError: a sample is not finite, there are fewer than two, `time_step` is not positive, or the azimuth is not
            from 0 to 360.
    """

    time_step: float
    acceleration: NDArray[np.float64]
    component: str = ""
    azimuth_deg: float | None = None
    vertical: bool = False
    station: str = ""
    event: str = ""
    start_time: str = ""
    source: str = ""
    format: str = ""
    file_units: str = ""
    sha256: str = ""
    metadata: Mapping[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        positive("time_step", self.time_step, "s")
        if self.azimuth_deg is not None:
            between("azimuth_deg", self.azimuth_deg, 0.0, 360.0, "deg")
        object.__setattr__(self, "acceleration", samples("acceleration", self.acceleration))

    def __repr__(self) -> str:
        facts = [text for text in (self.source, self.component) if text]
        facts.append(f"{self.acceleration.size} samples at {self.time_step:g} s")
        facts.append(f"PGA {float(np.max(np.abs(self.acceleration))):.4g} m/s^2")
        return f"Record({', '.join(facts)})"

    def _repr_html_(self) -> str:
        """The acceleration drawn, for notebooks."""
        from excitation.picture import html_of

        return html_of(self.times, self.acceleration, f"acceleration; {self!r}")

    @property
    def times(self) -> NDArray[np.float64]:
        """Times of the samples [s] from the first one on, shape (time,)."""
        return np.asarray(self.time_step * np.arange(self.acceleration.size), dtype=np.float64)

    @property
    def duration(self) -> float:
        """Time from the first to the last sample [s]."""
        return self.time_step * (self.acceleration.size - 1)

    @cached_property
    def _spline(self) -> Any:
        from scipy.interpolate import CubicSpline

        return CubicSpline(self.times, self.acceleration)

    @cached_property
    def velocity(self) -> NDArray[np.float64]:
        """[m/s], shape (time,); zero at the first sample."""
        return np.asarray(self._spline.antiderivative(1)(self.times))

    @cached_property
    def displacement(self) -> NDArray[np.float64]:
        """[m], shape (time,); zero at the first sample, as its rate is."""
        return np.asarray(self._spline.antiderivative(2)(self.times))

    def with_samples(self, acceleration: ArrayLike, time_step: float | None = None, note: str = "") -> Record:
        """The same record with other samples [m/s^2]; `note` says in the metadata what was done."""
        done = f"{self.metadata.get('processing', '')}; {note}".strip("; ")
        metadata = dict(self.metadata) | ({"processing": done} if done else {})
        step = self.time_step if time_step is None else time_step
        values = np.asarray(acceleration, dtype=np.float64)
        return replace(self, acceleration=values, time_step=step, metadata=metadata)

    def motion(
        self, vertical: Record | None = None, *, interpolation: str = "cubic", start: float = 0.0
    ) -> SampledMotion | PiecewiseLinear:
        """The base motion: this record along x and `vertical` along z.

        Args:
            vertical: record of the same length and time step; none if not given.
            interpolation: "cubic" for a `SampledMotion`, "linear" for a `PiecewiseLinear`.
            start: time of the first sample [s].

        Raises:
            ValueError: the two records differ in time step or length, or the interpolation is unknown.
        """
        kinds: dict[str, type[SampledMotion] | type[PiecewiseLinear]] = {
            "cubic": SampledMotion,
            "linear": PiecewiseLinear,
        }
        if interpolation not in kinds:
            raise ValueError(f"interpolation={interpolation!r}: want one of {', '.join(kinds)}")
        if vertical is not None:
            same_sampling(self, vertical)
        a_z = None if vertical is None else vertical.acceleration
        name = " ".join(part for part in (self.source, self.component) if part)
        return kinds[interpolation](self.time_step, self.acceleration, a_z, start=start, name=name)

    def to_xarray(self) -> xr.Dataset:
        """Acceleration, velocity and displacement with units; what the header says stands in the attributes."""
        import xarray as xr

        columns = {
            "acceleration": (self.acceleration, "m s-2"),
            "velocity": (self.velocity, "m s-1"),
            "displacement": (self.displacement, "m"),
        }
        attributes: dict[str, Any] = {name: getattr(self, name) for name in _TEXTS}
        attributes |= {"vertical": int(self.vertical), "time_step": self.time_step}
        if self.azimuth_deg is not None:
            attributes["azimuth_deg"] = self.azimuth_deg
        return xr.Dataset(
            {name: ("time", v, {"units": unit, "long_name": name}) for name, (v, unit) in columns.items()},
            coords={"time": ("time", self.times, {"units": "s", "long_name": "time"})},
            attrs=attributes | {f"header {name}": text for name, text in self.metadata.items()},
        )

    @classmethod
    def from_xarray(cls, ds: xr.Dataset) -> Record:
        """The record in a dataset of `to_xarray`; needs `time` and `acceleration` with units.

        Raises ValueError if one is missing, its unit is unknown or the times are not equally spaced.
        """
        from excitation.stated import stated_step, values_in

        for name in ("time", "acceleration"):
            if name not in ds:
                raise ValueError(f"dataset: holds {sorted(map(str, ds.variables))}, want {name}")
        header = {str(k)[7:]: str(v) for k, v in ds.attrs.items() if str(k).startswith("header ")}
        azimuth = ds.attrs.get("azimuth_deg")
        return cls(
            stated_step(ds, values_in(ds, "time", "time")),
            values_in(ds, "acceleration", "acceleration"),
            azimuth_deg=None if azimuth is None else float(azimuth),
            vertical=bool(ds.attrs.get("vertical", 0)),
            metadata=header,
            **{name: str(ds.attrs.get(name, "")) for name in _TEXTS},
        )


_TEXTS = ("component", "station", "event", "start_time", "source", "format", "file_units", "sha256")


def same_sampling(first: Record, second: Record) -> None:
    """Raise ValueError unless both have one time step and length."""
    if first.acceleration.size != second.acceleration.size:
        raise ValueError(
            f"records: have {first.acceleration.size} and {second.acceleration.size} samples, want as many"
        )
    if abs(first.time_step - second.time_step) > 1e-9 * first.time_step:
        raise ValueError(f"records: have time steps {first.time_step!r} and {second.time_step!r} s, want the same")
