"""A navigator that lives in a process of its own: the runner's end of the pipe."""

import json
import math
import sys
from abc import abstractmethod
from collections.abc import Mapping, Sequence
from functools import cached_property
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from benchnav.arrays import FloatArray, IntArray
from benchnav.errors import BenchnavError, MissingExtraError, NavigatorError, named
from benchnav.isolation.briefing_codec import told
from benchnav.isolation.navigator_process import Process
from benchnav.isolation.observation_codec import seen
from benchnav.navigation.briefing import Briefing
from benchnav.navigation.command_check import CallFailed
from benchnav.navigation.map import Map
from benchnav.navigation.navigator import Navigator, Need, Training
from benchnav.navigation.observation import Observation
from benchnav.navigation.plugin.capabilities import Introduction
from benchnav.navigation.plugin.configure import Spec
from benchnav.navigation.plugin.trace import bounded, plain

PROTOCOL = 1  # version of the messages
STARTING = 120.0  # [s] that a process may take to say who it is
_ANSWERS = {"hello": "ready", "reset": "done", "act": "command", "remarks": "remarks"}
_NO_MAP_YET: Any = object()


class Remote(Navigator):
    """Sends what a navigator is told and sees, and hands on what it answers.

    Its process is started when something of it must be known, and ends with it.
    """

    def __init__(self, config: Any = None) -> None:
        super().__init__(config)
        self._maps: dict[int, Map | None] = {}  # by row, as its process knows it

    @abstractmethod
    def start(self) -> Process:
        """Its process."""

    @property
    @abstractmethod
    def hello(self) -> Mapping[str, Any]:
        """What its process is told first."""

    @property
    def patience(self) -> float:
        """[s] that a call may take; whoever runs it may stop it before."""
        return math.inf

    @cached_property
    def process(self) -> Process:
        """What answers."""
        return self.start()

    @cached_property
    def said(self) -> Introduction:
        """What it says of itself. Raises NavigatorError where it cannot be started."""
        said = say_hello(self.process, self.hello)
        vars(self)["command"] = said.command  # declared for the class, known here
        return said

    @property
    def required(self) -> frozenset[Need]:
        return self.said.needs

    @property
    def uses_map(self) -> bool:
        return self.said.uses_map

    @property
    def reproducible(self) -> bool:
        return self.said.reproducible

    @property
    def training(self) -> Training | None:
        return self.said.training

    @property
    def rehearsal(self) -> int:
        return self.said.rehearsal

    @property
    def leader(self) -> Spec | None:
        return self.said.leader

    def reset(self, briefings: Sequence[Briefing], rows: IntArray) -> None:
        self._ask("reset", told(briefings, rows))
        for row, briefing in zip(rows.tolist(), briefings, strict=True):
            self._maps[row] = briefing.map

    def act(self, observation: Observation) -> FloatArray:
        rows = observation.rows.tolist()
        changed = [
            b for b, map in enumerate(observation.maps)
            if self._maps.get(rows[b], _NO_MAP_YET) is not map
        ]  # fmt: skip
        fields = self._ask("act", seen(observation, changed))
        self._maps.update((rows[b], observation.maps[b]) for b in changed)
        command: FloatArray = fields["command"]
        return command

    def remarks(self, row: int) -> Sequence[str]:
        if not self.process.alive or not self.said.remarks:
            return ()
        return [str(text) for text in json.loads(self._ask("remarks", {"row": row})["says"])]

    def _ask(self, kind: str, fields: Mapping[str, Any]) -> dict[str, Any]:
        try:
            _ = self.said
            return ask(self.process, kind, fields, self.patience)
        except NavigatorError as error:
            raise CallFailed(f"{kind}: {error}") from None


def say_hello(process: Process, hello: Mapping[str, Any]) -> Introduction:
    """What the navigator in ``process`` says of itself.

    Raises NavigatorError where it dies or answers anything else, and what it refuses to be
    made for.
    """
    says = json.dumps({"protocol": PROTOCOL, **hello})
    answer = ask(process, "hello", {"says": says}, STARTING)["says"]
    try:
        return Introduction.model_validate_json(answer)
    except ValidationError as error:
        first = error.errors()[0]
        key = ".".join(map(str, first["loc"])) or "its answer"
        raise NavigatorError(
            f"its process must introduce itself by what docs/isolation.md lists: {key}:"
            f" {first['msg']}. Got {str(answer)[:200]!r} instead"
        ) from None


def ask(process: Process, kind: str, fields: Mapping[str, Any], patience: float) -> dict[str, Any]:
    """The fields of the answer to a message.

    Raises:
        NavigatorError: it dies, takes longer than ``patience`` [s], or answers garbage.
        CallFailed: it says that it failed.
        BenchnavError: it refuses to be made, or what it needs is not installed.
    """
    got, answer = process.ask(kind, fields, patience)
    if got == "failed" and isinstance(answer.get("reason"), str):
        reason, traceback = plain(answer["reason"]), bounded(answer.get("traceback", ""))
        if answer.get("error") and (kind == "hello" or answer["error"] == _LACKING):
            raise _noted(named(answer["error"], reason), traceback)
        if kind == "hello":
            raise _noted(NavigatorError(reason), traceback)
        raise CallFailed(reason, answer.get("suspects"), traceback)
    wanted = _ANSWERS[kind]
    field = {"ready": "says", "command": "command", "remarks": "says"}.get(wanted)
    if got != wanted or (field is not None and field not in answer):
        process.stop()
        told = f" without {field!r}" if got == wanted else ""
        raise NavigatorError(f"its process must answer {wanted!r}. Got {got!r}{told} instead")
    return answer


_LACKING = MissingExtraError.__name__


def _noted(error: BenchnavError, traceback: str) -> BenchnavError:
    """The error, with the traceback of the process that it comes from beneath its own."""
    if traceback:
        error.add_note(traceback)
    return error


def python_path() -> list[str]:
    """Where this process imports from, by paths that hold in any folder."""
    return [str(Path(entry).resolve()) for entry in sys.path]
