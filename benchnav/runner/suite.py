"""A suite, resolved: a lazy product of scenarios, tracks and navigators over seeds."""

import hashlib
import json
import re
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

from benchnav.errors import (
    ScenarioError,
    UsageError,
    did_you_mean,
)
from benchnav.navigation.configure import Spec
from benchnav.navigation.navigator import Need
from benchnav.navigation.tracks import TRACKS
from benchnav.runner.entry import Entry, Meeting, label_of, resolved
from benchnav.runner.generators import check_salt
from benchnav.runner.rollout import Assignment
from benchnav.runner.suite_file import SuiteFile, parse_seeds, suite_path
from benchnav.scenario.catalogue import find
from benchnav.scenario.sampler import support
from benchnav.scenario.scenario import Scenario
from benchnav.scenario.yaml_reader import read_yaml, read_yaml_text, validate
from benchnav.store.manifest import ISOLATED
from benchnav.store.scenario_files import sha256_of
from benchnav.world.build import sensing_of


@dataclass(frozen=True)
class Cell:
    """One scenario × track × navigator."""

    scenario: Scenario
    split: str
    track: str
    entry: Entry
    also: tuple[str, ...] = ()  # tracks for which it stands too: no map changes anything

    @property
    def assignment(self) -> Assignment:
        """Who runs where."""
        scenario, entry = self.scenario, self.entry
        return Assignment(
            scenario.identity, scenario.hash, self.split, self.track, entry.label, entry.spec,
            scenario.driver_specs,
            navigator_hash=entry.hash, rehearsals=entry.rehearsal,
            leader=entry.leader.spec if entry.leader else None,
            isolated=entry.mode == ISOLATED,
        )  # fmt: skip

    @property
    def once(self) -> bool:
        """True where the same episodes stand for every track that the scenario has."""
        return not self.entry.uses_map and self.track in self.scenario.granted_tracks

    @property
    def contest(self) -> tuple[str, str]:
        """The scenario, and the navigator's label."""
        return self.scenario.identity, self.entry.label

    @property
    def key(self) -> str:
        """Name of its folder: readable, and with a hash of all that makes it what it is."""
        a = self.assignment
        said = json.dumps(
            [a.scenario, a.scenario_hash, a.split, a.track, a.label, dict(self.entry.spec)]
        )
        parts = (_slug(a.scenario), a.track, _slug(a.label))
        return ".".join(parts) + "." + hashlib.sha256(said.encode()).hexdigest()[:10]

    @property
    def reason(self) -> str:
        """Why it is n/a; "" where it can be run."""
        if self.entry.lacks:
            return self.entry.lacks
        if self.track not in self.scenario.granted_tracks:
            return f"the scenario has no track {self.track!r}"
        led = self.entry.leader
        why = self._unfit(self.entry)
        if why or led is None:
            return why
        why = led.lacks or self._unfit(led)
        return f"its leaders' {led.label} {why}" if why else ""

    def _unfit(self, entry: Entry) -> str:
        """Why a navigator cannot work with what the track and the sensors give."""
        if Need.MAP in entry.required and self.track == "unknown":
            return "needs a map"
        return entry.unfit.get(sensing_of(self.scenario), "")

    @property
    def effort(self) -> float:
        """How long its episodes are likely to take, to begin the longest first."""
        agents = sum(support(team.count)[1] for team in self.scenario.teams)
        planning = 4.0 if Need.MAP in self.entry.required else 1.0
        effort = agents * self.scenario.clock.steps * planning
        if self.entry.leader is not None:
            led = replace(self, entry=self.entry.leader)
            effort += self.entry.rehearsal * led.effort * self._led / agents
        return effort

    @property
    def _led(self) -> float:
        """How many agents rehearse, at most: leaders, or one of a team without a leader."""
        counts: dict[str, list[float]] = {}
        for team in self.scenario.teams:
            most = support(team.count)[1]
            share = counts.setdefault(team.name, [0.0])
            share[0] += most if team.role == "leader" else 0.0
        return sum(max(share[0], 1.0) for share in counts.values())


@dataclass(frozen=True)
class Selection:
    """What the command line takes instead of the suite's own; empty means the suite's own."""

    scenarios: tuple[str, ...] = ()
    tracks: tuple[str, ...] = ()
    navigators: tuple[str, ...] = ()
    seeds: str = ""
    salt: str = ""  # in hexadecimal digits; empty: the run draws one
    isolate: bool = False  # every evaluated navigator in a process of its own


@dataclass(frozen=True)
class Block:
    """A part of a suite's product."""

    scenarios: tuple[str, ...]  # identities
    tracks: tuple[str, ...]
    navigators: tuple[str, ...]  # labels

    def __contains__(self, cell: Cell) -> bool:
        return (
            cell.scenario.identity in self.scenarios
            and cell.track in self.tracks
            and cell.entry.label in self.navigators
        )


@dataclass(frozen=True)
class Suite:
    """What to run."""

    name: str
    version: int
    split: str
    seeds: range
    scenarios: tuple[Scenario, ...]
    tracks: tuple[str, ...]
    entries: tuple[Entry, ...]
    salt: str = ""  # of navigators' randomness; empty: each new run draws its own
    blocks: tuple[Block, ...] = ()  # parts of the product that are run; none: all of it

    def cells(self) -> Iterator[Cell]:
        """Every cell, n/a ones included: by scenario, track, navigator.

        Who uses no map runs once, in the last of a scenario's tracks, for all of them.
        """
        whole = [
            cell
            for scenario in self.scenarios
            for track in self.tracks
            for entry in self.entries
            if (cell := Cell(scenario, self.split, track, entry)) in self
        ]
        stands: dict[tuple[str, str], list[str]] = {}
        for cell in whole:
            if cell.once:
                stands.setdefault(cell.contest, []).append(cell.track)
        for cell in whole:
            tracks = stands[cell.contest] if cell.once else [cell.track]
            if cell.track == tracks[-1]:
                yield replace(cell, also=tuple(tracks[:-1]))

    def __contains__(self, cell: Cell) -> bool:
        return not self.blocks or any(cell in block for block in self.blocks)

    def resolved(self) -> dict[str, Any]:
        """Everything but the salt that has a say in the results, as plain data for the manifest."""
        return {
            "name": self.name,
            "version": self.version,
            "split": self.split,
            "seeds": [self.seeds.start, self.seeds.stop],
            "scenarios": [
                {
                    "scenario": s.identity,
                    "hash": s.hash,
                    "says": s.model_dump(mode="json"),
                    "files": {name: sha256_of(path) for name, path in s.named_files().items()},
                }
                for s in self.scenarios
            ],
            "tracks": list(self.tracks),
            "navigators": [resolved(entry) for entry in self.entries],
            **({"blocks": [asdict(block) for block in self.blocks]} if self.blocks else {}),
        }


def load_suite(name: str, selection: Selection = Selection()) -> Suite:
    """The suite that ships as ``name`` or stands in that file, with what was selected.

    Raises:
        UsageError: no such suite, track, seeds or salt; a label or scenario twice.
        ScenarioError: the suite file or a scenario is wrong.
        PluginError: a navigator cannot be used.
    """
    path = suite_path(name)
    document = read_yaml(path)
    said = validate(SuiteFile, document)
    wanted = _wanted_navigators(said, selection.navigators)
    if selection.scenarios:
        scenarios = tuple(find(name) for name in selection.scenarios)
    else:
        scenarios = tuple(find(name, path.parent) for name in said.scenarios)
    meeting = Meeting(tuple(dict.fromkeys(map(sensing_of, scenarios))), selection.isolate)
    entries = tuple(
        meeting.entry(spec, "--navigator" if i is None else document.where(("navigators", i)))
        for i, spec in wanted
    )
    tracks = tuple(selection.tracks or said.tracks)
    _refuse_unknown_tracks(tracks)
    _refuse_twice("scenario", [s.identity for s in scenarios], path)
    _refuse_twice("track", tracks, path)
    _refuse_twice("navigator label", [e.label for e in entries], path)
    seeds = _seeds(selection.seeds or str(said.seeds))
    salt = _salt(selection.salt)
    suite = Suite(said.name, said.version, said.split, seeds, scenarios, tracks, entries, salt)
    return replace(suite, blocks=_blocks(said, suite, path)) if said.blocks else suite


def _blocks(said: SuiteFile, suite: Suite, path: Path) -> tuple[Block, ...]:
    """The file's blocks; what was selected and is not in the file belongs to each of them."""
    identities = {name: find(name, path.parent).identity for name in said.scenarios}
    labels = tuple(label_of(spec) for spec in said.navigators)
    added = (
        tuple(s.identity for s in suite.scenarios if s.identity not in identities.values()),
        tuple(track for track in suite.tracks if track not in said.tracks),
        tuple(entry.label for entry in suite.entries if entry.label not in labels),
    )
    blocks = []
    for i, block in enumerate(said.blocks):
        at = f"{path}: blocks[{i}]"
        scenarios = _known(block.scenarios, said.scenarios, f"{at}.scenarios")
        tracks = _known(block.tracks, said.tracks, f"{at}.tracks")
        navigators = _known(block.navigators, labels, f"{at}.navigators")
        blocks.append(
            Block(
                tuple(identities[name] for name in scenarios) + added[0],
                tracks + added[1],
                navigators + added[2],
            )
        )
    return tuple(blocks)


def _known(chosen: tuple[str, ...] | None, own: tuple[str, ...], where: str) -> tuple[str, ...]:
    """What a block takes of the suite's own. Raises ScenarioError where that has it not."""
    for name in chosen or ():
        if name not in own:
            raise ScenarioError(
                f"{where} must be among the suite's own. Got {name!r} instead."
                f"{did_you_mean(name, own)}"
            )
    return own if chosen is None else chosen


def _wanted_navigators(said: SuiteFile, selected: Sequence[str]) -> list[tuple[int | None, Spec]]:
    """(place in the file or None, spec): labels select from the file, other names are added."""
    own = {label_of(spec): (i, spec) for i, spec in enumerate(said.navigators)}
    if not selected:
        return [(i, spec) for i, spec in enumerate(said.navigators)]
    return [own.get(name, (None, _written(name))) for name in selected]


def _written(text: str) -> Spec:
    """A name, or ``{type: name, …}`` as it would stand in a file."""
    if not text.lstrip().startswith("{"):
        return text
    data: Spec = read_yaml_text(text, "--navigator").data
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


def _refuse_unknown_tracks(tracks: Sequence[str]) -> None:
    for track in tracks:
        if track not in TRACKS:
            raise UsageError(
                f"A track must be one of {', '.join(TRACKS)}. Got {track!r} instead."
                f"{did_you_mean(track, TRACKS)}"
            )


def _refuse_twice(what: str, names: Sequence[str], path: Path) -> None:
    for name in names:
        if names.count(name) > 1:
            raise UsageError(
                f"Every {what} of a suite must be there once. {path} has {name!r} more than once."
            )


def _slug(text: str) -> str:
    return re.sub(r"[^A-Za-z0-9@_-]+", "-", text)[:60]
