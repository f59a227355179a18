"""A suite, resolved: a lazy product of scenarios, conditions and navigators over seeds."""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from benchnav.config.document import Document
from benchnav.config.yaml_reader import read_yaml, read_yaml_text, validate
from benchnav.errors import (
    ScenarioError,
    UsageError,
    did_you_mean,
)
from benchnav.generation.build import sensing_of
from benchnav.navigation.plugin.background_navigators import check_drivers
from benchnav.navigation.plugin.configure import Spec
from benchnav.navigation.plugin.trainings import each_training, entry_of
from benchnav.runner.plan.contestant import Contestant, ContestantFactory, label_of, resolved
from benchnav.runner.plan.job import Job
from benchnav.runner.plan.labels import labelled
from benchnav.runner.plan.limits import patience
from benchnav.runner.plan.suite_file import SuiteFile, is_scenario, parse_seeds, suite_path
from benchnav.runner.rollouts.seeding import check_salt
from benchnav.scenario.catalogue import find
from benchnav.scenario.condition import EXACT, require_perception, require_track
from benchnav.scenario.scenario import Scenario
from benchnav.store.runs.scenario_files import sha256_of

FIRST_LOOK = "quick"  # the suite whose navigators, tracks and seeds a single scenario gets


@dataclass(frozen=True)
class Selection:
    """Replacements for parts of the suite; an empty value keeps the suite's own."""

    scenarios: tuple[str, ...] = ()
    tracks: tuple[str, ...] = ()
    navigators: tuple[Spec, ...] = ()  # labels of the suite's own, or specs, also as YAML text
    seeds: str = ""
    salt: str = ""  # in hexadecimal digits; empty: the run draws one
    isolate: bool = False  # whether each evaluated navigator runs in its own process
    perceptions: tuple[str, ...] = ()


@dataclass(frozen=True)
class Block:
    """A part of a suite's product."""

    scenarios: tuple[str, ...]  # identities
    tracks: tuple[str, ...]
    navigators: tuple[str, ...]  # labels, or entries that stand for all their trainings
    perceptions: tuple[str, ...] = (EXACT,)

    def fields(self) -> dict[str, Any]:
        """Return it as plain data for the manifest; a perception that is exact is left out."""
        return {
            "scenarios": self.scenarios, "tracks": self.tracks, "navigators": self.navigators,
            **_unless_exact(self.perceptions),
        }  # fmt: skip

    def __contains__(self, job: Job) -> bool:
        label = job.contestant.label
        return (
            job.scenario.identity in self.scenarios
            and job.track in self.tracks
            and job.perception in self.perceptions
            and not {label, entry_of(label)}.isdisjoint(self.navigators)
        )


@dataclass(frozen=True)
class Suite:
    """Scenarios, tracks, perceptions, navigators and seeds to run."""

    name: str
    version: int
    split: str
    seeds: range
    scenarios: tuple[Scenario, ...]
    tracks: tuple[str, ...]
    contestants: tuple[Contestant, ...]
    salt: str = ""  # of navigators' randomness; empty: each new run draws its own
    blocks: tuple[Block, ...] = ()  # the parts of the product to run; empty: all of it
    perceptions: tuple[str, ...] = (EXACT,)

    def jobs(self) -> Iterator[Job]:
        """Yield all cells, also n/a ones, by scenario, track, perception and navigator.

        A navigator that uses no map runs once for all tracks, in the last track of a scenario.
        """
        whole = [
            job
            for scenario in self.scenarios
            for track in self.tracks
            for perception in self.perceptions
            for contestant in self.contestants
            if (job := Job(scenario, self.split, track, contestant, perception=perception)) in self
        ]
        shared: dict[tuple[str, str, str], list[str]] = {}  # tracks with the same episodes
        for job in whole:
            if job.once:
                shared.setdefault(job.contest, []).append(job.track)
        for job in whole:
            tracks = shared[job.contest] if job.once else [job.track]
            if job.track == tracks[-1]:
                yield replace(job, also=tuple(tracks[:-1]))

    def __contains__(self, job: Job) -> bool:
        return not self.blocks or any(job in block for block in self.blocks)

    def resolved(self) -> dict[str, Any]:
        """Return all that affects results except the salt, as plain data for the manifest."""
        return {
            "name": self.name,
            "version": self.version,
            "split": self.split,
            "seeds": [self.seeds.start, self.seeds.stop],
            "scenarios": [
                {
                    "scenario": s.identity,
                    "hash": s.hash,
                    "config": s.model_dump(mode="json"),
                    "files": {name: sha256_of(path) for name, path in s.named_files().items()},
                }
                for s in self.scenarios
            ],
            "tracks": list(self.tracks),
            **_unless_exact(self.perceptions),
            "navigators": [resolved(contestant) for contestant in self.contestants],
            **({"blocks": [block.fields() for block in self.blocks]} if self.blocks else {}),
        }


def load_suite(
    suite: str | Document, selection: Selection = Selection(), *, timeout: float | None = None
) -> Suite:
    """Return the suite of this name, file or content, with the selection applied.

    The name or file of a scenario gives a suite of that scenario: its navigators, conditions and
    seeds are those of the suite `FIRST_LOOK` unless others are selected. Navigators report their
    properties in separate processes, in which a call may last ``timeout`` [s].

    Raises:
        UsageError: no such suite, track, perception, seeds or salt; a label or scenario twice.
        ScenarioError: the suite file or a scenario is wrong.
        PluginError: a navigator cannot be used.
    """
    if isinstance(suite, str):
        if is_scenario(suite):
            return _suite_of_one(suite, selection, timeout)
        path = suite_path(suite)
        document, folder = read_yaml(path), path.parent
    else:
        document, folder = suite, Path()
    return _selected(document, folder, selection, timeout)


def _selected(
    document: Document, folder: Path, selection: Selection, timeout: float | None
) -> Suite:
    """Return the suite that ``document`` describes; paths of scenarios start at ``folder``."""
    file = validate(SuiteFile, document)
    wanted = _wanted_navigators(file, selection.navigators)
    if selection.scenarios:
        scenarios = tuple(find(name) for name in selection.scenarios)
    else:
        scenarios = tuple(find(name, folder) for name in file.scenarios)
    check_drivers(*scenarios, timeout=patience(timeout))
    factory = ContestantFactory(
        tuple(dict.fromkeys(map(sensing_of, scenarios))), selection.isolate, patience(timeout)
    )
    places = ["navigators" if i is None else document.where(("navigators", i)) for i, _ in wanted]
    contestants = factory.create_all(
        [
            (training, where)
            for (_, spec), where in zip(wanted, places, strict=True)
            for training in each_training(spec, label_of(spec), where)
        ]
    )
    tracks = tuple(selection.tracks or file.tracks)
    perceptions = tuple(selection.perceptions or file.perception)
    for track in tracks:
        require_track(track)
    for perception in perceptions:
        require_perception(perception)
    for key, names, selected in (
        ("scenarios", [s.identity for s in scenarios], selection.scenarios),
        ("tracks", tracks, selection.tracks),
        ("perception", perceptions, selection.perceptions),
        ("navigators", [label_of(spec) for _, spec in wanted], selection.navigators),
    ):
        _refuse_twice(key, names, selected, document)
    seeds = _seeds(selection.seeds or str(file.seeds))
    salt = _salt(selection.salt)
    suite = Suite(
        file.name, file.version, file.split, seeds, scenarios, tracks, contestants, salt,
        perceptions=perceptions,
    )  # fmt: skip
    return replace(suite, blocks=_blocks(file, suite, document, folder)) if file.blocks else suite


def _suite_of_one(name: str, selection: Selection, timeout: float | None) -> Suite:
    """Return a suite of the scenario ``name`` and of the scenarios of the selection."""
    chosen = replace(selection, scenarios=(name, *selection.scenarios))
    suite = load_suite(FIRST_LOOK, chosen, timeout=timeout)
    scenario = suite.scenarios[0]
    called = re.sub(r"[^a-z0-9]+", "-", scenario.name.lower()).strip("-")[:60]
    return replace(suite, name=called or "scenario", version=scenario.version, blocks=())


def _blocks(file: SuiteFile, suite: Suite, document: Document, folder: Path) -> tuple[Block, ...]:
    """Return the blocks of the file; selected names that the file does not have join each one."""
    identities = {name: find(name, folder).identity for name in file.scenarios}
    labels = tuple(map(label_of, labelled(file.navigators)))
    added = (
        tuple(s.identity for s in suite.scenarios if s.identity not in identities.values()),
        tuple(track for track in suite.tracks if track not in file.tracks),
        tuple(
            contestant.label
            for contestant in suite.contestants
            if entry_of(contestant.label) not in labels
        ),
        tuple(each for each in suite.perceptions if each not in file.perception),
    )
    blocks = []
    for i, block in enumerate(file.blocks):
        at = f"{document.name}: blocks[{i}]"
        scenarios = _known(block.scenarios, file.scenarios, f"{at}.scenarios")
        tracks = _known(block.tracks, file.tracks, f"{at}.tracks")
        navigators = _known(block.navigators, labels, f"{at}.navigators")
        perceptions = _known(block.perception, file.perception, f"{at}.perception")
        blocks.append(
            Block(
                tuple(identities[name] for name in scenarios) + added[0],
                tracks + added[1],
                navigators + added[2],
                perceptions + added[3],
            )
        )
    return tuple(blocks)


def _known(chosen: tuple[str, ...] | None, own: tuple[str, ...], where: str) -> tuple[str, ...]:
    """Return the part of the suite that a block uses. Raises ScenarioError for unknown names."""
    for name in chosen or ():
        if name not in own:
            raise ScenarioError(
                f"{where} must be among the suite's own. Got {name!r} instead."
                f"{did_you_mean(name, own)}"
            )
    return own if chosen is None else chosen


def _wanted_navigators(file: SuiteFile, selected: Sequence[Spec]) -> list[tuple[int | None, Spec]]:
    """Return (index in the file or None, spec); labels select from the file, specs are added."""
    every = labelled(file.navigators)
    own = {label_of(spec): (i, spec) for i, spec in enumerate(every)}
    if not selected:
        return list(enumerate(every))
    chosen = [
        own.get(spec, (None, _parsed(spec))) if isinstance(spec, str) else (None, spec)
        for spec in selected
    ]
    specs = labelled([spec for _, spec in chosen])
    return [(place, spec) for (place, _), spec in zip(chosen, specs, strict=True)]


def _parsed(text: str) -> Spec:
    """Return the spec that ``text`` describes: a name, or ``{type: name, …}`` as in a file."""
    if not text.lstrip().startswith("{"):
        return text
    data: Spec = read_yaml_text(text, "navigators").data
    return data


def _seeds(text: str) -> range:
    try:
        return parse_seeds(text)
    except ValueError as error:
        raise UsageError(f"seeds {error}.") from None


def _salt(text: str) -> str:
    try:
        if text:
            check_salt(text.lower())
    except ValueError as error:
        raise UsageError(f"The salt {error}.") from None
    return text.lower()


def _unless_exact(perceptions: tuple[str, ...]) -> dict[str, Any]:
    """Return the key of a manifest; none for exact perception, so that older hashes hold."""
    return {} if perceptions == (EXACT,) else {"perception": list(perceptions)}


def _refuse_twice(
    key: str, names: Sequence[str], selected: Sequence[Spec], document: Document
) -> None:
    """Raise UsageError for a name that occurs twice, in the file or among selected options."""
    for k, name in enumerate(names):
        first = names.index(name)
        if first == k:
            continue
        if selected:
            same = selected[first] == selected[k]
            written = "" if same else f", as {selected[first]!r} and as {selected[k]!r}"
            raise UsageError(
                f"The {key} must be named once each. {name!r} is named more than"
                f" once{written}. Leave one of them out."
            )
        raise UsageError(
            f"{document.where((key, k))} must not repeat another of the {key}. It names {name!r}"
            f" more than once; the first is {key}[{first}]."
        )
