"""Compare a stored episode with the re-simulation of its commands."""

from dataclasses import fields

import numpy as np

from benchnav.episode.episode import Contacts, Episode, Status
from benchnav.runner.rollouts.latency import DECISIONS
from benchnav.runner.rollouts.rollout import MAX_WORLDS
from benchnav.store.parts.digest import digest
from benchnav.verify.difference import first_difference
from benchnav.verify.finding import Report

_STATES = ("position", "heading", "status", "body_position", "arrival")


def compare(stored: Episode, again: Episode, where: str, report: Report) -> None:
    """Report every array that differs in any bit, and a digest that does not match."""
    for name in _STATES:
        _differ("state", name, getattr(stored, name), getattr(again, name), where, report)
    _differ("command", "executed", stored.executed, again.executed, where, report)
    if len(stored.contacts) != len(again.contacts):
        report.find(
            "event", where,
            f"there are {len(stored.contacts)} events; the commands lead to {len(again.contacts)}",
        )  # fmt: skip
    else:
        for f in fields(Contacts):
            own, other = getattr(stored.contacts, f.name), getattr(again.contacts, f.name)
            _differ("event", f"contacts.{f.name}", own, other, where, report)
    right = digest(stored)
    if stored.digest != right:
        report.find("digest", where, f"digest is {stored.digest[:12]}…, not {right[:12]}…")
    report.counts["states"] += stored.position.shape[0] * stored.position.shape[1]
    report.counts["events"] += len(stored.contacts)


def _differ(
    kind: str, name: str, stored: np.ndarray, again: np.ndarray, where: str, report: Report
) -> None:
    text = first_difference(stored, again, name)
    if text:
        report.find(kind, where, f"{text} (re-simulated)")


def check_commands(stored: Episode, again: Episode, where: str, report: Report) -> None:
    """Report commands of inactive agents, which must be 0."""
    steps = min(len(stored.requested), len(again.requested))
    idle = again.status[:steps] != int(Status.ACTIVE)
    strange = np.argwhere(idle & (stored.requested[:steps] != 0.0).any(axis=2))
    if len(strange):
        t, i = strange[0]
        report.find("command", where, f"requested[{t}, {i}] must be 0, for agent {i} is not active")


def check_timings(episode: Episode, probe: bool, where: str, report: Report) -> None:
    """Report impossible timings; possible ones cannot be verified."""
    times, steps = episode.timings, len(episode.requested)
    seconds = [times.decision, np.array([times.planning, times.rehearsal])]
    latency = times.latency
    if latency is not None:
        seconds.append(latency)
    wrong = {
        "there must be one decision time for each decision": times.decision.shape != (steps,),
        "seconds must be finite and not negative": not all(
            np.isfinite(s).all() and (s >= 0.0).all() for s in seconds
        ),
        f"a batch must have 1 to {MAX_WORLDS} worlds": not 1 <= times.batch <= MAX_WORLDS,
        "latency must be stored with the first seed of a cell": latency is not None and not probe,
        f"latency must have at most {DECISIONS} calls": latency is not None
        and len(latency) > DECISIONS,
        "memory must be more than 0": times.memory is not None and times.memory <= 0,
    }
    for text, broken in wrong.items():
        if broken:
            report.find("timing", where, text)
