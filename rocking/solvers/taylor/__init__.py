"""Method 1 by Taylor polynomials, several blocks in the lanes of a vector.

`solver` is what the entry point names; `batch` carries those of `rocking.solve_batch`, and the linear form for the
solver `exact` too; `rocking.solvers.arrays` carries a million blocks from arrays of numbers.
"""
