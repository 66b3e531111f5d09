"""What the virtual laboratory's block feels of its table: accelerations, heave and pitch that belong together."""

import numpy as np
import pytest

from studies.laboratory.table import Motion, Table, felt_by_motion, felt_by_record, pieces, ramp

H = 0.002
N = 5001
PITCHES = [Table(pitch_acceleration=1.3e-3), Table(pitch_displacement=0.2), Table(vertical=0.15)]


def motion() -> Motion:
    return ramp(np.random.default_rng(5), 1.7, 3.0)


# Columns are a_x, a_z, pitch, its rate and its acceleration: each of the last two is the derivative of the one before.
# A record is integrated without its lowest frequencies, which its acceleration keeps: a hundredth here.
@pytest.mark.parametrize("table", PITCHES, ids=["by acceleration", "by displacement", "heave"])
@pytest.mark.parametrize("recorded", [False, True])
def test_rate_and_acceleration_of_the_pitch_are_its_derivatives(table: Table, recorded: bool) -> None:
    exact = felt_by_motion(motion(), H, N, table)
    felt = felt_by_record(H, motion().derivative(2, H * np.arange(N)), None, table) if recorded else exact
    nodes = felt[:, :, 0]
    inner, near = slice(200, -200), 2e-2 if recorded and table.pitch_displacement else 2e-3
    for column in (2, 3):
        slope = np.gradient(nodes[:, column], H)[inner]
        size = max(np.abs(slope).max(), 1e-12)
        assert np.abs(nodes[inner, column + 1] - slope).max() < near * size
    assert (np.abs(nodes[:, 2]).max() > 1e-4) == bool(table.pitch_acceleration or table.pitch_displacement)
    np.testing.assert_allclose(nodes[inner, 1], table.vertical * nodes[inner, 0], atol=1e-12)


# A spline through the nodes: between them it is what the columns are.
def test_pieces_are_cubics_through_their_nodes() -> None:
    t = 0.01 * np.arange(300)
    columns = [np.sin(3.0 * t + k) for k in range(5)]
    c = pieces(0.01, columns[0], columns[1], (columns[2], columns[3], columns[4]))
    for k in range(5):
        at = np.polynomial.polynomial.polyval(0.004, c[:, k].T)
        np.testing.assert_allclose(at, np.sin(3.0 * (t[:-1] + 0.004) + k), atol=1e-5)
