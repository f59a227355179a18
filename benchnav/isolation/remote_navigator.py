"""A navigator in a separate process: the runner's end of the pipe."""

import json
import math
import sys
from abc import abstractmethod
from collections.abc import Mapping, Sequence
from functools import cached_property, lru_cache
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from benchnav.arrays import FloatArray, IntArray
from benchnav.config.model_errors import first_problem
from benchnav.errors import BenchnavError, MissingExtraError, NavigatorError, named
from benchnav.isolation.briefing_codec import encode_briefings
from benchnav.isolation.navigator_process import Process
from benchnav.isolation.observation_codec import encode_observation
from benchnav.navigation.briefing import Briefing
from benchnav.navigation.command_check import CallFailed
from benchnav.navigation.map import Map
from benchnav.navigation.navigator import CommandKind, DynamicsName, Navigator, Need, Training
from benchnav.navigation.observation import Observation
from benchnav.navigation.plugin.capabilities import Capabilities
from benchnav.navigation.plugin.configure import Spec
from benchnav.navigation.plugin.trace import bounded, plain

PROTOCOL = 2  # version of the messages
STARTING = 120.0  # [s] until a process must have answered `hello`
_ANSWERS = {"hello": "ready", "reset": "done", "act": "command", "remarks": "remarks"}
_NO_MAP_YET: Any = object()


class Remote(Navigator):
    """Sends briefings and observations to a process, and returns its answers.

    The process starts when one of its properties is first needed, and ends with this object.
    """

    def __init__(self, config: Any = None) -> None:
        super().__init__(config)
        self._maps: dict[int, Map | None] = {}  # by row, as the process knows them

    @abstractmethod
    def start(self) -> Process:
        """Start and return the process."""

    @property
    @abstractmethod
    def hello(self) -> Mapping[str, Any]:
        """Return the content of the first message to the process."""

    @property
    def patience(self) -> float:
        """The time limit of a call [s]; the runner may stop it earlier."""
        return math.inf

    @cached_property
    def process(self) -> Process:
        """The process."""
        return self.start()

    @cached_property
    def capabilities(self) -> Capabilities:
        """The properties that the process reports. Raises NavigatorError if it cannot start."""
        return handshake(self.process, self.hello)

    @property
    def required(self) -> frozenset[Need]:
        return self.capabilities.needs

    @property
    def command(self) -> CommandKind:
        return self.capabilities.command

    @property
    def drives(self) -> frozenset[DynamicsName]:
        return self.capabilities.drives

    @property
    def uses_map(self) -> bool:
        return self.capabilities.uses_map

    @property
    def reproducible(self) -> bool:
        return self.capabilities.reproducible

    @property
    def training(self) -> Training | None:
        return self.capabilities.training

    @property
    def rehearsal(self) -> int:
        return self.capabilities.rehearsal

    @property
    def leader(self) -> Spec | None:
        return self.capabilities.leader

    def reset(self, briefings: Sequence[Briefing], rows: IntArray) -> None:
        self._request("reset", encode_briefings(briefings, rows))
        for row, briefing in zip(rows.tolist(), briefings, strict=True):
            self._maps[row] = briefing.map

    def act(self, observation: Observation) -> FloatArray:
        rows = observation.rows.tolist()
        changed = [
            b for b, map in enumerate(observation.maps)
            if self._maps.get(rows[b], _NO_MAP_YET) is not map
        ]  # fmt: skip
        fields = self._request("act", encode_observation(observation, changed))
        self._maps.update((rows[b], observation.maps[b]) for b in changed)
        command: FloatArray = fields["command"]
        return command

    def remarks(self, row: int) -> Sequence[str]:
        if not self.process.alive or not self.capabilities.remarks:
            return ()
        return [str(text) for text in json.loads(self._request("remarks", {"row": row})["text"])]

    def _request(self, kind: str, fields: Mapping[str, Any]) -> dict[str, Any]:
        try:
            _ = self.capabilities
            return request(self.process, kind, fields, self.patience)
        except NavigatorError as error:
            raise CallFailed(f"{kind}: {error}") from None


def handshake(process: Process, hello: Mapping[str, Any]) -> Capabilities:
    """Return the properties that the navigator in ``process`` reports.

    Raises NavigatorError if it dies or answers anything else, and the error by which it refuses
    to be created.
    """
    message = json.dumps({"protocol": PROTOCOL, **hello})
    answer = request(process, "hello", {"text": message}, STARTING)["text"]
    try:
        return Capabilities.model_validate_json(answer)
    except ValidationError as error:
        problem = first_problem(error)
        raise NavigatorError(
            "its process must answer 'hello' with the fields in docs/isolation.md:"
            f" {problem.key or 'its answer'} {problem.requirement}."
            f" Got {str(answer)[:200]!r} instead"
        ) from None


def request(
    process: Process, kind: str, fields: Mapping[str, Any], patience: float
) -> dict[str, Any]:
    """Send a message, and return the fields of the answer.

    Raises:
        NavigatorError: the process dies, takes longer than ``patience`` [s], or answers garbage.
        CallFailed: the process reports a failure.
        BenchnavError: the navigator refuses to be created, or a dependency is not installed.
    """
    got, answer = process.request(kind, fields, patience)
    if got == "failed" and isinstance(answer.get("reason"), str):
        reason, traceback = plain(answer["reason"]), bounded(answer.get("traceback", ""))
        if answer.get("error") and (kind == "hello" or answer["error"] == _MISSING_EXTRA):
            raise _with_note(named(answer["error"], reason), traceback)
        if kind == "hello":
            raise _with_note(NavigatorError(reason), traceback)
        raise CallFailed(reason, answer.get("suspects"), traceback)
    wanted = _ANSWERS[kind]
    field = {"ready": "text", "command": "command", "remarks": "text"}.get(wanted)
    if got != wanted or (field is not None and field not in answer):
        process.stop()
        detail = f" without {field!r}" if got == wanted else ""
        raise NavigatorError(f"its process must answer {wanted!r}. Got {got!r}{detail} instead")
    return answer


_MISSING_EXTRA = MissingExtraError.__name__


def _with_note(error: BenchnavError, traceback: str) -> BenchnavError:
    """Return the error, with the traceback of the process as a note."""
    if traceback:
        error.add_note(traceback)
    return error


def python_path() -> list[str]:
    """Return the import path of this process, as absolute folders."""
    return list(_absolute_folders(tuple(sys.path), Path.cwd()))


@lru_cache(maxsize=1)
def _absolute_folders(entries: tuple[str, ...], _current: Path) -> list[str]:
    return [str(Path(entry).resolve()) for entry in entries]
