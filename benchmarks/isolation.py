"""What it costs to put a navigator into a process of its own: agents' decisions a second.

The same worlds in-process and isolated, in turns in one run, processes and kernels warm;
the simulation is in both. The best of several turns each: the rest is other processes'.
"""

from dataclasses import replace
from time import perf_counter

from benchnav.generation.build import build
from benchnav.isolation import process_pool
from benchnav.runner.rollouts.rollout import Assignment, Seeded, rollout
from benchnav.scenario.catalogue import find

TURNS = 5
CASES = (  # navigator, scenario, worlds, least share of the rate in-process that is wanted
    ("orca", "leaders/dynamic", 64, 0.8),
    ("recurrent-ppo", "leaders/dynamic", 64, 0.8),
    ("orca", "bottleneck/door", 16, 0.8),
    ("orca", "leaders/dynamic", 1, 0.2),
)


def measure() -> list[dict[str, object]]:
    """A row for each case: the rate isolated, against the rate in-process."""
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
    """Agents' decisions a second."""
    began = perf_counter()
    episodes = [e for batch in rollout(assignment, worlds) for e in batch]
    seconds = perf_counter() - began
    return float(sum(e.requested.shape[0] * e.requested.shape[1] for e in episodes)) / seconds


if __name__ == "__main__":
    for row in measure():
        print(row)
