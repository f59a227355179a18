"""The cost of a navigator in a separate process: agents' decisions per second.

The same worlds are run in-process and isolated, in turns within one run, with warm processes
and kernels; both include the simulation. The best of several turns counts, because other
processes slow down the others.
"""

from dataclasses import replace
from time import perf_counter

from benchnav.generation.build import build
from benchnav.isolation import process_pool
from benchnav.runner.rollouts.rollout import Assignment, Seeded, rollout
from benchnav.scenario.catalogue import find

TURNS = 5
CASES = (  # navigator, scenario, worlds, wanted ratio to the in-process rate
    ("orca", "leaders/dynamic", 64, 0.8),
    ("recurrent-ppo", "leaders/dynamic", 64, 0.8),
    ("orca", "bottleneck/door", 16, 0.8),
    ("orca", "leaders/dynamic", 1, 0.2),
)


def measure() -> list[dict[str, object]]:
    """Return a row for each case: the isolated rate, and the in-process rate as its peer."""
    rows = []
    for navigator, name, count, wanted in CASES:
        scenario = find(name)
        worlds = [(seed, build(scenario, "test", seed)) for seed in range(count)]
        here = Assignment(
            scenario.identity, scenario.hash, "test", "unknown", navigator, navigator,
            scenario.driver_specs, salt="00",
        )  # fmt: skip
        modes = (here, replace(here, isolated=True))
        turns = [[rate(mode, worlds) for mode in modes] for _ in range(TURNS + 1)][1:]
        inside, apart = (max(column) for column in zip(*turns, strict=True))
        process_pool.stop_all()
        worlds_ = f"{count} worlds" if count > 1 else "one world"
        rows.append(
            {
                "name": f"{navigator} isolated, {name}, {worlds_} at once",
                "value": apart, "unit": "decisions/s", "peer": inside, "wanted": wanted,
                "ratio": apart / inside,
            }
        )  # fmt: skip
    return rows


def rate(assignment: Assignment, worlds: list[Seeded]) -> float:
    """Return agents' decisions per second."""
    began = perf_counter()
    episodes = [e for batch in rollout(assignment, worlds) for e in batch]
    seconds = perf_counter() - began
    return float(sum(e.requested.shape[0] * e.requested.shape[1] for e in episodes)) / seconds


if __name__ == "__main__":
    for row in measure():
        print(row)
