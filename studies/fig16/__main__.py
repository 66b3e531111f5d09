"""Fig. 16 of Winkler, Meguro & Yamazaki (1995): criteria of overturning of Blocks 1, 3 and 7 by three methods."""

from studies.fig16 import STUDY

if __name__ == "__main__":
    STUDY.run()
