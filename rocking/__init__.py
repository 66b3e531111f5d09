"""One free-standing block on a moving base: when it rocks, slides, jumps and falls.

    from rocking import Block, Method1, Method2, solve

Methods are hybrid systems (`rocking.hybrid`), solvers are plugins (`rocking.solvers`); importing this package
loads neither SciPy nor numba nor JAX.
"""

from rocking import _sources as _sources  # before what it watches
from rocking.batch import BatchResult, solve_batch
from rocking.block import G_STANDARD, WOOD_DENSITY, Block
from rocking.hybrid import Mode
from rocking.method1 import Method1
from rocking.method2 import Method2
from rocking.solve import solve
from rocking.trajectory import Outcome, Trajectory

__all__ = [
    "G_STANDARD",
    "WOOD_DENSITY",
    "BatchResult",
    "Block",
    "Method1",
    "Method2",
    "Mode",
    "Outcome",
    "Trajectory",
    "solve",
    "solve_batch",
]
