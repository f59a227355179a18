"""The page of the suite `generalisation`: ``python -m studies.generalisation RUN``.

Trains one policy for each family of scenarios and training seed with a recipe of its own
(``generalisation-FAMILY``: the same network, reward and budget, other courses), executes the suite
with these policies and those that ship into the folder RUN (what was stopped continues), and writes
docs/results/generalisation.md: success by what a policy was trained in and tested in.
``--decisions 0`` trains nothing.
"""

import argparse
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from textwrap import wrap
from typing import Any

import yaml

from benchnav.api.execution.train import train
from benchnav.envs.recipes import recipe_files
from benchnav.leaderboard.from_runs import stored_values
from benchnav.leaderboard.record import Record
from benchnav.navigation.plugin.configure import make
from benchnav.navigation.plugin.trainings import entries_of, labels_of_entry
from benchnav.plugins import NAVIGATORS
from benchnav.runner.execute.progress import progress
from benchnav.runner.plan.suite import Selection, load_suite
from benchnav.runner.run import run_suite
from benchnav.store.runs.run_folder import RunFolder
from studies.paper.markdown import table

SUITE = "generalisation"
SALT = "0123456789abcdef0123456789abcdef"  # public, so that the run can be repeated
PAGE = Path(__file__).parents[1] / "docs" / "results" / "generalisation.md"
FAMILIES: Mapping[str, Sequence[str]] = {
    "leaders": ("leaders/static", "leaders/dynamic"),
    "corridor": ("corridor/bidirectional",),
    "crowd": ("crowd/circle-crossing",),
    "bottleneck": ("bottleneck/door",),
    "circle": ("circle/antipodal",),
}
DECISIONS = 1_000_000  # of each training
NOTE = (
    "Intervals are 95 %, clustered by world, for these trainings; (n: a–b) after a value: the range"
    " of n trainings with different seeds. `orca` was not trained and is there for comparison."
)
SPECIALISTS = (
    " A policy `only FAMILY` was trained in one family with the recipe `generalisation-FAMILY`; the"
    " recipes differ in their courses."
)
WIDTH = 118  # characters of a line
TRAININGS = 3  # seeds of each family
RECIPES = {"q-learning": "q-leaders"}  # of navigators whose weights do not name their recipe


def recipe(family: str, decisions: int) -> dict[str, Any]:
    """Return the recipe of a family: it differs from the others in name and courses only."""
    courses = FAMILIES[family]
    return {
        "name": f"generalisation-{family}", "trainer": "recurrent-ppo", "encoder": "near",
        "description": f"A policy for the family {family} alone, to be tested in others.",
        "courses": [{"scenario": name, "worlds": 2000 // len(courses)} for name in courses],
        "rows": 64, "rollout": 64, "sequence": 16,
        "network": {"lstm_layers": 1, "lstm_size": 64},
        "stages": [
            {
                "decisions": decisions, "learning_rate": [8e-4, 1e-4], "batch": 1024, "epochs": 4,
                "reward": {
                    "approach": 1, "time": 1, "static": 50, "walls": 50, "agents": 50,
                    "dynamic": 70, "p_dynamic": 4,
                },
            }
        ],
        "checkpoint": max(decisions // 4, 1), "validation": {"worlds": 20},
    }  # fmt: skip


def trained(folder: Path, family: str, seed: int, decisions: int) -> Path:
    """Return the weights of one training; train it, or continue with it, if it is not complete."""
    out = folder / f"{family}-{seed}"
    path = folder / f"{family}.yaml"
    folder.mkdir(parents=True, exist_ok=True)
    path.write_text(yaml.safe_dump(recipe(family, decisions), sort_keys=False), encoding="utf-8")
    return train(str(path), seed=seed, out=out, resume=out.exists(), quiet=True).weights


def specialists(folder: Path, decisions: int, trainings: int) -> list[dict[str, Any]]:
    """Return a navigator for each family, with one training for each seed."""
    found = []
    for family in FAMILIES:
        files = [str(trained(folder, family, seed, decisions)) for seed in range(trainings)]
        weights = files if len(files) > 1 else files[0]
        label = _specialist(family)
        found.append({"type": "recurrent-ppo", "label": label, "weights": weights})
    return found


def _specialist(family: str) -> str:
    return f"only {family}"


def execute(folder: Path, extra: Sequence[dict[str, Any]], seeds: str) -> RunFolder:
    """Run the suite with the specialists, or continue with it."""
    own = entries_of(navigator.label for navigator in load_suite(SUITE).contestants)
    wanted = Selection(navigators=(*extra, *own), seeds=seeds, salt=SALT)
    run_suite(load_suite(SUITE, wanted), folder, progress=progress(quiet=False))
    return RunFolder.open(folder)


@dataclass(frozen=True, eq=False)
class Evidence:
    """The results of a run, and the families in which its navigators were trained."""

    run: RunFolder

    @cached_property
    def success(self) -> dict[tuple[str, str], Record]:
        """(Navigator, scenario) → its success."""
        board = stored_values([self.run], notify=print).board(["success"])
        return {(r.navigator, r.scenario): r for r in board.records if not r.price}

    @cached_property
    def scenarios(self) -> list[str]:
        """The scenarios, in the order of the suite."""
        return [str(entry["scenario"]) for entry in self.run.manifest.suite["scenarios"]]

    @cached_property
    def navigators(self) -> dict[str, tuple[str, ...]]:
        """Navigator → the families of its training, in the order of the suite."""
        configs = {e["label"]: e["config"] for e in self.run.manifest.suite["navigators"]}
        return {
            entry: _families(configs[labels_of_entry(entry, configs)[0]])
            for entry in entries_of(configs)
        }


def _families(config: Mapping[str, Any]) -> tuple[str, ...]:
    """Return the families in which the weights of a navigator were trained; none without."""
    about = getattr(getattr(make(NAVIGATORS, config), "pilot", None), "about", {})
    name = about.get("recipe", RECIPES.get(str(config["type"])))
    shipped = recipe_files()[0].get(str(name))
    known = about if shipped is None else yaml.safe_load(shipped.path.read_text("utf-8"))
    courses = [*known.get("courses", ())]
    courses += [course for stage in known.get("stages", ()) for course in stage.get("courses", ())]
    scenarios = [*known.get("scenarios", ()), *(course["scenario"] for course in courses)]
    return tuple(dict.fromkeys(scenario.partition("/")[0] for scenario in scenarios))


def page(evidence: Evidence) -> str:
    """Return the page, in Markdown."""
    manifest = evidence.run.manifest
    first, stop = manifest.suite["seeds"]
    heads = ["policy", "trained in", *(_bare(name) for name in evidence.scenarios), "own", "others"]
    has_own = any(_specialist(family) in evidence.navigators for family in FAMILIES)
    own = SPECIALISTS if has_own else ""
    text = (
        f"Success in per cent of policies that nothing corrects, in the test worlds {first} to"
        f" {stop - 1} of each scenario (track `unknown`), by the families in which they were"
        f" trained. **Bold**: trained in this family.{own} *Own* and *others* are means over"
        " scenarios. Written by"
        f" `python -m studies.generalisation` from a run of {manifest.suite['name']}"
        f"@{manifest.suite['version']}, begun {manifest.created[:10]}."
    )
    lines = [
        "# Generalisation",
        "",
        *wrap(text, WIDTH),
        "",
        *table(heads, [_row(evidence, name) for name in evidence.navigators]),
        *wrap(NOTE, WIDTH),
        "",
    ]
    return "\n".join(lines)


def _row(evidence: Evidence, name: str) -> Iterator[str]:
    families = evidence.navigators[name]
    yield f"`{name}`"
    yield ", ".join(families) or "–"
    own, others = list[float](), list[float]()
    for scenario in evidence.scenarios:
        record = evidence.success.get((name, scenario))
        if record is None or not record.episodes:
            yield "n/a"
            continue
        inside = scenario.partition("/")[0] in families
        (own if inside else others).append(record.value)
        yield _cell(record, inside)
    yield from (f"{100 * sum(v) / len(v):.0f}" if v else "–" for v in (own, others))


def _cell(r: Record, bold: bool) -> str:
    value, low, high = (f"{100 * x:.0f}" for x in (r.value, r.low, r.high))
    text = f"{value} [{low}, {high}]"
    if r.trainings > 1:
        text += f" ({r.trainings}: {100 * r.training_least:.0f}–{100 * r.training_most:.0f})"
    return f"**{text}**" if bold else text


def _bare(scenario: str) -> str:
    return scenario.partition("@")[0]


def main() -> None:
    """Train, run and write the page."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("run", type=Path)
    parser.add_argument(
        "--decisions", type=int, default=DECISIONS, help="of each training; 0: none"
    )
    parser.add_argument("--trainings", type=int, default=TRAININGS, help="seeds of each family")
    parser.add_argument("--seeds", default="", help="of the worlds, instead of the suite's")
    options = parser.parse_args()
    weights = options.run.with_name(f"{options.run.name}-trainings")
    extra = specialists(weights, options.decisions, options.trainings) if options.decisions else []
    run = execute(options.run, extra, options.seeds)
    PAGE.write_text(page(Evidence(run)), encoding="utf-8")
    print(PAGE)


if __name__ == "__main__":
    main()
