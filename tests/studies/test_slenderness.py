"""From which frequency a block rocks before it falls (studies.slenderness)."""

import math

import numpy as np
import xarray as xr

from studies.slenderness import from_which


def test_the_frequency_from_which_all_rock_first_is_the_lowest_above_every_one_that_does_not():
    """By hand: periods of rocking are (fall - onset) f, more than one counts, and a block that stands has its 10 s."""
    frequency = np.array([0.5, 1.0, 2.0, 4.0])
    lasting = {  # seconds between onset and fall; the frequencies at which that is over a period
        "all but the lowest": ([1.0, 2.0, 2.0, 2.0], 1.0),
        "an early one alone does not count": ([3.0, 0.5, 2.0, 2.0], 2.0),
        "the highest does not": ([3.0, 3.0, 3.0, 0.1], math.nan),
        "stands": ([3.0, 3.0, 3.0, math.nan], 0.5),
    }
    times = np.array([times for times, _ in lasting.values()])
    ds = xr.Dataset(
        {"onset_time": (("case", "frequency"), np.full(times.shape, 5.0)),
         "overturning_time": (("case", "frequency"), 5.0 + times)},
        {"frequency": frequency, "case": list(lasting)}, {"duration": 10.0},
    )  # fmt: skip
    np.testing.assert_array_equal(from_which(ds), [expected for _, expected in lasting.values()])
