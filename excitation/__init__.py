"""What the base does: prescribed motions that a solver can evaluate at any time.

A motion is an immutable object.  Calling it with times gives accelerations; its `kernel` and `parameters` are the
same formula in the form that a compiling solver takes (see `excitation.motion.Motion`).
"""

from excitation.motion import Motion
from excitation.ramped_sinusoid import RampedSinusoid

__all__ = ["Motion", "RampedSinusoid"]
