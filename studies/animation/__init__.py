"""Runs of distinct elements to look at: frames at given instants, animations, and a page to play.

`save(run, "run.html")` (or .gif, .mp4) animates a run, `frames(run, times)` draws the bodies at given instants; `run`
is a history of `dem`, its dataset, or a file that holds one. From the command line: `python -m studies.animation RUN.nc
--out RUN.html`.
"""

from studies.animation.film import Film, film_of
from studies.animation.frames import draw_frame, frames
from studies.animation.saving import save

__all__ = ["Film", "draw_frame", "film_of", "frames", "save"]
