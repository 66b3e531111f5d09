"""Outlines as labelled variables, so that a dataset of a run holds all that is needed to draw it.

Source  CF conventions, section 9.3.4 (indexed ragged arrays): corners of all things one after the other
Status  read back as they were written (tests)
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from dem.shapes import FloatArray


def outline_variables(bodies: Sequence[FloatArray], walls: Sequence[FloatArray] = ()) -> dict[str, Any]:
    """Variables `outline_x`, `outline_z` [m] and `outline_of` over `corner`, as arguments of `xarray.Dataset`.

    bodies: corners of each from its centroid, before it turns, shape (corner, 2); walls: corners of each in the frame
    of the table. `outline_of` counts the bodies of the dataset, then the walls.
    """
    things = [*bodies, *walls]
    owner = np.repeat(np.arange(len(things)), [len(corners) for corners in things])
    corners = np.concatenate(things)
    where = "corner from the centroid, before the body turns; of a wall in the frame of the table"
    return {
        "outline_x": ("corner", corners[:, 0].copy(), {"units": "m", "long_name": f"{where}, to the right"}),
        "outline_z": ("corner", corners[:, 1].copy(), {"units": "m", "long_name": f"{where}, up"}),
        "outline_of": ("corner", owner, {"units": "1", "long_name": "number of the body, then of the wall"}),
    }


def base_variables(a_x: FloatArray, a_z: FloatArray, pitch: FloatArray | None = None) -> dict[str, Any]:
    """Motion of the base at the samples: `base_ax`, `base_az` [m/s^2] and, where it pitches, `base_pitch` [rad]."""
    variables: dict[str, Any] = {
        "base_ax": ("time", a_x, {"units": "m s-2", "long_name": "acceleration of the base to the right"}),
        "base_az": ("time", a_z, {"units": "m s-2", "long_name": "acceleration of the base upwards"}),
    }
    if pitch is not None and pitch.any():
        variables["base_pitch"] = ("time", pitch, {"units": "rad", "long_name": "pitch of the base, clockwise"})
    return variables
