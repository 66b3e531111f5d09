"""Models that the loop fits and saves: the block with its effects, their parameters, what to try, names and files."""
