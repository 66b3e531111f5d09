"""A virtual laboratory: measured campaigns with a hidden truth, to judge studies.loop with.

Status   Independent of the packages under test: the physics is derived here once more and nothing of rocking or
         excitation is called, of dem by by_dem alone.  studies.campaigns only writes the folder.
Parts    parameters: block and effects in one vector.  event: the rocking block, impacts and lift-offs located.
         slip: the same with friction that gives way.  contact: springs under the base (soft floor, bouncing).
         by_mujoco: the block in MuJoCo, where that is installed.  by_dem: one distinct element of `dem`.
         table: motions of the table and what a frame on it feels.  effects: what can be wrong, named and unnamed.
         instruments: channels and their nuisances.  campaign: make_campaign.  truth, judge: what should have come out.
"""

from .campaign import make_campaign
from .effects import NAMED, UNNAMED
from .judge import judge
from .truth import Truth

__all__ = ["NAMED", "UNNAMED", "Truth", "judge", "make_campaign"]
