"""Signals that end the command: an orderly end, one sentence, and the status of the signal."""

import signal
from collections.abc import Callable
from functools import wraps
from time import monotonic
from types import FrameType
from typing import ParamSpec, TypeVar

import typer

from benchnav.cli.console import say

P = ParamSpec("P")
R = TypeVar("R")
PATIENCE = 3.0  # [s] after a signal during which further signals are ignored
_ENDING = ("SIGINT", "SIGTERM", "SIGHUP")
_AGAIN = "the work is not finished. Give the same command again."


class Stopped(KeyboardInterrupt):
    """A signal requests the end of this process."""

    def __init__(self, number: int) -> None:
        super().__init__()
        self.number = number


def stop_on_signals() -> None:
    """Raise Stopped in the main thread at each signal of `_ENDING` that is not ignored."""
    quiet_until = 0.0

    def stop(number: int, frame: FrameType | None) -> None:
        nonlocal quiet_until
        if monotonic() >= quiet_until:
            quiet_until = monotonic() + PATIENCE
            raise Stopped(number)

    for name in _ENDING:
        number = getattr(signal, name, None)
        if number is not None and signal.getsignal(number) is not signal.SIG_IGN:
            signal.signal(number, stop)


def stoppable(verb: Callable[P, R]) -> Callable[P, R]:
    """Return a verb that reports a signal, and ends with the signal's exit status.

    Notes on the exception describe the kept work and how to continue.
    """

    @wraps(verb)
    def until_stopped(*args: P.args, **kwargs: P.kwargs) -> R:
        try:
            return verb(*args, **kwargs)
        except KeyboardInterrupt as stopped:
            raise typer.Exit(report_stop(stopped)) from None

    return until_stopped


def report_stop(stopped: BaseException | None) -> int:
    """Report the signal that stopped the command and its notes; return the exit status."""
    number = stopped.number if isinstance(stopped, Stopped) else signal.SIGINT
    notes = " ".join(getattr(stopped, "__notes__", ())) or _AGAIN
    say(f"Interrupted by {signal.Signals(number).name}: {notes}")
    return 128 + number
