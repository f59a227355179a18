"""The navigators of a suite, with the properties that they report."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from typing import Any

from benchnav.arena.sensing import Sensing
from benchnav.errors import BenchnavError, BrokenPluginError, NavigatorError, ScenarioError
from benchnav.isolation import isolated
from benchnav.isolation.subprocess_host import PROCESS
from benchnav.navigation.navigator import ALL_DYNAMICS, DynamicsName, Need, Training
from benchnav.navigation.plugin.capabilities import Capabilities, read_capabilities
from benchnav.navigation.plugin.configure import Spec, split
from benchnav.navigation.plugin.guarded_capabilities import read_guarded_capabilities
from benchnav.plugins import NAVIGATORS
from benchnav.runner.plan.limits import Limits
from benchnav.source.digest import FoundSource, find_source
from benchnav.source.parts import local_names, places_of
from benchnav.store.runs.manifest import IN_PROCESS, ISOLATED, UNDISTURBED, Mode
from benchnav.store.runs.navigator_hash import navigator_hash


@dataclass(frozen=True)
class Contestant:
    """A navigator of a suite, with its parameters, and the properties that it reports."""

    label: str
    spec: Mapping[str, Any]  # {type: name, …every parameter}
    source: str  # distributions and versions of the navigator and its parts
    required: frozenset[Need]
    missing_extra: str = ""  # the missing extra that it needs; "" if none is missing
    training: Training | None = None
    fingerprint: str = ""  # of the files that it reads
    rehearsal: int = 0  # rehearsals before each episode
    leader: "Contestant | None" = None  # the navigator of the leaders in rehearsals
    uses_map: bool = True
    drives: frozenset[DynamicsName] = ALL_DYNAMICS  # the dynamics of the bodies that it can drive
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


NONE = Contestant(UNDISTURBED, {}, "", frozenset())
"""Stands for a navigator in the cells of undisturbed worlds, which have no evaluated agents."""


@dataclass(frozen=True)
class ContestantFactory:
    """Creates contestants from specs. Reads the properties of each navigator in a separate process.

    Navigators that only this process knows are constructed in this process.
    """

    sensings: tuple[Sensing, ...]
    isolate: bool
    timeout: float = Limits.timeout  # [s] that a call of a navigator may last
    here: bool = False  # whether to construct all in this process, which will run them

    def create(self, spec: Spec, where: str) -> Contestant:
        """Return the contestant that ``spec`` describes; ``where`` is its place, for messages."""
        return self.create_all([(spec, where)])[0]

    def create_all(self, wanted: Sequence[tuple[Spec, str]]) -> tuple[Contestant, ...]:
        """Return the contestants of (spec, place for messages) pairs, read in parallel."""
        for spec, where in wanted:
            _refuse_reserved(label_of(spec), where)
        specs = [(_without_label(spec, where), where) for spec, where in wanted]
        capabilities = self._read_capabilities(specs)
        return tuple(
            self._contestant(label_of(spec), capabilities[k], where)
            for k, (spec, where) in enumerate(wanted)
        )

    def _read_capabilities(self, specs: Sequence[tuple[Spec, str]]) -> dict[int, Capabilities]:
        """Return the properties by index. Raises for the first navigator that cannot be used."""
        found: dict[int, Capabilities | BenchnavError] = {}
        separate = []
        for k, (spec, where) in enumerate(specs):
            name, parameters = split(NAVIGATORS, spec, where=where)
            if self.isolate and name != PROCESS:
                found[k] = _isolated(spec, self.sensings, where)
            elif self.here or local_names({"type": name, **parameters}):
                found[k] = read_capabilities(spec, self.sensings, where=where)
            else:
                separate.append(k)
        answers = read_guarded_capabilities(
            [specs[k] for k in separate], self.sensings, self.timeout
        )
        found.update(zip(separate, answers, strict=True))
        capabilities = {}
        for k in range(len(specs)):
            reported = found[k]
            if isinstance(reported, NavigatorError):  # raised by the program of a process
                raise _broken(*specs[k], reported)
            if isinstance(reported, BenchnavError):
                raise reported
            capabilities[k] = reported
        return capabilities

    def _contestant(self, label: str, reported: Capabilities, where: str) -> Contestant:
        led = self._leader(reported, where)
        places = tuple(
            sorted({*places_of(reported.spec, reported.parts), *(led.places if led else ())})
        )
        program = reported.spec["type"] == PROCESS
        separate = self.isolate or (program and (led is None or led.mode == ISOLATED))
        contestant = Contestant(
            label, reported.spec, ", ".join(reported.made_of), reported.needs,
            missing_extra=reported.missing_extra,
            training=reported.training or (led.training if led else None),
            fingerprint=reported.fingerprint, rehearsal=reported.rehearsal, leader=led,
            unfit=dict(zip(self.sensings, reported.unfit, strict=False)),
            drives=reported.drives, uses_map=reported.uses_map,
            mode=ISOLATED if separate else IN_PROCESS, places=places,
        )  # fmt: skip
        if contestant.missing_extra:
            return contestant
        source = source_of(contestant)
        return replace(contestant, source_hash=source.hash, edited=source.edited)

    def _leader(self, reported: Capabilities, where: str) -> Contestant | None:
        """Return the leaders' navigator in rehearsals; None if there are none."""
        if not reported.rehearsal:
            return None
        if reported.leader is None:
            raise ScenarioError(
                f"{where}: A navigator that asks for rehearsals must name the leaders' navigator."
            )
        led = self.create(reported.leader, f"{where} leader")
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


def _refuse_reserved(label: str, where: str) -> None:
    if label == UNDISTURBED:
        raise ScenarioError(
            f"{where}: The label {label!r} is reserved for worlds without evaluated agents."
            " Give the navigator another label."
        )


def _isolated(spec: Spec, sensings: Sequence[Sensing], where: str) -> Capabilities:
    try:
        return isolated.read_capabilities(spec, sensings, where=where)
    except NavigatorError as error:
        raise _broken(spec, where, error) from None


def _broken(spec: Spec, where: str, error: NavigatorError) -> BrokenPluginError:
    return BrokenPluginError(f"{where}: The navigator {label_of(spec)!r} cannot be used: {error}.")


def source_of(contestant: Contestant) -> FoundSource:
    """Return the current source of ``contestant`` on this machine."""
    specs = [contestant.spec, *([contestant.leader.spec] if contestant.leader else [])]
    return find_source(contestant.places, specs)


def label_of(spec: Spec) -> str:
    """Return the label of the navigator of ``spec`` in tables."""
    if isinstance(spec, str):
        return spec
    return str(spec.get("label", spec.get("type", "")))


def sources_of(contestants: Iterable[Contestant]) -> dict[str, dict[str, Any]]:
    """Return the source of each navigator whose source is known, by label, for the manifest."""
    return {
        contestant.label: {"hash": contestant.source_hash, "places": list(contestant.places)}
        for contestant in contestants
        if contestant.source_hash
    }


def resolved(contestant: Contestant) -> dict[str, Any]:
    """Return all properties of a contestant, for the manifest."""
    fields: dict[str, Any] = {
        "label": contestant.label, "config": dict(contestant.spec), "source": contestant.source,
    }  # fmt: skip
    if contestant.mode != IN_PROCESS:
        fields["mode"] = contestant.mode
    if contestant.leader:
        fields["rehearsal"], fields["leader"] = contestant.rehearsal, resolved(contestant.leader)
    if contestant.training:
        fields["training"] = asdict(contestant.training)
    if not contestant.uses_map:
        fields["uses_map"] = False
    if contestant.fingerprint:
        fields["fingerprint"] = contestant.fingerprint
    return fields
