"""What is made of a campaign before anything is fitted: noises, falls, tests left out, the block as declared."""

from __future__ import annotations

import math
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from studies.campaigns import Campaign, CampaignError, Channel, Conditions, DeclaredBlock, Test
from studies.loop.closing import _lean_sds
from studies.loop.models.candidates import candidates
from studies.loop.models.model import LoopModel
from studies.loop.observed.windows import record_of, with_accelerometers
from studies.loop.records.preparing import _by_rotation, _typical_noise, as_declared
from studies.loop.runs.thinning import base_noise

G = 9.81
BLOCK = DeclaredBlock(0.225, 0.75, 0.375, 39.23)
ROTATION, BASE = Channel("rotation", "rotation", 2e-4), Channel("base_x", "base_acceleration_x")
TOP = Channel("top", "block_acceleration", 0.03, (0.0, 0.73), (1.0, 0.0))
T = 0.005 * np.arange(1200)
SWINGS = 0.1 * np.cos(4.0 * T) * np.exp(-0.3 * T)


def campaign(*tests: Test, block: DeclaredBlock = BLOCK) -> Campaign:
    return Campaign("some", block, Conditions(), (ROTATION, BASE, TOP), tests)


def test_accelerometers_end_where_the_rotation_shows_the_block_fall() -> None:
    falls = np.where(T < 4.0, SWINGS, np.minimum(0.5 * np.pi, SWINGS + (T - 4.0)))
    test = Test("one", "free", T, (ROTATION, TOP), {"rotation": falls, "top": 1e-3 * T}, initial_rotation=0.1)
    own = record_of(test, 0, 2e-4, BLOCK.alpha)
    assert own is not None
    record = with_accelerometers(own, test, {"top": 0.03}, BLOCK.alpha)
    over = T[np.flatnonzero(np.abs(falls) <= BLOCK.alpha)[-1]]
    for channel in record.recorded:
        assert T[np.flatnonzero(np.isfinite(channel))[-1]] == pytest.approx(over, abs=0.0051)
    assert not np.isfinite(record.observed[:, over + 0.006 < T]).any()


# Noise may be declared or not, and samples may be missing, here so that no 48 of them follow each other.
def test_the_noise_of_records_with_many_gaps_is_told_and_that_of_short_ones_is_none() -> None:
    rng = np.random.default_rng(0)
    base = np.sin(6.0 * T) + rng.normal(0.0, 0.01, T.size)
    base[5::13] = np.nan
    test = Test("gaps", "forced", T, (BASE,), {"base_x": base})
    assert base_noise(test) == pytest.approx(0.01, rel=0.25)
    short = Test("short", "forced", T[:25], (BASE,), {"base_x": base[:25]})
    assert base_noise(short) == 0.0
    free = Test("free", "free", T[:30], (Channel("rotation", "rotation"),), {"rotation": SWINGS[:30]})
    records, notes = _by_rotation(campaign(free))
    assert not records
    assert notes == ["test free: rotation is too short to tell its noise from and none is declared, left out"]
    bare = replace(TOP, noise=None)
    with pytest.raises(CampaignError, match="channel 'top': no test has samples enough to tell its noise from; want"):
        _typical_noise(campaign(Test("short", "free", T[:30], (bare,), {"top": T[:30]})), bare)


def test_tests_that_tell_of_the_response_otherwise_are_named() -> None:
    rotation = Test("a", "free", T, (ROTATION,), {"rotation": SWINGS}, initial_rotation=0.1)
    top = Test("b", "free", T, (TOP,), {"top": 0.0 * T}, initial_rotation=0.1)
    fell = Test("c", "forced", T, (BASE,), {"base_x": 0.0 * T}, overturned=True)
    base = Test("d", "forced", T, (BASE,), {"base_x": 0.0 * T})
    records, notes = _by_rotation(campaign(rotation, top, fell, base))
    assert [record.test for record in records] == [0]
    assert notes == [
        "test b: accelerometers alone, left out beside tests with a rotation",
        "test c: an outcome alone, left out beside tests with a rotation",
    ]
    assert _by_rotation(campaign(top, fell, base)) == ([], [])


# About the corner that the block turns to, b/2 on the other side of the centre of mass, momentum before is
# (I_c + m (h_c^2 - b^2/4)) omega, after it I_O omega.
@pytest.mark.parametrize(("height", "inertia"), [(None, None), (0.18, 0.15), (0.45, 3.0)])
def test_housner_s_restitution_is_that_of_the_declared_mass(height: Any, inertia: Any) -> None:
    block = replace(BLOCK, centre_of_mass_height=height, inertia=inertia)
    h, b, m = height or 0.375, 0.225, 39.23
    I_c = inertia or m * (0.75**2 + b**2) / 12.0
    arms = np.array([0.5 * b, h]), np.array([-0.5 * b, h])  # from either corner
    kept = (I_c + m * float(arms[0] @ arms[1])) / (I_c + m * float(arms[0] @ arms[0]))
    assert as_declared(campaign(block=block), G).restitution == pytest.approx(kept, rel=1e-12)
    if height is None:
        assert kept == pytest.approx(1.0 - 1.5 * math.sin(math.atan(b / 0.75)) ** 2, rel=1e-12)


# A block with a declared centre of mass is no rectangle: what the candidate adds nothing to is what was declared.
@pytest.mark.parametrize(("height", "inertia"), [(0.45, None), (None, 3.0), (0.45, 3.0)])
def test_every_candidate_is_absent_from_the_block_as_declared(height: Any, inertia: Any) -> None:
    block = replace(BLOCK, centre_of_mass_height=height, inertia=inertia)
    plain = LoopModel(block, 0.9, {}, G)
    found = [c for c in candidates(block) if c.effect == "mass_distribution"]
    assert found
    for candidate in found:
        absent: Any = plain.changed(candidate.absent(block)).system.parameters
        for name in ("a", "H", "rho2", "balance_right", "balance_left"):
            assert getattr(absent, name) == pytest.approx(getattr(plain.system.parameters, name), rel=1e-12), name


def test_a_lean_that_was_aimed_at_has_the_deviation_that_it_is_given_for_the_floor() -> None:
    read, aimed = (SimpleNamespace(test=3, theta=0.1, theta_sd=2e-3, lean_read=r) for r in (True, False))
    in_test = {3: SimpleNamespace(reading_slope=lambda theta: 1.25)}
    model: Any = SimpleNamespace(in_test=in_test.__getitem__)
    # Of a window it is twice the standard deviation of what was read, and that of what was aimed at.
    assert _lean_sds(SimpleNamespace(whole_held=(read, aimed)), model) == pytest.approx([0.8e-3, 2e-3])  # type: ignore[arg-type]
