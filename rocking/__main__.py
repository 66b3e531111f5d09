"""`python -m rocking`: which commands there are; the questions themselves are answered by `studies`.

Reading a record is the work of `excitation`, of which this package knows nothing; so the command that takes a block and
a record lives in `studies`, which knows both.
"""

from __future__ import annotations

import sys
from importlib.metadata import version

COMMANDS = """\
rocking-blocks {version}

  python -m studies.will_it_fall 0.30 1.80 --pga 0.3g    will a block of 0.30 x 1.80 m rock, will it fall?
  python -m studies.will_it_fall 0.30 1.80 --record FILE the same for a record, with the margin
  python -m excitation FILE                              what a record file holds
  python -m studies                                      the figures of Winkler, Meguro & Yamazaki (1995), a list
  python -m studies.sweep FILE.toml --out FILE.nc        criteria over any axes, on cores or on a cluster
  python -m studies.campaigns FOLDER                     what a measured campaign holds
  python -m studies.loop FOLDER --out DIR                what the ideal block lacks in it

Installed, the first is also will-it-fall, and the others of studies rocking-studies COMMAND.
Each says more with --help. In Python: from rocking import Block, Method1, Method2, solve
"""


def main(arguments: list[str]) -> int:
    """Print the commands; 0, or 2 where something was asked of this one."""
    asked = [argument for argument in arguments if argument not in ("-h", "--help")]
    if asked:
        print(f"error: {asked[0]!r}: want no argument here; try python -m studies.will_it_fall --help", file=sys.stderr)
        return 2
    print(COMMANDS.format(version=version("rocking-blocks")), end="")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
