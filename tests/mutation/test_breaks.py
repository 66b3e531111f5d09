"""The script of breaks: what it breaks, what it leaves alone, and that a file is put back as it was."""

import ast
from pathlib import Path

import pytest

from .breaks import breaks_of
from .physics import FIRST, files, first_tests

ROOT = Path(__file__).resolve().parents[2]
TOY = '''"""Energy - of µ blocks, 2 * 3."""

def energy(v: "a < b", x: list[float], m: float = -1.0) -> float:
    """Not 1 < 2."""
    if m < 0.0:
        raise ValueError(f"m={m + 1}")
    first, µ = x[0], min(m, (x[1]) - (v))
    return 0.5 * m * v**2 + math.sin(first)

def figure(ax):
    return 1 - 2
'''.encode()
# By hand: the sign of the default; the index, the index, min, the minus and the plus; 0.5 and both stars, 2, sin.
BY_HAND = {
    "m: float = +1.0)": "sign",
    "first, µ = x[1], min(": "index",
    "max(m, (x[1]) - (v))": "min/max",
    "(x[0]) - (v))": "index",
    "(x[1]) + (v))": "sign",
    "return 0.25 * m * v**2 +": "factor",
    "0.5 / m * v**2": "factor",
    "0.5 * m / v**2": "factor",
    "v**3 +": "factor",
    "v**2 - math": "sign",
    "math.cos(first)": "sin/cos",
}


def test_breaks_of_a_toy_are_those_counted_by_hand() -> None:
    found = breaks_of("toy.py", TOY)
    assert len(found) == len(BY_HAND)
    for text, kind in BY_HAND.items():
        (one,) = [b for b in found if text in b.after]
        assert (one.kind, one.function, one.file) == (kind, "energy", "toy.py")
        broken = one.apply(TOY).decode()
        assert broken.splitlines()[one.line - 1].strip() == one.after
        assert [a for a, b in zip(TOY.decode().splitlines(), broken.splitlines(), strict=True) if a != b] == [
            TOY.decode().splitlines()[one.line - 1]
        ]
        assert ast.dump(ast.parse(broken)) != ast.dump(ast.parse(TOY))


@pytest.mark.parametrize(("text", "others"), [("a < b", {"a <= b", "a > b"}), ("a == b", {"a != b"})])
def test_a_comparison_is_moved_to_its_edge_or_turned_round(text: str, others: set[str]) -> None:
    assert {b.after for b in breaks_of("toy.py", text.encode())} == others


def test_the_tests_named_for_each_file_of_physics_are_there() -> None:
    for path in files(ROOT):
        assert first_tests(ROOT, str(path)), f"{path}: no test is named for it"
    for pattern, tests in FIRST:
        folder = ROOT / "tests" / pattern.partition("/")[0]
        missing = [name for name in tests if not (folder / f"{name}.py").is_file()]
        assert not missing, f"{pattern}: {missing}"
