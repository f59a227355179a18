"""Host a navigator written in Python: ``python -m benchnav.isolation.host [NAME]``.

For ``--isolate``, the runner starts this module and sends the name of the navigator. With a NAME,
this module is the program of a ``{type: process}`` navigator, and may run in its own environment.
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
from benchnav.isolation.briefing_codec import decode_briefings
from benchnav.isolation.frame import encode
from benchnav.isolation.observation_codec import decode_changed_maps, decode_observation
from benchnav.isolation.request_reader import RequestReader
from benchnav.named_module import search_in
from benchnav.navigation.command_check import CallFailed, checked, exception_text, remarks_of
from benchnav.navigation.map import Map
from benchnav.navigation.navigator import Navigator
from benchnav.navigation.plugin.capabilities import inspect_navigator
from benchnav.navigation.plugin.trace import plain, trace

Answer = tuple[str, dict[str, Any]]
_SENSINGS = TypeAdapter(list[Sensing])


@dataclass
class Host:
    """Answer the frames sent to one navigator."""

    name: str = ""  # of the navigator, if the first message has none
    navigator: Navigator | None = None
    maps: dict[int, Map | None] = field(default_factory=dict)  # by row, as currently granted

    def answer(self, kind: str, fields: dict[str, Any]) -> Answer:
        """Return the answer to a frame."""
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
                "reason": plain(error) if refused else f"{kind} raised {exception_text(error)}",
                "traceback": trace(error),
                **known,
            }

    def _hello(self, fields: dict[str, Any]) -> Answer:
        config = json.loads(fields["text"])
        sys.path += [entry for entry in config.get("path", ()) if entry not in sys.path]
        search_in(config.get("folder", ""))
        spec = config.get("navigator") or {"type": self.name, **config["config"]}
        sensings = _SENSINGS.validate_python(config.get("sensings", []))
        self.maps = {}
        self.navigator, capabilities = inspect_navigator(
            spec, sensings, where=config.get("where", "")
        )
        if capabilities.missing_extra and not config.get("sensings"):
            return "failed", {
                "error": MissingExtraError.__name__,
                "reason": capabilities.missing_extra,
            }
        return "ready", {"text": capabilities.model_dump_json(exclude_defaults=True)}

    def _reset(self, fields: dict[str, Any]) -> Answer:
        briefings = decode_briefings(fields)
        rows = fields["rows"]
        self.maps.update(zip(rows.tolist(), (b.map for b in briefings), strict=True))
        self._hosted.reset(briefings, rows)
        return "done", {}

    def _act(self, fields: dict[str, Any]) -> Answer:
        self.maps.update(decode_changed_maps(fields))
        active = fields["active"].copy()
        answer = self._hosted.act(decode_observation(fields, self.maps))
        return "command", {"command": checked(answer, active)}

    def _remarks(self, fields: dict[str, Any]) -> Answer:
        texts = remarks_of(self._hosted.remarks(int(fields["row"])))
        return "remarks", {"text": json.dumps(texts)}

    @property
    def _hosted(self) -> Navigator:
        if self.navigator is None:
            raise RuntimeError("The first frame must be 'hello'.")
        return self.navigator


def serve(host: Host, requests: int, answers: int) -> None:
    """Answer the frames in the file ``requests`` until it ends; write to the file ``answers``."""
    reader = RequestReader(requests)
    while (request := reader.read()) is not None:
        kind, answer = host.answer(*request)
        if kind == "ready" and reader.agree(request[1]):
            answer["memory"] = True
        unsent = memoryview(encode(kind, answer))
        while unsent:
            unsent = unsent[os.write(answers, unsent) :]


def main() -> None:
    """Serve frames on standard input and output; printed text goes to stderr."""
    requests, answers = os.dup(0), os.dup(1)
    empty = os.open(os.devnull, os.O_RDONLY)
    os.dup2(empty, 0)
    os.close(empty)
    os.dup2(2, 1)
    serve(Host("".join(sys.argv[1:2])), requests, answers)


if __name__ == "__main__":
    main()
