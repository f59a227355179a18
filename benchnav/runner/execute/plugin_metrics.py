"""Metrics of plugins: each runs in its own process, which may hang or crash."""

import math
import os
import signal
import socket
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, NoReturn

from benchnav.episode.episode import Episode
from benchnav.errors import BenchnavError
from benchnav.metrics.measure import load_metric, measure_alone, subjects
from benchnav.navigation.command_check import short
from benchnav.navigation.plugin.trace import bounded, plain
from benchnav.plugins import Registration, adopt
from benchnav.processes.channel import Channel, ChannelError
from benchnav.processes.main_module import import_main
from benchnav.processes.process_tree import kill

ATTEMPTS = 3  # processes that may fail on one part, before its remaining values are missing

Rows = list[dict[str, Any]]


def plugin_rows(
    name: str,
    episodes: Sequence[Episode],
    registrations: Sequence[Registration],
    main: Mapping[str, str],
    timeout: float,
) -> list[Rows]:
    """Return the rows of `RESULTS` of the metric ``name``, for each episode.

    A value that takes longer than ``timeout`` [s] is missing, with a reason.
    """
    found: list[Rows] = []
    fault = ""
    for _ in range(ATTEMPTS):
        left = episodes[len(found) :]
        if not left:
            return found
        values = _answers(name, left, registrations, main, timeout)
        for episode, answer in zip(left, values, strict=False):
            fault = answer if isinstance(answer, str) else ""
            found.append(_rows(name, episode, answer))
    return found + [_rows(name, episode, fault) for episode in episodes[len(found) :]]


def _answers(
    name: str, episodes: Sequence[Episode], registrations: Sequence[Registration],
    main: Mapping[str, str], timeout: float,
) -> Iterator[Any]:  # fmt: skip
    """Yield an answer for each episode, or a text with the reason of a failure as the last one."""
    ours, theirs = socket.socketpair()
    pid = os.fork()
    if not pid:
        ours.close()
        _serve_values(Channel(theirs), name, episodes, registrations, main)
    theirs.close()
    channel = Channel(ours)
    try:
        for _ in episodes:
            try:
                yield channel.receive(timeout)
            except TimeoutError:
                yield f"it did not return within {timeout:g} s"
                return
            except (EOFError, ChannelError):
                yield "its process ended, or sent what is no value"
                return
    finally:
        channel.close()
        kill(pid)
        os.waitpid(pid, 0)


def _serve_values(
    channel: Channel, name: str, episodes: Sequence[Episode],
    registrations: Sequence[Registration], main: Mapping[str, str],
) -> NoReturn:  # fmt: skip
    """Send the values of each episode, role by role, and end this process."""
    code = 1
    try:
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        if main:
            import_main(dict(main))
        adopt(registrations)
        for episode in episodes:
            channel.send(_values(name, episode))
        code = 0
    finally:
        os._exit(code)


def _values(name: str, episode: Episode) -> list[dict[str, Any]]:
    try:
        metric = load_metric(name)
    except BenchnavError as error:
        fault = {"value": math.nan, "defined": 0, "missing": short(error), "traceback": None}
        return [fault for _ in subjects(episode)]
    return [measure_alone(metric, episode, members)._asdict() for _, members in subjects(episode)]


def _rows(name: str, episode: Episode, answer: Any) -> Rows:
    """Return the rows of an answer after its validation."""
    rows = []
    for k, (common, members) in enumerate(subjects(episode)):
        fields = _checked(answer, k, int(members.sum()))
        rows.append({**common, "metric": name, **fields})
    return rows


def _checked(answer: Any, k: int, most: int) -> dict[str, Any]:
    if isinstance(answer, str):
        return {"value": math.nan, "defined": 0, "missing": answer, "traceback": None}
    try:
        fields = answer[k]
        value, defined, trace = float(fields["value"]), fields["defined"], fields["traceback"]
        if not isinstance(defined, int) or not 0 <= defined <= most:
            raise ValueError
        return {
            "value": value, "defined": defined, "missing": short(plain(fields["missing"])),
            "traceback": None if trace is None else bounded(trace),
        }  # fmt: skip
    except (KeyError, IndexError, TypeError, ValueError, OverflowError):
        return _checked("its process sent what is no value", k, most)
