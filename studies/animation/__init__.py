"""Runs of distinct elements to look at: frames at given instants, animations, and a page to play.

`frames(run, times)` draws the bodies at given instants.
"""

from studies.animation.film import Film, film_of
from studies.animation.frames import draw_frame, frames

__all__ = ["Film", "draw_frame", "film_of", "frames"]
