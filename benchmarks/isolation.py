"""The cost of a navigator in a separate process: agents' decisions per second.

The same worlds are run in-process and isolated, in turns, with warm processes and kernels; both
include the simulation.
"""

from functools import cache, partial
from time import perf_counter

from benchmarks.pair import Pair
from benchnav.generation.build import build
from benchnav.runner.rollouts.rollout import Assignment, Seeded, rollout
from benchnav.scenario.catalogue import find

CASES = (  # navigator, scenario, worlds, wanted ratio to the in-process rate
    ("orca", "leaders/dynamic", 64, 0.85),
    ("recurrent-ppo-vo", "leaders/dynamic", 64, 0.85),
    ("orca", "bottleneck/door", 16, 0.85),
    ("orca", "leaders/dynamic", 1, 0.85),
)
LIMIT = (
    "Each call switches to the process and back, and the process copies and decodes its request."
)


def pairs() -> list[Pair]:
    """Return each case: the isolated rate, and the in-process rate as its peer."""
    return [case(*one) for one in CASES]


def case(navigator: str, name: str, count: int, wanted: float) -> Pair:
    """Return the pair of one case."""
    worlds = f"{count} worlds" if count > 1 else "one world"
    return Pair(
        name=f"{navigator} isolated, {name}, {worlds} at once", unit="decisions/s",
        ours=partial(rate, navigator, name, count, True), peer="in-process",
        theirs=partial(rate, navigator, name, count, False), wanted=wanted, limit=LIMIT,
    )  # fmt: skip


@cache
def drawn(name: str, count: int) -> list[Seeded]:
    """Return worlds of a scenario, with their seeds."""
    return [(seed, build(find(name), "test", seed)) for seed in range(count)]


def rate(navigator: str, name: str, count: int, isolated: bool) -> float:
    """Return agents' decisions per second."""
    scenario, worlds = find(name), drawn(name, count)
    assignment = Assignment(
        scenario.identity, scenario.hash, "test", "unknown", navigator, navigator,
        scenario.driver_specs, salt="00", isolated=isolated,
    )  # fmt: skip
    began = perf_counter()
    episodes = [e for batch in rollout(assignment, worlds) for e in batch]
    seconds = perf_counter() - began
    return float(sum(e.requested.shape[0] * e.requested.shape[1] for e in episodes)) / seconds
