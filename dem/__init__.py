"""Distinct elements in the plane: rigid bodies that touch each other and a moving table through springs, dashpots and
friction.

Frame   of the table: x to the right, z up, rotation theta > 0 clockwise (leaning to +x). A positive a_x makes a
        block lean to -x.
Source  Winkler, Meguro & Yamazaki (1995), the distinct element chapters; after Cundall (1971)
Status  `simulate`: one convex body on a flat base, the fastest; `simulate_assembly`: any convex bodies and walls
"""

from dem.assemblies import arch, bookshelf, column, drum_column, rubble, running_bond, single
from dem.assembly import Assembly, Body, Wall, block, bodies_of, body, wall
from dem.assembly_history import AssemblyHistory, Ending, Fall, Separation
from dem.assembly_settings import ContactJudgement, Criteria
from dem.assembly_stability import assembly_critical_step
from dem.drop import Drop, squared_difference, stiffness_from_wave_speed, wave_speed_from_stiffness
from dem.free_swings import Swings, let_go, swings, top_displacement
from dem.history import Energies, History, Mode, Outcome
from dem.materials import Contact
from dem.scenes import Scene, single_block, single_polygon
from dem.shapes import Polygon, convex, polygon, rectangle
from dem.simulate import Motion, simulate
from dem.simulate_assembly import simulate_assembly
from dem.stability import critical_step, eq7_step

__all__ = [
    "Assembly",
    "AssemblyHistory",
    "Body",
    "Contact",
    "ContactJudgement",
    "Criteria",
    "Drop",
    "Ending",
    "Energies",
    "Fall",
    "History",
    "Mode",
    "Motion",
    "Outcome",
    "Polygon",
    "Scene",
    "Separation",
    "Swings",
    "Wall",
    "arch",
    "assembly_critical_step",
    "block",
    "bodies_of",
    "body",
    "bookshelf",
    "column",
    "convex",
    "critical_step",
    "drum_column",
    "eq7_step",
    "let_go",
    "polygon",
    "rectangle",
    "rubble",
    "running_bond",
    "simulate",
    "simulate_assembly",
    "single",
    "single_block",
    "single_polygon",
    "squared_difference",
    "stiffness_from_wave_speed",
    "swings",
    "top_displacement",
    "wall",
    "wave_speed_from_stiffness",
]
