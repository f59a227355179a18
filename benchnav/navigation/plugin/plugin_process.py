"""Asks plugins in processes of their own, which send plain data or why there is none.

Code of a plugin may hang, end its process, raise whatever it likes, or say that it is what it
is not: this costs the plugin itself, and never the process that asks.
"""

import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from benchnav.errors import BenchnavError, BrokenPluginError, named
from benchnav.navigation.command_check import said
from benchnav.navigation.plugin.trace import bounded, plain, trace
from benchnav.processes.channel import Channel, ChannelError
from benchnav.processes.inquiry import Fault, Inquiry, Limits, Step, inquire

TIMEOUT = 300.0  # [s] of a call of a plugin, unless somebody says otherwise
_IMPORTING = 10.0  # [s] that at least are granted to an import, of a large library say
_MEMORY = 4e9  # [bytes]
IMPORT, CONFIG, MEASURING = "import", "Config", "measuring"
_STEPS = (
    IMPORT, CONFIG, "__init__", "required", "command", "uses_map", "reproducible", "rehearsal",
    "leader", "training", "fingerprint", "parts", "unfit", "remarks", MEASURING,
)  # fmt: skip
Stepping = Callable[[str], None]
"""Told which step of `_STEPS` begins."""
Telling = Callable[[Any, Stepping], Any]
"""(question, stepping) -> answer, both what JSON can say."""


@dataclass(frozen=True)
class Plugin:
    """Whom a question is about, for messages."""

    kind: str  # "navigator"
    name: str
    where: str = ""  # what names it: a line of a file
    question: Any = None

    def broken(self, cause: str) -> BrokenPluginError:
        """The error that says so."""
        at = f"{self.where}: " if self.where else ""
        return BrokenPluginError(f"{at}The {self.kind} {self.name!r} cannot be used: {cause}.")


def ask_plugins(
    target: str, groups: Sequence[Sequence[Plugin]], timeout: float = TIMEOUT
) -> list[list[Any]]:
    """What each plugin of each group answers, or the BenchnavError that says why it does not.

    Args:
        target: "module:function", which calls `tell`.
        groups: a process is started for each of them; it goes on after a plugin that raises.
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
    """What was sent, of which nothing is believed."""
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


def tell(channel: Channel, notes: "memoryview[float]", telling: Telling) -> None:
    """Answer the questions that come, one by one. Of the process that was asked."""
    try:
        folder = Path.cwd()
        for question in channel.receive():
            os.chdir(folder)
            notes[0] = 0.0
            channel.send(_told(telling, question, lambda step: _note(notes, step)))
    except (EOFError, ChannelError):
        return  # nobody asks any more


def _note(notes: "memoryview[float]", step: str) -> None:
    notes[0] = float(_STEPS.index(step))


def _told(telling: Telling, question: Any, stepping: Stepping) -> dict[str, Any]:
    try:
        return {"answer": telling(question, stepping)}
    except BenchnavError as error:
        return {"error": type(error).__name__, "text": plain(error), "trace": trace(error)}
    except BaseException as error:
        return {"text": said(error), "trace": trace(error)}
