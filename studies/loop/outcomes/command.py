"""The commands of `python -m studies.loop` for campaigns that hold outcomes alone: the same files, from outcomes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from studies.campaigns import Campaign
from studies.loop.dataset import save
from studies.loop.finding_file import write_finding
from studies.loop.outcomes.closing import close
from studies.loop.outcomes.dataset import dataset
from studies.loop.outcomes.finding import as_json
from studies.loop.outcomes.prediction import write_outcome_model
from studies.loop.outcomes.report import write_report
from studies.loop.runs.keeping import Keeper


def close_outcomes(
    campaign: Campaign, folder: Path, g: float, tell: Callable[[str], None], keeper: Keeper | None = None
) -> str:
    """Close the loop and write all files into the folder; the finding in a line.

    Raises:
        CampaignError: the outcomes cannot support a finding; it says why.
    """
    finding = close(campaign, g=g, tell=tell, keeper=keeper)
    before, after = finding.stages["before"], finding.stages["after"]
    write_outcome_model(before.model, before.noise, folder / "baseline.toml", campaign.title)
    last = replace(after.model, number=len(campaign.tests))
    write_outcome_model(last, after.noise, folder / "model.toml", campaign.title)
    content = as_json(finding)
    write_finding(content, folder / "loop.json")
    tell("writing loop.nc and report.html")
    tree = dataset(finding)
    save(tree, folder / "loop.nc")
    write_report(finding, content, tree, folder / "report.html")
    error = content["error"]
    named = ", ".join(content["effects"]) or "no effect"
    return (
        f"{content['verdict']}: {named}; outcomes wrong in held-out motions "
        f"{error['before']['holdout']:.3f} -> {error['after']['holdout']:.3f}"
    )
