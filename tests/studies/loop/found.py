"""Small measured campaigns made with the package's own solver, and what the loop finds in them."""

from dataclasses import replace
from functools import cache
from tempfile import TemporaryDirectory

import numpy as np
import pytest

from excitation import SampledMotion
from rocking import Block, Method1, solve
from rocking.effects import load
from studies.campaigns import Campaign, Channel, Conditions, DeclaredBlock, Test, read, write
from studies.loop import closing
from studies.loop.models.candidates import candidates
from studies.loop.search import searching

STEP = 0.004
BLOCK = Block(b=0.15, h=0.5, d=0.25, density=600.0)
ROTATION = Channel("rotation", "rotation", 2e-4)
BASE = Channel("base <i>x</i>", "base_acceleration_x", 0.004)
TITLE = "<script>alert('title')</script> & \"quoted\" $x_1$"
HOSTILE = "<b onload=alert(1)>&amp;'\""
MOTION = '"><img src=x onerror=alert(2)>'
RESTITUTION = 0.92
TILT = 0.006
DRAG = 0.4


def _free(id, theta, rng, effects, duration=2.4):
    t = STEP * np.arange(round(duration / STEP) + 1)
    run = solve(Method1(BLOCK, restitution=RESTITUTION), theta=theta, t_end=t[-1], save_at=t, effects=effects)
    rotation = run.theta + 2e-4 * rng.standard_normal(t.size)
    return Test(id, "free", t, (ROTATION,), {"rotation": rotation}, initial_rotation=round(theta, 3))


def _forced(id, rng, effects, motion=None, duration=3.0):
    t = STEP * np.arange(round(duration / STEP) + 1)
    a_x = 4.0 * np.sin(2.0 * np.pi * 2.0 * t) * np.exp(-(((t - 1.0) / 0.6) ** 2))
    run = solve(
        Method1(BLOCK, restitution=RESTITUTION), SampledMotion(STEP, a_x), t_end=t[-1], save_at=t, effects=effects
    )
    assert run.t.size == t.size, "it fell"
    data = {
        "rotation": run.theta + 2e-4 * rng.standard_normal(t.size),
        BASE.name: a_x + 0.004 * rng.standard_normal(t.size),
    }
    return Test(id, "forced", t, (ROTATION, BASE), data, motion=motion)


def _campaign(effects):
    rng = np.random.default_rng(3)
    leans = {"free-01": 0.17, HOSTILE: -0.15, "free-03": 0.12, "free-04": -0.18}
    tests = [_free(id, theta, rng, effects) for id, theta in leans.items()]
    shaken = _forced("shaken", rng, effects, MOTION)
    blind = replace(shaken, id="to predict", data={BASE.name: shaken.data[BASE.name]}, channels=(BASE,))
    declared = DeclaredBlock(0.15, 0.5, 0.25, BLOCK.mass)
    channels = (ROTATION, BASE)
    return Campaign(TITLE, declared, Conditions(restitution=0.91), channels, (*tests, shaken, blind))


def _found(effects, wanted=("base_tilt", "quadratic_drag")):
    """The finding with a short list of candidates, on a campaign that was written and read."""
    with pytest.MonkeyPatch.context() as patch, TemporaryDirectory() as folder:
        few = tuple(c for c in candidates(DeclaredBlock(0.15, 0.5, 0.25, BLOCK.mass)) if c.name in wanted)
        patch.setattr(searching, "all_candidates", lambda model, friction: few)
        return closing.close(read(write(_campaign(effects), folder)), g=9.80665)


@cache
def tilted():
    """A finding on a block whose floor is not level."""
    return _found((load("base_tilt")(angle=TILT),))


@cache
def both():
    """A finding on a block whose floor is not level and that drag holds back, with a twin of each to choose from."""
    effects = (load("base_tilt")(angle=TILT), load("quadratic_drag")(coefficient=DRAG))
    return _found(effects, ("base_tilt", "quadratic_drag", "eccentric_mass", "viscous_damping"))


@cache
def plain():
    """A finding on an ideal block."""
    return _found(())
