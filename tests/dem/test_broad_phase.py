"""Pairs of bodies of the broad phase, function by function (dem.broad_phase)."""

import numpy as np

from dem.broad_phase import in_order


# By NumPy's sort.
def test_pairs_come_in_the_order_of_both_bodies() -> None:
    rng = np.random.default_rng(5)
    every = np.array([(a, b) for a in range(7) for b in range(a + 1, 9) if a != 3])
    found = rng.permutation(every)[:20].astype(np.int64)
    row, first, second = (np.full(n, -1, dtype=np.int64) for n in (10, 20, 20))
    in_order(found, 20, row, first, second)
    wanted = found[np.lexsort((found[:, 1], found[:, 0]))]
    assert np.column_stack([first, second]).tolist() == wanted.tolist()
    assert row.tolist() == [int(np.sum(wanted[:, 0] < b)) for b in range(10)]
