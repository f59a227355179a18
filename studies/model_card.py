"""``python -m studies.model_card recurrent-ppo [--seed WEIGHTS]``: measure a learned navigator.

Writes its model card: where it learned, what that cost, what each stage gained, and strict
success per agent in worlds of the test split, with the interval clustered by world, beside
what full knowledge reached in the same worlds, what the same weights reach with or without
correction, and what other seeds of the training reached.
"""

import argparse
import json
import os
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from itertools import chain
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from benchnav.arena.solid import Kind
from benchnav.arrays import FloatArray
from benchnav.episode.episode import Episode
from benchnav.generation.build import build
from benchnav.leaderboard.statistics.interval import effective_size, mid_p
from benchnav.metrics.smoothness import turning
from benchnav.metrics.success import success, timeout
from benchnav.navigation.plugin.configure import Spec, make
from benchnav.plugins import NAVIGATORS
from benchnav.runner.rollouts.rollout import Assignment, rollout
from benchnav.scenario.catalogue import find

SCENARIOS = (
    "leaders/static", "leaders/static-corner", "leaders/moved", "leaders/dynamic",
    "leaders/dynamic-corner", "corridor/bidirectional", "crowd/circle-crossing",
    "bottleneck/door", "circle/antipodal", "office/rooms",
)  # fmt: skip
FOR_SEEDS = SCENARIOS[:-1]  # office/rooms takes as long as all others together
MEMORY = " It also perceives movers that it sensed in the last two seconds and no longer senses."
CHUNK = 50  # worlds of a task
KINDS = (Kind.AGENT, Kind.WALL, Kind.STATIC, Kind.DYNAMIC)
KNOWLEDGE = Path("docs/learning/full_knowledge.json")
CURVES = Path("docs/learning/curves")
ALONE: Mapping[str, dict[str, Any]] = {
    "recurrent-ppo": {},
    "recurrent-ppo-plus": {"foresight": False, "patience": 0},
}
"""Navigator → the parameters with which its policy drives alone."""
COMPANIONS: Mapping[str, tuple[Spec, str]] = {
    "recurrent-ppo": (
        "recurrent-ppo-vo",
        "With velocity obstacles of what its rays hit, and detours (`recurrent-ppo-vo`):",
    ),
    "recurrent-ppo-plus": (
        {"type": "recurrent-ppo-plus", **ALONE["recurrent-ppo-plus"]},
        "The policy alone, which nothing corrects (`foresight: false, patience: 0`):",
    ),
}
"""Navigator → another one with its weights, and its description."""


@dataclass(frozen=True)
class Row:
    """One scenario, over all evaluated agents."""

    scenario: str
    worlds: int
    agents: int
    success: float
    low: float
    high: float
    timeout: float
    hits: dict[str, float]  # share of agents whose first contact was with that kind
    turning: float  # [rad/m]


def measure(navigator: Spec, scenario: str, agents: int) -> Row:
    """Run ``navigator`` for ``agents`` or more in the first test worlds, without a map."""
    each = int(build(find(scenario), "test", 0).agents.evaluated.sum())
    worlds = -(-agents // each)
    tasks = [
        (navigator, scenario, first, min(first + CHUNK, worlds))
        for first in range(0, worlds, CHUNK)
    ]
    with ProcessPoolExecutor(os.cpu_count()) as pool:
        parts = [part for task in pool.map(_run, tasks) for part in task]
    rates = np.array([[part[0].mean()] for part in parts])
    sizes = np.array([[float(len(part[0]))] for part in parts])
    every = [np.concatenate(column) for column in zip(*(part[:3] for part in parts), strict=True)]
    rate = np.array([every[0].mean()])
    low, high = mid_p(rate, effective_size(rates, sizes))
    first = [kind for part in parts for kind in part[3]]
    return Row(
        scenario, len(parts), len(every[0]), float(rate[0]), float(low[0]), float(high[0]),
        float(every[1].mean()),
        {kind.name.lower(): first.count(int(kind)) / len(every[0]) for kind in KINDS},
        float(np.nanmean(every[2])),
    )  # fmt: skip


def _run(task: tuple[Spec, str, int, int]) -> list[tuple[FloatArray, FloatArray, FloatArray, list]]:
    navigator, name, first, stop = task
    scenario = find(name)
    background = scenario.driver_specs
    about = Assignment(
        scenario.identity, scenario.hash, "test", "unknown", "measured", navigator, background,
        salt="00",
    )  # fmt: skip
    worlds = [(seed, build(scenario, "test", seed)) for seed in range(first, stop)]
    return [_measured(episode) for batch in rollout(about, worlds) for episode in batch]


def _measured(episode: Episode) -> tuple[FloatArray, FloatArray, FloatArray, list[int]]:
    if episode.failure:
        raise RuntimeError(episode.failure)
    mine = episode.world.agents.evaluated
    arrived = success(episode)
    return (
        arrived[mine], timeout(episode)[mine], turning(episode)[mine],
        list(_first_hits(episode, mine & (arrived == 0.0))),
    )  # fmt: skip


def _first_hits(episode: Episode, agents: Any) -> Iterator[int]:
    contacts = episode.contacts
    for agent in np.flatnonzero(agents):
        rows = np.flatnonzero((contacts.agent == agent) & contacts.charged)
        if len(rows):
            yield int(contacts.kind[rows[0]])


def card(navigator: str, rows: list[Row], other: list[Row], seeds: dict[int, list[Row]]) -> str:
    """The card as Markdown: of the navigator, of its companion, and of other seeds' trainings."""
    about = make(NAVIGATORS, navigator).pilot.about
    progress = about["progress"]
    known = {k["scenario"]: k for k in json.loads(KNOWLEDGE.read_text())}
    lines = [
        f"# {navigator}",
        "",
        f"Encoder `{about['encoder']}`, network {json.dumps(about['network'])}."
        + (MEMORY if about["hidden_movers"] else ""),
        f"Learned from {progress['decisions']:,} decisions in {progress['seconds']:,.0f} s, seed"
        f" {progress['seed']}, recipe `{about['recipe']}` ({about['recipe_hash']}), on"
        f" {about['machine']}, one thread. The log of the training stands in"
        f" docs/learning/curves/{about['recipe']}-{progress['seed']}.csv.",
        "Worlds of the split `train`: "
        + ", ".join(f"{c['worlds']} of {c['scenario']}" for c in about["courses"])
        + ".",
        "",
        "Strict success (goal touched, nothing else before) per agent, deterministic, no map,"
        " test worlds 0, 1, …; 95 % interval clustered by world. *Full knowledge* is a space-time"
        " planner that knows the map and the laws of the movers (the first 500 worlds).",
        "",
        "| scenario | agents | success % | full knowledge % | hit by agent, wall, static, mover % |"
        " timeout % | turning rad/m |",
        "|---|---|---|---|---|---|---|",
    ]
    lines += [_line(row, known.get(row.scenario)) for row in rows]
    lines += ["", *_companion(COMPANIONS[navigator][1], other)]
    if seeds:
        alone = other if ALONE[navigator] else rows
        lines += ["", *_seeds({progress["seed"]: alone, **seeds})]
    lines += ["", *_stages(about["recipe"], progress["seed"])]
    return "\n".join([*lines, ""])


def _companion(title: str, rows: list[Row]) -> Iterator[str]:
    yield title
    yield ""
    yield "| scenario | agents | success % | hit by agent, wall, static, mover % | timeout % |"
    yield "|---|---|---|---|---|"
    for row in rows:
        yield (
            f"| {row.scenario} | {row.agents:,} | {_rate(row)} | {_hits(row)} |"
            f" {100 * row.timeout:.2f} |"
        )


def _seeds(seeds: dict[int, list[Row]]) -> Iterator[str]:
    """Success of the policy of each seed of the training."""
    yield "Success % of the policy alone, by the seed of the training:"
    yield ""
    yield "| scenario | " + " | ".join(f"seed {seed}" for seed in sorted(seeds)) + " |"
    yield "|---|" + "---|" * len(seeds)
    found = {seed: {row.scenario: _rate(row) for row in rows} for seed, rows in seeds.items()}
    for scenario in dict.fromkeys(chain(*found.values())):
        rates = " | ".join(found[seed].get(scenario, "–") for seed in sorted(found))
        yield f"| {scenario} | {rates} |"


def _rate(row: Row) -> str:
    return f"{100 * row.success:.2f} [{100 * row.low:.2f}, {100 * row.high:.2f}]"


def _hits(row: Row) -> str:
    return ", ".join(f"{100 * row.hits[kind.name.lower()]:.2f}" for kind in KINDS)


def _line(row: Row, known: dict[str, Any] | None) -> str:
    full = "" if known is None else f"{100 * known['success']:.2f}"
    rate, _, interval = _rate(row).partition(" ")
    return (
        f"| {row.scenario} | {row.agents:,} | **{rate}** {interval} | {full} | {_hits(row)} |"
        f" {100 * row.timeout:.2f} | {row.turning:.2f} |"
    )


def _stages(recipe: str, seed: int) -> Iterator[str]:
    """Yield the gain of each stage on the validation split."""
    from benchnav_baselines.learned.recurrent_ppo.learning.log import read_rows
    from benchnav_baselines.learned.recurrent_ppo.learning.recipe import Recipe
    from benchnav_baselines.learned.recurrent_ppo.learning.trainer import RecurrentPPOTrainer

    curve = read_rows(CURVES / f"{recipe}-{seed}.csv")
    path = RecurrentPPOTrainer.recipes / f"{recipe}.yaml"
    stages = Recipe(**yaml.safe_load(path.read_text("utf-8"))).stages
    names = [name for name in curve[0] if name.startswith("validation ")]
    corrected = [str(k) for k, stage in enumerate(stages, 1) if stage.foresight]
    only = f"corrected by foresight in stage {', '.join(corrected)} alone"
    how = only if corrected else "of the policy alone"
    yield f"Success on the validation split at the end of each stage, {how}:"
    yield ""
    yield "| stage | decisions | " + " | ".join(n.removeprefix("validation ") for n in names) + " |"
    yield "|---|---|" + "---|" * len(names)
    for stage in range(len(stages)):
        last = next((row for row in curve if row["stage"] > stage), curve[-1])
        cells = " | ".join(f"{100 * last[name]:.1f}" for name in names)
        yield f"| {stage + 1} | {last['decisions']:,.0f} | {cells} |"


def main() -> None:
    """Measure, print, and write the card."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("navigator", choices=COMPANIONS)
    parser.add_argument("--agents", type=int, default=10_000, help="at least so many a scenario")
    parser.add_argument("--scenario", action="append", help="instead of all; may be given again")
    parser.add_argument(
        "--seed", type=Path, action="append", default=[],
        help="weights that another seed gave; may be given again",
    )  # fmt: skip
    parser.add_argument("--out", type=Path, help="the card")
    options = parser.parse_args()

    def measured(names: Sequence[str], spec: Spec) -> list[Row]:
        rows = []
        for scenario in names:
            rows.append(measure(spec, scenario, options.agents))
            print(spec, rows[-1], flush=True)
        return rows

    scenarios = options.scenario or SCENARIOS
    alone = {"type": options.navigator, **ALONE[options.navigator]}
    specs = [{**alone, "weights": str(path)} for path in options.seed]
    seeds = {
        make(NAVIGATORS, spec).pilot.about["progress"]["seed"]: measured(
            options.scenario or FOR_SEEDS, spec
        )
        for spec in specs
    }
    if len(seeds) < len(specs):
        raise SystemExit(f"Each of the {len(specs)} weights must have another seed.")
    rows = measured(scenarios, options.navigator)
    companion = measured(scenarios, COMPANIONS[options.navigator][0])
    text = card(options.navigator, rows, companion, seeds)
    if options.out:
        options.out.write_text(text)
    else:
        print(text)


if __name__ == "__main__":
    main()
