"""Close the loop on a measured campaign, or predict a campaign with a saved model.

python -m studies.loop CAMPAIGN.toml --out DIR
python -m studies.loop predict DIR/model.toml CAMPAIGN.toml --out DIR2
"""

from __future__ import annotations

import argparse
import math
import os
import shutil
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from excitation import _early
from studies.campaigns import Campaign, CampaignError, read
from studies.loop.closing import STANDARD_GRAVITY, close
from studies.loop.dataset import dataset, save
from studies.loop.finding_file import as_json, write_finding
from studies.loop.models.model_file import ModelError, read_model, write_model
from studies.loop.outcomes.command import close_outcomes
from studies.loop.outcomes.prediction import read_noise, write_outcome_predictions
from studies.loop.prediction import write_predictions
from studies.loop.proposing import next_test
from studies.loop.report.page import write_report
from studies.loop.runs.keeping import Keeper
from studies.running.command_line import said_of
from studies.running.files import BadInputError, writable_folder
from studies.running.lock import alone

KEPT = (
    "what was in the folder of --out before is as it was, fits that were finished are kept, the same command goes on "
    "from there"
)


class _Progress:
    """One line on the terminal that says what is being done and since when."""

    def __init__(self, quiet: bool) -> None:
        self.start, self.quiet = time.monotonic(), quiet

    def __call__(self, text: str) -> None:
        if not self.quiet:
            line = f"{time.monotonic() - self.start:6.1f} s  {text}"
            # In one piece: threads may tell of two fits at once.
            sys.stderr.write(line.ljust(78) + "\r" if sys.stderr.isatty() else line + "\n")
            sys.stderr.flush()


UNFINISHED = ".unfinished-"


@contextmanager
def _together(folder: Path, keeper: Keeper | None = None) -> Iterator[Path]:
    """A folder to write into, whose files come into `folder` when all are there: they belong to one finding.

    keeper: forgets what it kept when the files are there.

    Raises:
        BadInputError: the folder cannot be written to, or another run is at work in it.
    """
    writable_folder(folder)
    with alone(folder / "loop", wait=False):
        for left in folder.glob(f"{UNFINISHED}*"):  # of a run that was killed
            shutil.rmtree(left, ignore_errors=True)
        with tempfile.TemporaryDirectory(prefix=UNFINISHED, dir=folder) as made:
            yield Path(made)
            for path in sorted(Path(made).iterdir()):
                os.replace(path, folder / path.name)
            if keeper is not None:
                keeper.clear()


def _close(arguments: argparse.Namespace) -> None:
    if arguments.gravity is not None and not (math.isfinite(arguments.gravity) and arguments.gravity > 0.0):
        raise BadInputError(f"--gravity {arguments.gravity}: want a positive number [m/s^2]")
    campaign = read(arguments.campaign)
    tell = _Progress(arguments.quiet)
    keeper = Keeper(arguments.out)
    with _together(arguments.out, keeper) as folder:
        if campaign.holds_outcomes_alone:
            gravity = STANDARD_GRAVITY if arguments.gravity is None else arguments.gravity
            said = close_outcomes(campaign, folder, gravity, tell, keeper)
        else:
            said = _close_records(campaign, arguments.gravity, folder, tell, keeper)
    print(said)


def _close_records(
    campaign: Campaign, gravity: float | None, folder: Path, tell: Callable[[str], None], keeper: Keeper
) -> str:
    """Close the loop on records and write all files into the folder; the finding in a line."""
    finding = close(campaign, g=gravity, tell=tell, keeper=keeper)
    write_model(finding.before, folder / "baseline.toml", campaign.title)
    write_model(finding.later(finding.after), folder / "model.toml", campaign.title)
    content = as_json(finding, next_test(finding))
    write_finding(content, folder / "loop.json")
    tell("writing loop.nc and report.html")
    tree = dataset(finding)
    save(tree, folder / "loop.nc")
    write_report(finding, content, tree, folder / "report.html")
    before, after = (finding.errors[stage].holdout for stage in ("before", "after"))
    return (
        f"{content['verdict']}: {', '.join(content['effects']) or 'no effect'}; "
        f"held-out error {before:.3g} -> {after:.3g} {finding.units}"
    )


def _predict(arguments: argparse.Namespace) -> None:
    model = read_model(arguments.model)
    campaign = read(arguments.campaign)
    noise, tell = read_noise(arguments.model), _Progress(arguments.quiet)
    with _together(arguments.out) as folder:
        if noise is None:
            summary = write_predictions(model, campaign, folder, tell)
        else:
            summary = write_outcome_predictions(model, noise, campaign, folder, tell)
    fell = sum(row["overturned"] for row in summary.values())
    print(f"{len(summary)} tests predicted, {fell} overturn; written to {arguments.out}")


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command; 0 if it did, 2 where something is wrong with what it was given, 1 if it cannot be written."""
    _early.loaded()
    given = list(sys.argv[1:] if arguments is None else arguments)
    predicting = given[:1] == ["predict"]
    parser = argparse.ArgumentParser(
        prog="python -m studies.loop" + (" predict" if predicting else ""),
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter,
    )  # fmt: skip
    if predicting:
        parser.add_argument("model", type=Path, help="model.toml that the loop wrote")
    parser.add_argument("campaign", type=Path, metavar="CAMPAIGN.toml", help="the campaign, or its folder")
    parser.add_argument("--out", type=Path, required=True, metavar="DIR", help="folder for what is written")
    parser.add_argument("--quiet", action="store_true", help="say nothing of the progress")
    if not predicting:
        parser.add_argument(
            "--gravity", type=float, metavar="G",
            help=f"m/s^2; if not given {STANDARD_GRAVITY}, or what accelerometers on the block read",
        )  # fmt: skip
    parsed = parser.parse_args(given[1:] if predicting else given)
    try:
        (_predict if predicting else _close)(parsed)
    except (CampaignError, ModelError, BadInputError) as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    except OSError as error:
        print(f"error: {said_of(error, KEPT)}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        print(f"interrupted: {KEPT}", file=sys.stderr)
        return 130
    return 0


if __name__ == "__main__":
    sys.exit(main())
