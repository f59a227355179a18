"""The measurer process: measures and seals the episodes of workers, and never runs a navigator.

Messages to the parent: {"kind": "episodes", "count"} for newly measured episodes, {"kind": "done",
…} with an Outcome, {"kind": "strange", "text"} for invalid files of a worker, {"kind": "refused",
"name", "text"} for any other BenchnavError, {"kind": "crashed", "text"} for any other exception.
"""

import pickle
import signal
import traceback
from collections.abc import Callable, Iterable, Iterator
from dataclasses import asdict
from time import monotonic
from typing import Any

import pyarrow as pa

from benchnav.arena.agents import Role
from benchnav.episode.episode import Episode
from benchnav.errors import BenchnavError, CorruptPartError
from benchnav.metrics.measure import own_metrics
from benchnav.processes.channel import Channel
from benchnav.runner.execute.call_timer import Notes
from benchnav.runner.execute.measurement import measured
from benchnav.runner.execute.plugin_metrics import plugin_rows
from benchnav.runner.plan.task import Measuring, Played, Task, measure_part
from benchnav.store.parts.results import RESULTS

_REPORT_INTERVAL = 0.1  # [s]


def serve(channel: Channel, notes: Notes) -> None:
    """Measure until the channel closes; ``notes`` count episodes."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    measuring: Measuring = pickle.loads(channel.receive_bytes())  # noqa: S301 - from the parent
    while True:
        try:
            task, played = pickle.loads(channel.receive_bytes())  # noqa: S301
        except EOFError:
            return
        channel.send(_answer(task, played, measuring, channel, notes))


def _answer(
    task: Task, played: Played, measuring: Measuring, channel: Channel, notes: Notes
) -> dict[str, Any]:
    ticks = _Ticks(channel, notes)
    notes[0] += 1
    try:
        outcome = measure_part(
            task, played, lambda es: measured_isolated(es, measuring, ticks.count)
        )
        ticks.report()
    except CorruptPartError as error:
        return {"kind": "strange", "text": str(error)}
    except BenchnavError as error:
        return {"kind": "refused", "name": type(error).__name__, "text": str(error)}
    except Exception:
        return {"kind": "crashed", "text": traceback.format_exc()}
    return {"kind": "done", **asdict(outcome)}


class _Ticks:
    """Counts measured episodes. Reports them now and then: each report wakes the parent."""

    def __init__(self, channel: Channel, notes: Notes) -> None:
        self._channel, self._notes = channel, notes
        self._new, self._reported = 0, monotonic()

    def count(self) -> None:
        """Count an episode, and report all new ones if the last report is some time ago."""
        self._notes[0] += 1
        self._new += 1
        if monotonic() - self._reported >= _REPORT_INTERVAL:
            self.report()

    def report(self) -> None:
        """Report all new episodes."""
        self._channel.send({"kind": "episodes", "count": self._new})
        self._new, self._reported = 0, monotonic()


def measured_isolated(
    episodes: Iterable[Episode], measuring: Measuring, tick: Callable[[], None]
) -> pa.Table:
    """Return the table of `RESULTS`; metrics of plugins run in other processes."""
    kept: list[Episode] = []
    table = measured(_kept(_ticked(episodes, tick), measuring, kept), own_metrics())
    if not measuring.plugins:
        return table
    rows: list[dict[str, Any]] = []
    for name in measuring.plugins:
        plugin_values = plugin_rows(
            name, kept, measuring.registrations, measuring.main, measuring.timeout
        )  # fmt: skip
        rows += [row for of_episode in plugin_values for row in of_episode]
    table = pa.concat_tables([table, pa.Table.from_pylist(rows, schema=RESULTS)])
    order = {episode.identity.seed: n for n, episode in enumerate(kept)}
    keys = [
        (order[seed], Role[role.upper()], metric)
        for seed, role, metric in zip(*(table[name].to_pylist() for name in _KEYS), strict=True)
    ]
    return table.take(sorted(range(len(keys)), key=keys.__getitem__)).combine_chunks()


_KEYS = ("seed", "role", "metric")


def _kept(
    episodes: Iterator[Episode], measuring: Measuring, kept: list[Episode]
) -> Iterator[Episode]:
    """Yield the episodes, and add them to ``kept`` if plugins measure them later."""
    for episode in episodes:
        if measuring.plugins:
            kept.append(episode)
        yield episode


def _ticked(episodes: Iterable[Episode], tick: Callable[[], None]) -> Iterator[Episode]:
    for episode in episodes:
        yield episode
        tick()
