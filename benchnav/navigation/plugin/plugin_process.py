"""Query plugins in separate processes, which send plain data or the reason for a failure.

The code of a plugin may hang, end its process, raise any exception or report invalid
properties. Only the plugin fails then, never the calling process.
"""

import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from benchnav.errors import BenchnavError, BrokenPluginError, named
from benchnav.navigation.command_check import exception_text
from benchnav.navigation.plugin.trace import bounded, plain, trace
from benchnav.processes.channel import Channel, ChannelError
from benchnav.processes.inquiry import Fault, Inquiry, Limits, Step, inquire

TIMEOUT = 300.0  # [s] the default for a call of a plugin
_IMPORTING = 10.0  # [s] smallest limit for an import, because large libraries load slowly
_MEMORY = 4e9  # [bytes]
IMPORT, CONFIG, MEASURING = "import", "Config", "measuring"
_STEPS = (
    IMPORT, CONFIG, "__init__", "required", "command", "drives", "uses_map", "reproducible",
    "rehearsal", "leader", "training", "fingerprint", "parts", "unfit", "remarks", MEASURING,
)  # fmt: skip
StepCallback = Callable[[str], None]
"""Called with the step of `_STEPS` that begins."""
Answerer = Callable[[Any, StepCallback], Any]
"""(question, on_step) -> answer; question and answer are JSON data."""


@dataclass(frozen=True)
class Plugin:
    """The plugin of a question, for messages."""

    kind: str  # "navigator"
    name: str
    where: str = ""  # the place that names it: a line of a file
    question: Any = None

    def broken(self, cause: str) -> BrokenPluginError:
        """Return the error of a plugin that cannot be used."""
        at = f"{self.where}: " if self.where else ""
        return BrokenPluginError(f"{at}The {self.kind} {self.name!r} cannot be used: {cause}.")


def query_plugins(
    target: str, groups: Sequence[Sequence[Plugin]], timeout: float = TIMEOUT
) -> list[list[Any]]:
    """Return the answer of each plugin of each group, or a BenchnavError with the reason.

    Args:
        target: "module:function", which calls `serve`.
        groups: each gets one process, which continues after a plugin that raises.
        timeout: [s] that a call of a plugin may last.
    """
    steps = tuple(
        Step(name, max(timeout, _IMPORTING) if name in (IMPORT, CONFIG) else timeout)
        for name in _STEPS
    )
    inquiries = [Inquiry(target, [plugin.question for plugin in group]) for group in groups]
    answers = inquire(inquiries, Limits(steps, _MEMORY))
    return [
        [_understood(plugin, answer) for plugin, answer in zip(group, answered, strict=True)]
        for group, answered in zip(groups, answers, strict=True)
    ]


def _understood(plugin: Plugin, answer: Any) -> Any:
    """Return the validated answer, or the error of an invalid one."""
    if isinstance(answer, Fault):
        return plugin.broken(answer.text)
    if isinstance(answer, dict) and "answer" in answer:
        return answer["answer"]
    if not isinstance(answer, dict) or not isinstance(answer.get("text"), str):
        return plugin.broken("its process sent what is no answer")
    text = bounded(answer["text"])
    kind = answer.get("error")
    error = named(kind, text) if isinstance(kind, str) and kind else plugin.broken(text)
    if isinstance(answer.get("trace"), str) and answer["trace"]:
        error.add_note(bounded(answer["trace"]))
    return error


def serve(channel: Channel, notes: "memoryview[float]", answerer: Answerer) -> None:
    """Answer the questions of a channel, one by one. Runs in the plugin's process."""
    try:
        folder = Path.cwd()
        for question in channel.receive():
            os.chdir(folder)
            notes[0] = 0.0
            channel.send(_answer_to(answerer, question, lambda step: _note(notes, step)))
    except (EOFError, ChannelError):
        return  # no more questions


def _note(notes: "memoryview[float]", step: str) -> None:
    notes[0] = float(_STEPS.index(step))


def _answer_to(answerer: Answerer, question: Any, on_step: StepCallback) -> dict[str, Any]:
    try:
        return {"answer": answerer(question, on_step)}
    except BenchnavError as error:
        return {"error": type(error).__name__, "text": plain(error), "trace": trace(error)}
    except BaseException as error:
        return {"text": exception_text(error), "trace": trace(error)}
