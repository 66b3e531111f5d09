"""Assemblies under earthquake records, as the authors had planned: what runs, what is kept of the base, what closes."""

import numpy as np
import pytest

import dem
from excitation.kanai_tajimi import KanaiTajimi

DENSITY = 597.0
STEADY = dem.Contact(0.7, damping_ratio=0.2)
SHAKING = KanaiTajimi(rms=3.0, duration=4.0, rise=0.5, strong_end=3.0)
SCENES = {
    "column": dem.column(3, 0.15, 0.5, 0.25, DENSITY),
    "next to a wall": dem.column(2, 0.15, 0.5, 0.25, DENSITY, wall_gap=0.02),
    "shelf": dem.bookshelf(6),
    "masonry": dem.running_bond(4, 3),
    "drums": dem.drum_column(4),
}


@pytest.mark.parametrize("name", SCENES)
def test_a_record_moves_an_assembly_and_its_energies_close(name):
    across, up = SHAKING.record(0.01, seed=1), SHAKING.record(0.01, seed=2)
    motion = across.motion(up)
    run = dem.simulate_assembly(
        SCENES[name], motion, t_end=4.0, contact=STEADY, criteria=dem.Criteria(stop="never", margin=50.0)
    )
    assert run.ending is dem.Ending.REACHED_END
    # 3 m/s^2 (rms) is beyond b/h of each scene, so each rocks.
    assert np.abs(run.theta).max() > 1e-3
    energies = run.energies
    handled = energies.kinetic.max() + energies.dashpot[-1] + energies.friction[-1]
    # The turn of a corner's lever within a step, of second order in a step of a quarter of the critical one.
    assert np.ptp(energies.balance) < 2e-4 * handled
    a_x, a_z = motion(run.time)
    assert np.array_equal(run.base_ax, a_x) and np.array_equal(run.base_az, a_z)


def test_the_base_as_it_moved_is_in_the_dataset_with_its_pitch():
    class Pitching:
        def __call__(self, t):
            return np.cos(t), 0.1 * t

        def pitch(self, t):
            return 0.01 * np.sin(3.0 * t), -0.09 * np.sin(3.0 * t)

    run = dem.simulate_assembly(SCENES["column"], Pitching(), t_end=0.5, contact=STEADY)
    ds = run.to_xarray()
    assert ds.base_ax.values == pytest.approx(np.cos(run.time), abs=0.0)
    assert ds.base_az.values == pytest.approx(0.1 * run.time, abs=0.0)
    assert ds.base_pitch.values == pytest.approx(0.01 * np.sin(3.0 * run.time), abs=0.0)
    still = dem.simulate_assembly(SCENES["column"], t_end=0.1, contact=STEADY).to_xarray()
    assert not still.base_ax.values.any() and "base_pitch" not in still


def test_a_dataset_holds_the_outlines_of_its_bodies_and_walls():
    scene = SCENES["next to a wall"]
    ds = dem.simulate_assembly(scene, t_end=0.1, contact=STEADY, keep=[1]).to_xarray()
    corners = np.column_stack([ds.outline_x.values, ds.outline_z.values])
    assert np.array_equal(corners[ds.outline_of.values == 0], scene.bodies[1].shape.corners)
    assert np.array_equal(corners[ds.outline_of.values == 1], scene.walls[0].vertices)
    assert ds.attrs["floor"] == 1
