"""What a prompt or a notebook shows of public objects: short, and nothing of a stranger's text in it as HTML."""

import xml.etree.ElementTree as ElementTree

import numpy as np
import pytest

import dem
import excitation as ex
from rocking import Block, Method1, Method2, Mode, Outcome, solve, solve_batch

SYSTEM = Method1(Block(b=0.15, h=0.5))
RECORD = ex.Record(0.01, np.sin(np.arange(5000) / 7.0), source="<b>bold</b> & more")
COLUMN = dem.column(2, 0.15, 0.5, 0.25, 597.0, wall_gap=0.01)


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
        "assembly": COLUMN, "wall of blocks": dem.running_bond(10, 10), "body": COLUMN.bodies[0],
        "wall": COLUMN.walls[0], "assembly history": run, "contact": contact, "criteria": dem.Criteria(),
    }  # fmt: skip


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
