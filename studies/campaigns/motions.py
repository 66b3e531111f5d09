"""Which tests belong together: repeats of one base motion are held out together or not at all.

A test that names its motion belongs with those of the same name.  Other forced tests belong together where their base
records are the same motion up to size, noise and a shift in time: the largest normalised cross-correlation of the
records, averaged over steps of `STEP`, exceeds `SAME`.  A free test stands alone.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from studies.campaigns.model import Array, Campaign, Test

SAME = 0.95
"""Ramps at one frequency correlate above it; at frequencies half a hertz apart, or earthquakes, far below."""

STEP = 0.02
"""Time over which samples are averaged before they are compared [s]."""


def motion_groups(campaign: Campaign) -> tuple[tuple[str, ...], ...]:
    """Ids of the tests that belong together, each test in one group, in the order of their first tests."""
    named: dict[str, list[str]] = {}
    unnamed: list[tuple[Test, Array]] = []
    groups: list[list[str]] = []
    for test in campaign.tests:
        if test.motion is not None:
            named.setdefault(test.motion, []).append(test.id)
        elif test.base_x is None:
            groups.append([test.id])
        else:
            unnamed.append((test, _averaged(test, test.base_x)))
    groups += [*named.values(), *_alike(unnamed)]
    order = {test.id: k for k, test in enumerate(campaign.tests)}
    groups.sort(key=lambda group: order[group[0]])
    return tuple(tuple(group) for group in groups)


def _averaged(test: Test, values: Array) -> Array:
    """The record at steps of about `STEP`, mean taken out, unit norm; zeros for a base at rest."""
    width = max(1, round(STEP / test.time_step))
    there = np.nan_to_num(values - np.nanmean(values))
    means = there[: there.size // width * width].reshape(-1, width).mean(axis=1)
    norm = float(np.linalg.norm(means))
    return means / norm if norm > 0.0 else np.zeros_like(means)


def _alike(tests: list[tuple[Test, Array]]) -> list[list[str]]:
    """Groups of tests whose records correlate, a test joining the first group that has a member like it."""
    if not tests:
        return []
    length = 2 ** int(np.ceil(np.log2(2 * max(values.size for _, values in tests))))
    spectra = [np.fft.rfft(values, length) for _, values in tests]
    groups: list[list[int]] = []
    for k, spectrum in enumerate(spectra):
        like = [g for g in groups if any(_peak(spectra[j], spectrum, length) > SAME for j in g)]
        rest = [g for g in groups if not any(g is h for h in like)]
        groups = [*rest, [*(j for g in like for j in g), k]]
    return [[tests[k][0].id for k in sorted(group)] for group in groups]


def _peak(first: NDArray[np.complex128], second: NDArray[np.complex128], length: int) -> float:
    """Largest correlation over all shifts; the sign of the motion does not matter."""
    return float(np.max(np.abs(np.fft.irfft(first * np.conj(second), length))))
