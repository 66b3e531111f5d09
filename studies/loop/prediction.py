"""Predictions of a saved model: every test of a campaign from its base motion and its initial rotation alone."""

from __future__ import annotations

import csv
import json
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rocking.effects.learned_memory import LearnedMemory
from studies.campaigns import Campaign, CampaignError
from studies.campaigns.errors import shown
from studies.campaigns.lost_base import used
from studies.loop.models.model import LoopModel
from studies.loop.observed.instruments import accelerations
from studies.loop.runs.simulation import Answer, Job, Simulator
from studies.running.files import save_text, write_whole

Array = NDArray[np.float64]

MOST_EVENTS = 1_000_000
"""Of a run, as of `rocking.solve`; fits give up earlier on models that rattle."""

OTHER_COLUMNS = ("time", "rotation")
"""Those of a prediction that no channel is."""


def predict(model: LoopModel, campaign: Campaign, simulator: Simulator | None = None) -> list[Answer]:
    """The answer of the model to each test, in the order of the campaign; a free test starts from its declared lean.

    simulator: of the tests of the campaign, if there is one already.

    Runs are on the base record as it is.  Thinned as for fits it has less noise, by which errors of unseen tests were
    4 % less in the mean (27 campaigns of a series), but other noise than a true model would meet in it: where a test
    hangs on that, the one is met and the other lost.
    """
    simulator = simulator or simulator_of(campaign)
    jobs = [
        Job(0, k, np.ascontiguousarray(test.time), float(test.time[0]), float(test.initial_rotation or 0.0))
        for k, test in enumerate(campaign.tests)
    ]
    if not model.effects.get(LearnedMemory.name, {}).get("worn"):
        return simulator.run([model], jobs)
    answers: list[Answer] = []
    for job in jobs:  # what a test wears the next one finds
        answers += simulator.run([model], [job])
        use = answers[-1].y[:, model.system.state_names.index("use")]
        model = model.changed({f"{LearnedMemory.name}.used": use[np.flatnonzero(np.isfinite(use))[-1]]})
    return answers


def simulator_of(campaign: Campaign) -> Simulator:
    """Runs on the tests of a campaign that may rattle for long."""
    return Simulator(campaign.tests, most_events=MOST_EVENTS)


def write_predictions(
    model: LoopModel, campaign: Campaign, folder: Path, tell: Callable[[str], None] = lambda text: None
) -> dict[str, Any]:
    """Predict every test and write a CSV for each and `predict.json`; what predict.json holds is returned.

    A CSV holds `time` [s], `rotation` [rad] and each declared channel on the block [m/s^2]; empty fields after a fall,
    and from where a run had to stop or the base is lost, which `tell` and a note in predict.json say.  A test that ends
    beyond the balance and not on the way back counts as overturned.

    Raises:
        CampaignError: a channel on the block has the name of another column, or a base motion is lost from the
            beginning.
    """
    for channel in campaign.channels:
        if channel.kind == "block_acceleration" and channel.name in OTHER_COLUMNS:
            raise CampaignError(
                f"channel {shown(channel.name)}: a prediction has a column of that name besides, want another one"
            )
    recorded, campaign = campaign, used(campaign)
    folder.mkdir(parents=True, exist_ok=True)
    summary: dict[str, dict[str, Any]] = {}
    simulator = simulator_of(campaign)
    answers = predict(model, campaign, simulator)
    for k, (test, answer) in enumerate(zip(campaign.tests, answers, strict=True)):
        tell(test.id)
        columns = {"rotation": simulator.recorded(model, k, answer.theta)}
        for channel in campaign.channels:
            if channel.kind == "block_acceleration":
                columns[channel.name] = accelerations(model, simulator, k, answer, channel)
        times = recorded.tests[k].time
        _write_csv(folder / f"{test.id}.csv", times, columns, answer)
        system = simulator.in_test(model, k).system
        overturned, when = answer.falls_on(system), answer.overturning_time
        if overturned and not answer.fell:
            when = answer.passes_balance(system, test.time)
        summary[test.id] = {"overturned": overturned, "time": None if math.isnan(when) else when}
        if answer.failed:
            last = test.time[np.flatnonzero(np.isfinite(answer.y[:, 0]))].max(initial=test.time[0])
            stopped = f"the run of the model stopped after {last:g} s: what follows is not predicted"
        elif test.time.size < times.size:
            stopped = f"the base motion is lost after {test.time[-1]:g} s: what follows is not predicted"
        else:
            continue
        summary[test.id]["note"] = stopped
        tell(f"{test.id}: {stopped}")
    save_text(json.dumps({"tests": summary}, indent=1) + "\n", folder / "predict.json")
    return summary


def _write_csv(path: Path, times: Array, columns: dict[str, Array], answer: Answer) -> None:
    after = np.isnan(answer.y[:, 0])

    def write(target: Path) -> None:
        with target.open("w", newline="", encoding="utf-8") as stream:
            writer = csv.writer(stream)
            writer.writerow(["time", *columns])
            for i, t in enumerate(times):
                none = i >= after.size or after[i]
                row = ["" if none or not math.isfinite(c[i]) else f"{c[i]:.8g}" for c in columns.values()]
                # Clocks may count from long ago: as many digits as tell neighbours apart.
                writer.writerow([f"{t:.15g}", *row])

    write_whole(path, write)
