"""The plans of one world: checked, kept, and reported after the episode."""

import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from benchnav.navigation.command_check import CallFailed, short
from benchnav.navigation.planner import Plan
from benchnav.navigation.plugin.trace import class_name

NO_REASON = "the planner gives no reason"


class PlanLog:
    """The plans of the agents of one world."""

    def __init__(self, count: int) -> None:
        self._last: list[Plan | None] = [None] * count
        self._first_failure: list[str] = [""] * count  # reason while an agent had no path yet
        self._had_path = np.zeros(count, np.bool_)
        self._narrow = np.zeros(count, np.bool_)  # whether a path left too little clearance

    def note(self, agent: int, plan: Plan) -> None:
        """Store the plan of an agent."""
        self._last[agent] = plan
        if plan.solved:
            self._had_path[agent] = True
            self._narrow[agent] |= math.isfinite(plan.clearance)
        elif not self._had_path[agent]:
            self._first_failure[agent] = reason_of(plan)

    def remarks(self, *, adapts: bool) -> list[str]:
        """Return the facts about these plans for a reader of the results, in short sentences.

        ``adapts``: whether the path's clearance bounds the controller's distance from walls.
        """
        return [*self._paths(), *([] if adapts else self._passages())]

    def _paths(self) -> Iterator[str]:
        """Yield remarks on agents without a path or without a new one, by reason."""
        found: dict[tuple[str, str], int] = {}
        for agent, plan in enumerate(self._last):
            reason = "" if plan is None or plan.solved else reason_of(plan)
            if self._first_failure[agent]:
                when = " at first" if self._had_path[agent] else ""
                key = f"the planner found no path{when}", self._first_failure[agent]
                found[key] = found.get(key, 0) + 1
            if reason and self._had_path[agent]:
                key = "the planner found no new path, and the old one was kept", reason
                found[key] = found.get(key, 0) + 1
        for (fact, reason), count in found.items():
            yield f"{fact}{self._of(count)}: {reason}"

    def _passages(self) -> Iterator[str]:
        count = int(self._narrow.sum())
        if count:
            yield (
                f"the path{self._of(count)} passes a place that is narrower than the planner's"
                " clearance: a controller that keeps more from walls stops there"
            )

    def _of(self, count: int) -> str:
        return "" if count == len(self._last) else " for some agents"


def reason_of(plan: Plan) -> str:
    """Return why a plan is not solved."""
    return short(plan.reason) or NO_REASON


def checked_plan(plan: Any, planner: object) -> Plan:
    """Return the plan of a planner. Raises CallFailed if it is not a valid plan."""
    name = class_name(planner)
    if not isinstance(plan, Plan):
        got = "None" if plan is None else f"a {class_name(plan)}"
        raise CallFailed(
            f"the planner {name} must return a Plan, also where it finds no path"
            f" (Plan(UNSOLVED, False, reason=…)). Got {got} instead"
        )
    if not plan.solved:
        return plan
    path = plan.path
    shaped = isinstance(path, np.ndarray) and path.ndim == 2 and path.shape[1:] == (2,)
    if not shaped or path.dtype.kind not in "iuf" or not len(path):
        got = f"shape {path.shape}" if isinstance(path, np.ndarray) else f"a {class_name(path)}"
        raise CallFailed(
            f"the path that the planner {name} found must be numbers of shape (W, 2), W > 0."
            f" Got {got} instead"
        )
    if not np.isfinite(path).all():
        raise CallFailed(f"the path that the planner {name} found must be finite. It is not")
    return plan
