"""Fig. 5 of Winkler, Meguro & Yamazaki (1995): free vibration of Block 1, by Method 1 and by distinct elements."""

from studies.fig05 import STUDY

if __name__ == "__main__":
    STUDY.run()
