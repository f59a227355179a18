"""The cost of a navigator in a separate process: agents' decisions per second.

The same worlds are run in-process and isolated, in turns, with warm processes and kernels; both
include the simulation.
"""

from dataclasses import replace
from functools import partial
from time import perf_counter

from benchmarks.pair import Pair
from benchnav.generation.build import build
from benchnav.runner.rollouts.rollout import Assignment, Seeded, rollout
from benchnav.scenario.catalogue import find

CASES = (  # navigator, scenario, worlds, wanted ratio to the in-process rate
    ("orca", "leaders/dynamic", 64, 0.85),
    ("recurrent-ppo", "leaders/dynamic", 64, 0.85),
    ("orca", "bottleneck/door", 16, 0.85),
    ("orca", "leaders/dynamic", 1, 0.85),
)


def pairs() -> list[Pair]:
    """Return each case: the isolated rate, and the in-process rate as its peer."""
    return [case(*one) for one in CASES]


def case(navigator: str, name: str, count: int, wanted: float) -> Pair:
    """Return the pair of one case."""
    scenario = find(name)
    worlds = [(seed, build(scenario, "test", seed)) for seed in range(count)]
    here = Assignment(
        scenario.identity, scenario.hash, "test", "unknown", navigator, navigator,
        scenario.driver_specs, salt="00",
    )  # fmt: skip
    worlds_ = f"{count} worlds" if count > 1 else "one world"
    return Pair(
        name=f"{navigator} isolated, {name}, {worlds_} at once", unit="decisions/s",
        ours=partial(rate, replace(here, isolated=True), worlds), peer="in-process",
        theirs=partial(rate, here, worlds), wanted=wanted,
    )  # fmt: skip


def rate(assignment: Assignment, worlds: list[Seeded]) -> float:
    """Return agents' decisions per second."""
    began = perf_counter()
    episodes = [e for batch in rollout(assignment, worlds) for e in batch]
    seconds = perf_counter() - began
    return float(sum(e.requested.shape[0] * e.requested.shape[1] for e in episodes)) / seconds
