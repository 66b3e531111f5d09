"""What the records of a campaign say by themselves, before any model: one name for the helpers in the modules beside.

noise, noise_told                        standard deviation of a channel, from its record
measured, independent                    channels that were sampled less often than the record
clipped, overturning_time,
before_overturning, ends_in_motion       rails of a sensor; the fall; a record that stops early
gaps, interpolated, whole_base           missing samples
upsampled, base_motion                   the base as a motion that a solver can run
segment, mean_restitution, state, states swings, impacts, rest; rotation and angular velocity at a time
"""

from studies.campaigns.base_motion import base_motion, upsampled
from studies.campaigns.clipping import before_overturning, clipped, ends_in_motion, overturning_time
from studies.campaigns.gaps import Gap, fill_error, gaps, interpolated, runs, whole_base
from studies.campaigns.noise import Noise, noise, noise_told
from studies.campaigns.sampling import independent, measured
from studies.campaigns.smoothing import State, state
from studies.campaigns.swings import Impact, Segmentation, Swing, mean_restitution, segment, states

__all__ = [
    "Gap",
    "Impact",
    "Noise",
    "Segmentation",
    "State",
    "Swing",
    "base_motion",
    "before_overturning",
    "clipped",
    "ends_in_motion",
    "fill_error",
    "gaps",
    "independent",
    "interpolated",
    "mean_restitution",
    "measured",
    "noise",
    "noise_told",
    "overturning_time",
    "runs",
    "segment",
    "state",
    "states",
    "upsampled",
    "whole_base",
]
