"""What a measured campaign holds: `python -m studies.campaigns CAMPAIGN.toml [--plot DIR]`.

A row for each test (length, peaks, impacts seen, restitution over the impacts, outcome), the noise of each channel as
declared and as its records show it, and warnings.  "drive" is the slope of what the block felt on what the base record
gives: 1 for a block as declared, -1 where signs are wrong, 9.8 where the base is in g.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from tqdm import tqdm

from studies.campaigns.drawing import figure
from studies.campaigns.errors import CampaignError
from studies.campaigns.model import Campaign
from studies.campaigns.reading import read
from studies.campaigns.summary import Look, look, summary
from studies.running.command_line import run
from studies.running.files import BadInputError, writable_folder, write_whole


def _parser() -> argparse.ArgumentParser:
    text = (__doc__ or "").split("\n\n")
    parser = argparse.ArgumentParser(prog="python -m studies.campaigns", description=text[0], epilog=text[1])
    parser.add_argument("campaign", type=Path, help="campaign.toml, or the folder that holds it")
    parser.add_argument("--plot", type=Path, metavar="DIR", help="draw each test as DIR/<test id>.png")
    return parser


def _draw(looks: list[Look], campaign: Campaign, folder: Path) -> None:
    for each in tqdm(looks, "drawing", unit="test", disable=None):
        drawing = figure(each, campaign)
        write_whole(folder / f"{each.test.id}.png", lambda target, d=drawing: d.savefig(target, format="png", dpi=110))  # type: ignore[misc]


def main(arguments: list[str]) -> None:
    """Print the table and draw the tests; BadInputError if the campaign cannot be used or the folder not written."""
    options = _parser().parse_args(arguments)
    try:
        campaign = read(options.campaign)
    except CampaignError as error:
        raise BadInputError(str(error)) from error
    folder = None if options.plot is None else writable_folder(options.plot)
    looks = [look(test, campaign) for test in tqdm(campaign.tests, "looking", unit="test", disable=None, leave=False)]
    print(summary(campaign, looks))
    if folder is not None:
        _draw(looks, campaign, folder)
        print(f"\n{len(looks)} pictures in {folder}", file=sys.stderr)


if __name__ == "__main__":
    run(main)
