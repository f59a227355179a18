"""The navigators of a suite, with the properties that they report."""

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
    source: str  # distributions and versions of the navigator and its parts
    required: frozenset[Need]
    lacks: str = ""  # the missing extra that it needs; "" if none is missing
    training: Training | None = None
    fingerprint: str = ""  # of the files that it reads
    rehearsal: int = 0  # rehearsals before each episode
    leader: "Entry | None" = None  # the navigator of the leaders in rehearsals
    uses_map: bool = True
    unfit: Mapping[Sensing, str] = field(default_factory=dict)  # why it cannot use these sensors
    mode: Mode = IN_PROCESS
    places: tuple[str, ...] = ()  # module:attribute of its class, its parts and its leader
    source_hash: str = ""  # of the code at these places; "" if unknown
    edited: tuple[str, ...] = ()  # its modules that were edited after this process imported them

    @property
    def hash(self) -> str:
        """Return a hash of type, parameters, distributions with versions, files read, and mode.

        It does not depend on code: see `source_hash`.
        """
        led = self.leader.hash if self.leader else ""
        return navigator_hash(self.spec, self.source, self.fingerprint, led, self.mode)


@dataclass(frozen=True)
class Meeting:
    """Asks navigators for their properties, each in a separate process.

    Navigators that only this process knows are constructed in this process.
    """

    sensings: tuple[Sensing, ...]
    isolate: bool
    timeout: float = Limits.timeout  # [s] that a call of a navigator may last
    here: bool = False  # whether to construct all in this process, which will run them

    def entry(self, spec: Spec, where: str) -> Entry:
        """Return the entry that ``spec`` describes; ``where`` is its place, for messages."""
        return self.entries([(spec, where)])[0]

    def entries(self, wanted: Sequence[tuple[Spec, str]]) -> tuple[Entry, ...]:
        """Return the entries of (spec, place for messages) pairs; navigators run in parallel."""
        specs = [(_without_label(spec, where), where) for spec, where in wanted]
        met = self._introductions(specs)
        return tuple(
            self._entry(label_of(spec), met[k], where) for k, (spec, where) in enumerate(wanted)
        )

    def _introductions(self, specs: Sequence[tuple[Spec, str]]) -> dict[int, Introduction]:
        """Return the properties by index. Raises for the first navigator that cannot be used."""
        found: dict[int, Introduction | BenchnavError] = {}
        away = []
        for k, (spec, where) in enumerate(specs):
            name, parameters = split(NAVIGATORS, spec, where=where)
            if self.isolate and name != PROCESS:
                found[k] = _isolated(spec, self.sensings, where)
            elif self.here or local_names({"type": name, **parameters}):
                found[k] = introduction(spec, self.sensings, where=where)
            else:
                away.append(k)
        answers = introductions([specs[k] for k in away], self.sensings, self.timeout)
        found.update(zip(away, answers, strict=True))
        met = {}
        for k in range(len(specs)):
            reported = found[k]
            if isinstance(reported, NavigatorError):  # raised by the program of a process
                raise _broken(*specs[k], reported)
            if isinstance(reported, BenchnavError):
                raise reported
            met[k] = reported
        return met

    def _entry(self, label: str, reported: Introduction, where: str) -> Entry:
        led = self._leader(reported, where)
        places = tuple(
            sorted({*places_of(reported.spec, reported.parts), *(led.places if led else ())})
        )
        program = reported.spec["type"] == PROCESS
        separate = self.isolate or (program and (led is None or led.mode == ISOLATED))
        entry = Entry(
            label, reported.spec, ", ".join(reported.made_of), reported.needs, reported.lacks,
            training=reported.training or (led.training if led else None),
            fingerprint=reported.fingerprint, rehearsal=reported.rehearsal, leader=led,
            unfit=dict(zip(self.sensings, reported.unfit, strict=False)),
            uses_map=reported.uses_map, mode=ISOLATED if separate else IN_PROCESS, places=places,
        )  # fmt: skip
        if entry.lacks:
            return entry
        source = source_of(entry)
        return replace(entry, source_hash=source.hash, edited=source.edited)

    def _leader(self, reported: Introduction, where: str) -> Entry | None:
        """Return the leaders' navigator in rehearsals; None if there are none."""
        if not reported.rehearsal:
            return None
        if reported.leader is None:
            raise ScenarioError(
                f"{where}: A navigator that asks for rehearsals must name the leaders' navigator."
            )
        led = self.entry(reported.leader, f"{where} leader")
        if led.rehearsal:
            raise ScenarioError(
                f"{where}: The leaders' navigator must not ask for rehearsals itself."
                f" Got {led.label!r}."
            )
        return led


def _without_label(spec: Spec, where: str) -> Spec:
    """Return ``spec`` without its label. Raises ScenarioError if the label is invalid."""
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
    """Return the current source of ``entry`` on this machine."""
    specs = [entry.spec, *([entry.leader.spec] if entry.leader else [])]
    return find_source(entry.places, specs)


def label_of(spec: Spec) -> str:
    """Return the label of the navigator of ``spec`` in tables."""
    if isinstance(spec, str):
        return spec
    return str(spec.get("label", spec.get("type", "")))


def sources_of(entries: Iterable[Entry]) -> dict[str, dict[str, Any]]:
    """Return the source of each navigator whose source is known, by label, for the manifest."""
    return {
        entry.label: {"hash": entry.source_hash, "places": list(entry.places)}
        for entry in entries
        if entry.source_hash
    }


def resolved(entry: Entry) -> dict[str, Any]:
    """Return all properties of an entry, for the manifest."""
    fields: dict[str, Any] = {
        "label": entry.label, "says": dict(entry.spec), "source": entry.source,
    }  # fmt: skip
    if entry.mode != IN_PROCESS:
        fields["mode"] = entry.mode
    if entry.leader:
        fields["rehearsal"], fields["leader"] = entry.rehearsal, resolved(entry.leader)
    if entry.training:
        fields["training"] = asdict(entry.training)
    if not entry.uses_map:
        fields["uses_map"] = False
    if entry.fingerprint:
        fields["fingerprint"] = entry.fingerprint
    return fields
