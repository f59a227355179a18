"""The navigators of a suite: who they are, as they say themselves."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from typing import Any

from benchnav.arena.sensing import Sensing
from benchnav.errors import BenchnavError, BrokenPluginError, NavigatorError, ScenarioError
from benchnav.isolation import isolated
from benchnav.isolation.subprocess_host import PROCESS
from benchnav.navigation.navigator import Need, Training
from benchnav.navigation.plugin.capabilities import Introduction, introduction
from benchnav.navigation.plugin.configure import Spec, split
from benchnav.navigation.plugin.guarded_capabilities import introductions
from benchnav.plugins import NAVIGATORS
from benchnav.runner.plan.limits import Limits
from benchnav.source.digest import FoundSource, find_source
from benchnav.source.parts import local_names, places_of
from benchnav.store.runs.manifest import IN_PROCESS, ISOLATED, Mode
from benchnav.store.runs.navigator_hash import navigator_hash


@dataclass(frozen=True)
class Entry:
    """A navigator of a suite."""

    label: str
    spec: Mapping[str, Any]  # {type: name, …every parameter}
    source: str  # distributions and versions that it and its parts come from
    required: frozenset[Need]
    lacks: str = ""  # what is not installed that it needs to be made; "" if it can be
    training: Training | None = None
    fingerprint: str = ""  # of the files that it reads
    rehearsal: int = 0  # rehearsals before each episode
    leader: "Entry | None" = None  # who drives the leaders in them
    uses_map: bool = True
    unfit: Mapping[Sensing, str] = field(default_factory=dict)  # why it cannot sense so; "" if so
    mode: Mode = IN_PROCESS
    places: tuple[str, ...] = ()  # module:attribute of its class and its parts', leader included
    source_hash: str = ""  # of what stands there; "" where not known
    edited: tuple[str, ...] = ()  # modules of it that this process imported before an edit

    @property
    def hash(self) -> str:
        """Of type, every parameter, distributions with versions, files that it read, and mode.

        Code counts in `source_hash`, which changes without a new version.
        """
        led = self.leader.hash if self.leader else ""
        return navigator_hash(self.spec, self.source, self.fingerprint, led, self.mode)


@dataclass(frozen=True)
class Meeting:
    """Asks navigators who they are, each in a process of its own.

    Those that this process alone knows are asked in it.
    """

    sensings: tuple[Sensing, ...]
    isolate: bool
    timeout: float = Limits.timeout  # [s] that a call of a navigator may last
    here: bool = False  # ask all in this process, which is about to run them

    def entry(self, spec: Spec, where: str) -> Entry:
        """The entry that ``spec`` describes, as it stands at ``where``."""
        return self.entries([(spec, where)])[0]

    def entries(self, wanted: Sequence[tuple[Spec, str]]) -> tuple[Entry, ...]:
        """The entries that specs describe, each with what it stands at; asked side by side."""
        asked = [(_without_label(spec, where), where) for spec, where in wanted]
        met = self._introductions(asked)
        return tuple(
            self._entry(label_of(spec), met[k], where) for k, (spec, where) in enumerate(wanted)
        )

    def _introductions(self, asked: Sequence[tuple[Spec, str]]) -> dict[int, Introduction]:
        """By place; raises for the first that cannot be used."""
        found: dict[int, Introduction | BenchnavError] = {}
        away = []
        for k, (spec, where) in enumerate(asked):
            name, parameters = split(NAVIGATORS, spec, where=where)
            if self.isolate and name != PROCESS:
                found[k] = _isolated(spec, self.sensings, where)
            elif self.here or local_names({"type": name, **parameters}):
                found[k] = introduction(spec, self.sensings, where=where)
            else:
                away.append(k)
        answers = introductions([asked[k] for k in away], self.sensings, self.timeout)
        found.update(zip(away, answers, strict=True))
        met = {}
        for k in range(len(asked)):
            said = found[k]
            if isinstance(said, NavigatorError):  # of the program of a process
                raise _broken(*asked[k], said)
            if isinstance(said, BenchnavError):
                raise said
            met[k] = said
        return met

    def _entry(self, label: str, said: Introduction, where: str) -> Entry:
        led = self._leader(said, where)
        places = tuple(sorted({*places_of(said.spec, said.parts), *(led.places if led else ())}))
        program = said.spec["type"] == PROCESS
        alone = self.isolate or (program and (led is None or led.mode == ISOLATED))
        entry = Entry(
            label, said.spec, ", ".join(said.made_of), said.needs, said.lacks,
            training=said.training or (led.training if led else None),
            fingerprint=said.fingerprint, rehearsal=said.rehearsal, leader=led,
            unfit=dict(zip(self.sensings, said.unfit, strict=False)),
            uses_map=said.uses_map, mode=ISOLATED if alone else IN_PROCESS, places=places,
        )  # fmt: skip
        if entry.lacks:
            return entry
        source = source_of(entry)
        return replace(entry, source_hash=source.hash, edited=source.edited)

    def _leader(self, said: Introduction, where: str) -> Entry | None:
        """Who leads in the rehearsals that a navigator asks for; None where it asks for none."""
        if not said.rehearsal:
            return None
        if said.leader is None:
            raise ScenarioError(f"{where}: who asks for rehearsals must name who leads in them.")
        led = self.entry(said.leader, f"{where} leader")
        if led.rehearsal:
            raise ScenarioError(
                f"{where}: who leads in rehearsals must need none itself. Got {led.label!r}."
            )
        return led


def _without_label(spec: Spec, where: str) -> Spec:
    """``spec`` as the navigator is made of it. Raises ScenarioError for a label that is none."""
    if isinstance(spec, str):
        return spec
    label = label_of(spec)
    if not label.strip() or len(label) > 80:
        raise ScenarioError(f"{where} label must have 1 to 80 characters; got {label[:90]!r}.")
    return {key: value for key, value in spec.items() if key != "label"}


def _isolated(spec: Spec, sensings: Sequence[Sensing], where: str) -> Introduction:
    try:
        return isolated.introduction(spec, sensings, where=where)
    except NavigatorError as error:
        raise _broken(spec, where, error) from None


def _broken(spec: Spec, where: str, error: NavigatorError) -> BrokenPluginError:
    return BrokenPluginError(f"{where}: The navigator {label_of(spec)!r} cannot be used: {error}.")


def source_of(entry: Entry) -> FoundSource:
    """Return the source that ``entry`` is made of here, now."""
    specs = [entry.spec, *([entry.leader.spec] if entry.leader else [])]
    return find_source(entry.places, specs)


def label_of(spec: Spec) -> str:
    """What tables call the navigator of ``spec``."""
    if isinstance(spec, str):
        return spec
    return str(spec.get("label", spec.get("type", "")))


def sources_of(entries: Iterable[Entry]) -> dict[str, dict[str, Any]]:
    """Return the source of each navigator that can be made here, by label, for the manifest."""
    return {
        entry.label: {"hash": entry.source_hash, "places": list(entry.places)}
        for entry in entries
        if entry.source_hash
    }


def resolved(entry: Entry) -> dict[str, Any]:
    """All that it stands for, for the manifest."""
    said: dict[str, Any] = {
        "label": entry.label, "says": dict(entry.spec), "source": entry.source,
    }  # fmt: skip
    if entry.mode != IN_PROCESS:
        said["mode"] = entry.mode
    if entry.leader:
        said["rehearsal"], said["leader"] = entry.rehearsal, resolved(entry.leader)
    if entry.training:
        said["training"] = asdict(entry.training)
    if not entry.uses_map:
        said["uses_map"] = False
    if entry.fingerprint:
        said["fingerprint"] = entry.fingerprint
    return said
