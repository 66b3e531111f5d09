"""The base motion of a test as something that a solver can run: a cubic spline through the samples, made whole.

Source   `excitation.sampled`; linear interpolation between samples changes forced responses noticeably.
"""

from __future__ import annotations

from typing import Literal

import numpy as np

from excitation import SampledMotion
from studies.campaigns.errors import CampaignError
from studies.campaigns.gaps import LONGEST_FILL, whole_base
from studies.campaigns.model import Array, Test


def upsampled(values: Array, factor: int) -> Array:
    """Samples of the cubic spline (C2, not-a-knot ends) at `factor` times the rate, shape (factor * (time - 1) + 1,).

    Every `factor`-th value is a sample as it was.

    Raises:
        ValueError: the factor is below 1, or a sample is missing.
    """
    from scipy.interpolate import CubicSpline

    if factor < 1:
        raise ValueError(f"factor={factor!r}: want 1 or more")
    if not np.isfinite(values).all():
        raise ValueError("values: have samples missing, want them filled first (see gaps.whole_base)")
    if factor == 1:
        return values.copy()
    fine = CubicSpline(np.arange(values.size), values)(np.arange(factor * (values.size - 1) + 1) / factor)
    fine[::factor] = values
    return np.asarray(fine)


def base_motion(
    test: Test,
    *,
    factor: int = 1,
    outside: Literal["zero", "hold"] = "zero",
    until: float | None = None,
    longest_gap: float = LONGEST_FILL,
) -> SampledMotion | None:
    """The measured base motion of a test; None for a test without a base channel, whose base is at rest.

    Args:
        test: the test.
        factor: nodes per sample; the curve is the same, a solver that steps from node to node takes finer steps.
        outside: the base acceleration after the record: "zero", or "hold" for its last value up to `until`.
        until: time [s] up to which it is held.
        longest_gap: gap [s] up to which samples are filled.

    Raises:
        CampaignError: a gap of the record is too long or at an end of it.
        ValueError: `outside` is neither, or `until` is missing for "hold".
    """
    if outside not in ("zero", "hold") or (outside == "hold" and until is None):
        raise ValueError(f"outside={outside!r}, until={until!r}: want 'zero', or 'hold' with a time until [s]")
    channels = [test.channel(kind) for kind in ("base_acceleration_x", "base_acceleration_z")]
    if channels[0] is None and channels[1] is None:
        return None
    if channels[0] is None:
        raise CampaignError(f"test {test.id!r}: has a vertical base motion alone, want the horizontal one too")
    step = test.time_step / factor
    columns = [None if c is None else upsampled(whole_base(test, c.name, longest_gap), factor) for c in channels]
    if outside == "hold" and until is not None:
        more = max(0, int(np.ceil((until - float(test.time[-1])) / step - 1e-9)))
        columns = [None if v is None else np.concatenate([v, np.full(more, v[-1])]) for v in columns]
    a_x, a_z = columns
    assert a_x is not None
    return SampledMotion(step, a_x, a_z, start=float(test.time[0]), name=test.motion or test.id)
