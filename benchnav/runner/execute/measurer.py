"""A process in which no evaluated code runs: measures what workers wrote, and seals it.

Messages to the parent: {"kind": "episodes"} for each that is measured, {"kind": "done", …} with
an Outcome, {"kind": "strange", "text"} of what is not what a worker writes, and
{"kind": "refused", "name", "text"} of another BenchnavError, {"kind": "crashed", "text"}.
"""

import pickle
import signal
import traceback
from collections.abc import Callable, Iterable, Iterator
from dataclasses import asdict
from typing import Any

import pyarrow as pa

from benchnav.arena.agents import Role
from benchnav.episode.episode import Episode
from benchnav.errors import BenchnavError, CorruptPartError
from benchnav.metrics.measure import measure, own_metrics
from benchnav.processes.channel import Channel
from benchnav.runner.execute.call_timer import Notes
from benchnav.runner.execute.plugin_metrics import guest_rows
from benchnav.runner.plan.task import Measuring, Played, Task, measure_part
from benchnav.store.parts.results import RESULTS


def serve(channel: Channel, notes: Notes) -> None:
    """Measure until the channel closes; ``notes`` count episodes."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    measuring: Measuring = pickle.loads(channel.receive_bytes())  # noqa: S301 - of who started this
    while True:
        try:
            task, played = pickle.loads(channel.receive_bytes())  # noqa: S301
        except EOFError:
            return
        channel.send(_answer(task, played, measuring, channel, notes))


def _answer(
    task: Task, played: Played, measuring: Measuring, channel: Channel, notes: Notes
) -> dict[str, Any]:
    def tick() -> None:
        notes[0] += 1
        channel.send({"kind": "episodes"})

    notes[0] += 1
    try:
        outcome = measure_part(task, played, lambda es: measured_apart(es, measuring, tick))
    except CorruptPartError as error:
        return {"kind": "strange", "text": str(error)}
    except BenchnavError as error:
        return {"kind": "refused", "name": type(error).__name__, "text": str(error)}
    except Exception:
        return {"kind": "crashed", "text": traceback.format_exc()}
    return {"kind": "done", **asdict(outcome)}


def measured_apart(
    episodes: Iterable[Episode], measuring: Measuring, tick: Callable[[], None]
) -> pa.Table:
    """The table of `RESULTS` of these episodes; no metric of a plugin runs in this process."""
    kept: list[Episode] = []
    rows: list[list[dict[str, Any]]] = []  # of each episode
    for episode in _ticked(episodes, tick):
        rows.append(measure(episode, own_metrics()))
        if measuring.plugins:
            kept.append(episode)
    for name in measuring.plugins:
        guests = guest_rows(
            name, kept, measuring.registrations, measuring.main, measuring.timeout
        )  # fmt: skip
        for mine, theirs in zip(rows, guests, strict=True):
            mine += theirs
    sorted_rows = [row for mine in rows for row in sorted(mine, key=_place)]
    return pa.Table.from_pylist(sorted_rows, schema=RESULTS)


def _ticked(episodes: Iterable[Episode], tick: Callable[[], None]) -> Iterator[Episode]:
    for episode in episodes:
        yield episode
        tick()


def _place(row: dict[str, Any]) -> tuple[int, str]:
    return Role[row["role"].upper()], row["metric"]
