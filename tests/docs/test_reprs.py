"""What a prompt or a notebook shows of public objects: short, and nothing of a stranger's text in it as HTML."""

import inspect
import re
import xml.etree.ElementTree as ElementTree

import numpy as np
import pytest

import dem
import excitation as ex
import rocking
from rocking import Block, Method1, Method2, Mode, Outcome, solve, solve_batch
from rocking.effects import available, load
from studies import animation, campaigns, sweep

SYSTEM = Method1(Block(b=0.15, h=0.5))
RECORD = ex.Record(0.01, np.sin(np.arange(5000) / 7.0), source="<b>bold</b> & more")
COLUMN = dem.column(2, 0.15, 0.5, 0.25, 597.0, wall_gap=0.01)
PUBLIC = (rocking, dem, ex, campaigns, sweep, animation)
NUMBERS = {"amplitude": 3.0, "period": 1.0, "duration": 5.0, "frequency": 2.0, "rms": 1.0, "final_amplitude": 9.0,
           "start_frequency": 1.0, "end_frequency": 5.0, "magnitude": 6.5, "distance": 2e4, "phase": 0.0,
           "velocity": 0.5, "gamma": 2.0, "start": 0.0}  # fmt: skip
TIME = np.arange(400) * 0.005
CHANNEL = campaigns.Channel("rotation", "rotation", noise=2e-4)
CAMPAIGN = campaigns.Campaign(
    "Free", campaigns.DeclaredBlock(0.15, 0.5, 0.25, 11.2), campaigns.Conditions(), (CHANNEL,),
    (campaigns.Test("free-1", "free", TIME, (CHANNEL,), {"rotation": np.sin(TIME)}),),
)  # fmt: skip


def made_by_numbers(kind):
    """A formula of the excitation with plain numbers for what has no default."""
    needed = [p.name for p in inspect.signature(kind).parameters.values() if p.default is p.empty]
    values = {"motion": ex.SymmetricRickerPulse(3.0, 1.0), "horizontal": RECORD.motion()} | NUMBERS
    more = {"per_acceleration": 0.1} if kind is ex.ProportionalPitch else {}
    return kind(**{name: values[name] for name in needed}, **more)


MOTIONS = {name: made_by_numbers(kind) for name, kind in (ex.formulas() | {"Point": ex.PointSource}).items()}
MOTIONS |= {"Kanai": ex.KanaiTajimi(1.0, 10.0)}


def public_classes():
    """Every class that a package offers, but for errors and those that cannot be made."""
    found = {getattr(package, name) for package in PUBLIC for name in package.__all__}
    classes = {thing for thing in found if inspect.isclass(thing) and not issubclass(thing, Exception)}
    return {kind for kind in classes if not inspect.isabstract(kind)}


@pytest.fixture(scope="module")
def made():
    """One of each public kind that holds results or arrays."""
    history = dem.simulate(dem.single_block(0.15, 0.5, 0.25, 597.0), t_end=0.001, mu=0.5, damping_ratio=0.2)
    contact = dem.Contact(mu=0.5, damping_ratio=0.2)
    run = dem.simulate_assembly(COLUMN, t_end=0.005, contact=contact)
    return {
        "block": SYSTEM.block, "method1": SYSTEM, "method2": Method2(SYSTEM.block, friction=0.5),
        "trajectory": solve(SYSTEM, theta=0.1, t_end=1.0),
        "batch": solve_batch(SYSTEM, theta=np.linspace(0.1, 0.2, 50), t_end=1.0),
        "mode": Mode.REST, "outcome": Outcome.MOVING, "record": RECORD, "motion": RECORD.motion(),
        "spectrum": ex.response_spectrum(RECORD), "intensity": ex.intensity(RECORD), "table": ex.Table(),
        "history": history, "energies": history.energies, "scene": history.scene, "shape": history.scene.shape,
        "swings": dem.swings(TIME, 0.1 * np.cos(7.0 * TIME)), "match": ex.Match(RECORD, 0.0123456789, 7),
        "judgement": dem.ContactJudgement(),
        "linear motion": RECORD.motion(interpolation="linear"), "drop": dem.Drop(history.scene, 0.01),
        "ending": dem.Ending.FELL, "fall": dem.Fall(0, "block", 1.0, 2.0 / 3.0),
        "separation": dem.Separation("a", "b", 1.0 / 3.0), "film": animation.film_of(run),
        "sweep": sweep.Sweep(axes={"h": np.linspace(0.1, 1.0, 50), "frequency": [1.0, 2.0]}),
        "campaign": CAMPAIGN, "test": CAMPAIGN.tests[0], "channel": CAMPAIGN.channels[0],
        "conditions": CAMPAIGN.conditions, "declared block": CAMPAIGN.block, "dem mode": dem.Mode.REST,
        "dem outcome": dem.Outcome.MOVING, **MOTIONS, **{name: load(name)() for name in available()},
        "assembly": COLUMN, "wall of blocks": dem.running_bond(10, 10), "body": COLUMN.bodies[0],
        "wall": COLUMN.walls[0], "assembly history": run, "contact": contact, "criteria": dem.Criteria(),
    }  # fmt: skip


def test_there_is_one_of_every_public_class(made):
    there = {kind for thing in made.values() for kind in type(thing).__mro__}
    assert {kind.__name__ for kind in public_classes() - there} == set()


def test_a_repr_is_words_and_numbers_that_can_be_read(made):
    # No address in memory, no array, and of a number that was computed not every digit; pi/2, a default, is one.
    unreadable = {
        name: repr(thing)
        for name, thing in made.items()
        if " at 0x" in repr(thing) or "array(" in repr(thing)
        or re.search(r"\.\d{9,}", repr(thing).replace(repr(np.pi / 2.0), ""))
    }  # fmt: skip
    assert unreadable == {}


def test_no_repr_is_longer_than_a_few_lines(made):
    # Three lines of a wide terminal; arrays that are printed take hundreds.
    too_long = {name: len(repr(thing)) for name, thing in made.items() if len(repr(thing)) > 300}
    assert too_long == {}


@pytest.mark.parametrize("name", ["trajectory", "record", "assembly"])
def test_html_is_well_formed_and_says_what_the_repr_says(made, name):
    text = made[name]._repr_html_()
    whole = ElementTree.fromstring(f"<div>{text}</div>")
    words = "".join(whole.itertext())
    assert repr(made[name]).strip("<>") in words


def test_text_of_a_record_is_no_html():
    text = RECORD._repr_html_()
    assert "<b>" not in text
    assert "&lt;b&gt;bold&lt;/b&gt; &amp; more" in text


def test_a_scene_is_drawn_with_every_body_and_wall():
    whole = ElementTree.fromstring(f"<div>{COLUMN._repr_html_()}</div>")
    drawn = whole.findall(".//{http://www.w3.org/2000/svg}polygon")
    assert len(drawn) == len(COLUMN.bodies) + len(COLUMN.walls)


def test_a_drawing_keeps_the_extremes_of_a_long_record():
    values = np.zeros(100_000)
    values[54_321] = 3.0
    text = ex.Record(0.005, values)._repr_html_()
    heights = [float(point.split(",")[1]) for point in text.split('points="')[1].split('"')[0].split()]
    # The curve reaches 95 % of half of the drawing's height of 90 px.
    assert min(heights) == pytest.approx(45.0 * 0.05, abs=0.06)
