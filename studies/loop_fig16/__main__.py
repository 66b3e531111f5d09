"""The loop on the paper's own gap: what does Method 1 lack at high amplitude?  Fig. 16 before and after."""

from studies.loop_fig16 import STUDY

if __name__ == "__main__":
    STUDY.run()
