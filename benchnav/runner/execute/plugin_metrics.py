"""Metrics of plugins: each is measured in a process of its own, which may hang or die."""

import math
import os
import signal
import socket
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, NoReturn

from benchnav.episode.episode import Episode
from benchnav.errors import BenchnavError
from benchnav.metrics.measure import load_metric, subjects, valued
from benchnav.navigation.command_check import short
from benchnav.navigation.plugin.trace import bounded, plain
from benchnav.plugins import Registration, adopt
from benchnav.processes.channel import Channel, ChannelError
from benchnav.processes.main_module import import_main
from benchnav.processes.process_tree import kill

ATTEMPTS = 3  # processes that may hang or die over one part; then its other values are missing

Rows = list[dict[str, Any]]


def guest_rows(
    name: str,
    episodes: Sequence[Episode],
    registrations: Sequence[Registration],
    main: Mapping[str, str],
    timeout: float,
) -> list[Rows]:
    """For each episode the rows of `RESULTS` of the metric ``name``.

    A value that its process does not give within ``timeout`` [s] is missing, with the reason.
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
    """What its process says of each episode; after a text, which is why it failed, no more."""
    ours, theirs = socket.socketpair()
    pid = os.fork()
    if not pid:
        ours.close()
        _be_measured_in(Channel(theirs), name, episodes, registrations, main)
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


def _be_measured_in(
    channel: Channel, name: str, episodes: Sequence[Episode],
    registrations: Sequence[Registration], main: Mapping[str, str],
) -> NoReturn:  # fmt: skip
    """The process: it says the values of each episode, role by role."""
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
    return [valued(metric, episode, members) for _, members in subjects(episode)]


def _rows(name: str, episode: Episode, answer: Any) -> Rows:
    """Rows of what the process said, of which nothing is believed."""
    rows = []
    for k, (common, members) in enumerate(subjects(episode)):
        said = _checked(answer, k, int(members.sum()))
        rows.append({**common, "metric": name, **said})
    return rows


def _checked(answer: Any, k: int, most: int) -> dict[str, Any]:
    if isinstance(answer, str):
        return {"value": math.nan, "defined": 0, "missing": answer, "traceback": None}
    try:
        said = answer[k]
        value, defined, trace = float(said["value"]), said["defined"], said["traceback"]
        if not isinstance(defined, int) or not 0 <= defined <= most:
            raise ValueError
        return {
            "value": value, "defined": defined, "missing": short(plain(said["missing"])),
            "traceback": None if trace is None else bounded(trace),
        }  # fmt: skip
    except (KeyError, IndexError, TypeError, ValueError, OverflowError):
        return _checked("its process sent what is no value", k, most)
