"""What comes back of each run of a batch: a row of numbers, by column.

Status   the compiled batch and the program for a device of JAX write the same rows.
"""

from __future__ import annotations

OVERTURNED, SIDE, OVERTURNING, LARGEST, COUNT, FINISHED, ENDED, FIRST, LAST_MODE = range(9)
"""Whether and to which side it fell, its last outward passage of unstable balance [s], the largest |tilt| [rad], the
number of impacts, whether it ended well, when it ended [s], when it first moved [s], and its last mode."""

COLUMNS = 9
