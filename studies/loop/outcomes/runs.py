"""Does the block fall?  Models run on all tests, each motion at several strengths, and everything that was run kept.

Near the border between falling and not, an outcome hangs on the last digit of the motion.  A motion that is a little
stronger or weaker stands for what is not known of it: the share of strengths at which a model falls varies far more
smoothly with its parameters than the one outcome does.

Status   a model is run once; every later question (other outcomes, other noise) is answered from the table.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from studies.campaigns import DeclaredBlock, Test
from studies.loop.models.model import LoopModel
from studies.loop.outcomes.data import cheap, scaled
from studies.loop.runs.keeping import Keeper, digest_of
from studies.loop.runs.simulation import Answer, Job, Simulator

Falls = NDArray[np.bool_]

NOMINAL = (0.0,)
FINE = (-0.2, -0.1, 0.0, 0.1, 0.2)
"""Logarithms of the strengths at which each motion is run: for the search, and for what is decided on."""


class _Forgetful(Simulator):
    """A simulator that does not keep base motions that a model altered: each model comes once."""

    def run(self, models: Sequence[LoopModel], jobs: Sequence[Job]) -> list[Answer]:
        try:
            return super().run(models, jobs)
        finally:
            self._altered.clear()


def falls_of(simulator: Simulator, models: Sequence[LoopModel]) -> Falls:
    """Whether each model falls in each test, shape (model, test), or goes on to fall where its record ends.

    A run that broke off does not count as a fall.

    Raises:
        ValueError: a model's effects do not go together or are out of range.
    """
    if simulator.keeper is None:
        return _falls_of(simulator, models)
    key = digest_of("falls", simulator.digest, tuple(models))
    kept = simulator.keeper.read(key)
    if kept is None:
        kept = {"fell": _falls_of(simulator, models)}
        simulator.keeper.write(key, kept)
    return kept["fell"]


def _falls_of(simulator: Simulator, models: Sequence[LoopModel]) -> Falls:
    jobs = [
        Job(k, i, np.array([float(test.time[-1])]), float(test.time[0]), float(test.initial_rotation or 0.0))
        for k in range(len(models))
        for i, test in enumerate(simulator.tests)
    ]
    answers = simulator.run(models, jobs)
    fallen = [answer.falls_on(models[job.model].system) for job, answer in zip(jobs, answers, strict=True)]
    return np.array(fallen, dtype=bool).reshape(len(models), len(simulator.tests))


@dataclass
class Runs:
    """Falls of every model that was run, by its parameters.

    Args:
        tests: to run on, in the order of the outcomes.
        numbers: of the tests in the campaign.
        block: as declared.
        keeper: keeps what was run.
    """

    tests: Sequence[Test]
    numbers: Sequence[int]
    block: DeclaredBlock
    keeper: Keeper | None = None
    _simulators: dict[float, Simulator] = field(default_factory=dict)
    _known: dict[tuple[object, float], Falls] = field(default_factory=dict)

    def _simulator(self, strength: float) -> Simulator:
        if strength not in self._simulators:
            tests = [scaled(cheap(test, self.block), math.exp(strength)) for test in self.tests]
            self._simulators[strength] = _Forgetful(tests, list(self.numbers), self.keeper)
        return self._simulators[strength]

    def falls(self, models: Sequence[LoopModel], strengths: Sequence[float] = NOMINAL) -> Falls:
        """Whether each model falls, shape (model, strength, test)."""
        for strength in strengths:
            new = [m for m in models if (_key(m), strength) not in self._known]
            new = list({_key(m): m for m in new}.values())
            if new:
                found = falls_of(self._simulator(strength), new)
                self._known |= {(_key(m), strength): row for m, row in zip(new, found, strict=True)}
        return np.array([[self._known[_key(m), s] for s in strengths] for m in models])


def _key(model: LoopModel) -> object:
    effects: Mapping[str, Mapping[str, float]] = model.effects
    own = tuple((name, tuple(sorted(p.items()))) for name, p in sorted(effects.items()))
    return model.restitution, model.drift, model.fading, own
