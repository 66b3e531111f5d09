"""The specimens of Table 1."""

import pytest

from studies.specimens import SIZES, specimen


def test_slenderness_is_that_of_table_1():
    # Winkler, Meguro & Yamazaki (1995), Table 1, column b/h.
    printed = {1: 0.3, 2: 0.3, 3: 0.3, 4: 0.3, 5: 0.5, 6: 0.4, 7: 0.2}
    assert {n: specimen(n).b / specimen(n).h for n in SIZES} == pytest.approx(printed, rel=1e-12)


def test_blocks_1_to_4_scale_as_printed():
    # Same table, column k: Block n is k times Block 3 in every dimension.
    for number, k in {1: 2.0, 2: 1.5, 3: 1.0, 4: 0.5}.items():
        block, unit = specimen(number), specimen(3)
        assert (block.b, block.h, block.d) == pytest.approx((k * unit.b, k * unit.h, k * unit.d), rel=1e-12)


def test_lightest_block_weighs_1_4_kg():
    # Same paper, "Numerical stability": the lightest block used weighs 1.4 kg.
    masses = {n: specimen(n).mass for n in SIZES}
    assert min(masses, key=masses.get) == 4
    assert masses[4] == pytest.approx(1.4, abs=0.005)


def test_unknown_block_is_refused():
    with pytest.raises(ValueError, match="block 8: want one of 1, 2, 3, 4, 5, 6, 7"):
        specimen(8)
