"""Hosts a navigator that is written in Python: ``python -m benchnav.isolation.host [NAME]``.

The runner starts it for ``--isolate``, and tells it whom to host. With a NAME it is the
program of a ``{type: process}`` navigator, and may live in an environment of its own.
"""

import json
import os
import sys
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from pydantic import TypeAdapter

from benchnav.arena.sensing import Sensing
from benchnav.errors import BenchnavError, MissingExtraError
from benchnav.isolation.briefing_codec import briefings_of
from benchnav.isolation.frame import HEAD, decode, encode, head
from benchnav.isolation.observation_codec import maps_changed, observation_of
from benchnav.named_module import search_in
from benchnav.navigation.command_check import CallFailed, checked, remarks_of, said
from benchnav.navigation.map import Map
from benchnav.navigation.navigator import Navigator
from benchnav.navigation.plugin.capabilities import meet
from benchnav.navigation.plugin.trace import plain, trace

Answer = tuple[str, dict[str, Any]]
_SENSINGS = TypeAdapter(list[Sensing])


@dataclass
class Host:
    """Answers frames for one navigator."""

    name: str = ""  # whom it hosts, where no message says it
    navigator: Navigator | None = None
    maps: dict[int, Map | None] = field(default_factory=dict)  # by row, as granted now

    def answer(self, kind: str, fields: dict[str, Any]) -> Answer:
        """The answer to a frame."""
        calls: dict[str, Callable[[dict[str, Any]], Answer]] = {
            "hello": self._hello, "reset": self._reset, "act": self._act, "remarks": self._remarks,
        }  # fmt: skip
        try:
            return calls[kind](fields)
        except CallFailed as failed:
            suspects = {} if failed.suspects is None else {"suspects": failed.suspects}
            return "failed", {"reason": failed.reason, "traceback": failed.traceback, **suspects}
        except MissingExtraError as error:
            return "failed", {"error": type(error).__name__, "reason": plain(error)}
        except (Exception, SystemExit) as error:
            refused = kind == "hello" and isinstance(error, BenchnavError)
            known = {"error": type(error).__name__} if refused else {}
            return "failed", {
                "reason": plain(error) if refused else f"{kind} raised {said(error)}",
                "traceback": trace(error),
                **known,
            }

    def _hello(self, fields: dict[str, Any]) -> Answer:
        says = json.loads(fields["says"])
        sys.path += [entry for entry in says.get("path", ()) if entry not in sys.path]
        search_in(says.get("folder", ""))
        spec = says.get("navigator") or {"type": self.name, **says["config"]}
        sensings = _SENSINGS.validate_python(says.get("sensings", []))
        self.maps = {}
        self.navigator, introduction = meet(spec, sensings, where=says.get("where", ""))
        if introduction.lacks and not says.get("sensings"):
            return "failed", {"error": MissingExtraError.__name__, "reason": introduction.lacks}
        return "ready", {"says": introduction.model_dump_json(exclude_defaults=True)}

    def _reset(self, fields: dict[str, Any]) -> Answer:
        briefings = briefings_of(fields)
        rows = fields["rows"]
        self.maps.update(zip(rows.tolist(), (b.map for b in briefings), strict=True))
        self._hosted.reset(briefings, rows)
        return "done", {}

    def _act(self, fields: dict[str, Any]) -> Answer:
        self.maps.update(maps_changed(fields))
        active = fields["active"].copy()
        answer = self._hosted.act(observation_of(fields, self.maps))
        return "command", {"command": checked(answer, active)}

    def _remarks(self, fields: dict[str, Any]) -> Answer:
        told = remarks_of(self._hosted.remarks(int(fields["row"])))
        return "remarks", {"says": json.dumps(told)}

    @property
    def _hosted(self) -> Navigator:
        if self.navigator is None:
            raise RuntimeError("nobody said hello")
        return self.navigator


def serve(host: Host, requests: int, answers: int) -> None:
    """Answer what comes from the file ``requests`` until it ends, into the file ``answers``."""
    while (start := _read(requests, HEAD.size)) is not None:
        kind, count, size = head(start)
        body = _read(requests, size)
        if body is None:
            return
        unsent = memoryview(encode(*host.answer(kind, decode(count, body))))
        while unsent:
            unsent = unsent[os.write(answers, unsent) :]


def _read(file: int, size: int) -> bytearray | None:
    """``size`` bytes; None where the file ends before."""
    data = bytearray(size)
    rest = memoryview(data)
    while rest:
        count = os.readv(file, [rest])
        if not count:
            return None
        rest = rest[count:]
    return data


def main() -> None:
    """Serve the pipes that are standard input and output; what is printed goes to stderr."""
    requests, answers = os.dup(0), os.dup(1)
    nothing = os.open(os.devnull, os.O_RDONLY)
    os.dup2(nothing, 0)
    os.close(nothing)
    os.dup2(2, 1)
    serve(Host("".join(sys.argv[1:2])), requests, answers)


if __name__ == "__main__":
    main()
