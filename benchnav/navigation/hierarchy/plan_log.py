"""What planning answered in one world: checked, kept, and told after the episode."""

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
        self._wanting: list[str] = [""] * count  # why an agent had no path, if it ever had none
        self._led = np.zeros(count, np.bool_)  # it has been given a path
        self._narrow = np.zeros(count, np.bool_)  # one that leaves too little clearance

    def note(self, agent: int, plan: Plan) -> None:
        """Keep what was answered for an agent."""
        self._last[agent] = plan
        if plan.solved:
            self._led[agent] = True
            self._narrow[agent] |= math.isfinite(plan.clearance)
        elif not self._led[agent]:
            self._wanting[agent] = reason_of(plan)

    def remarks(self, *, adapts: bool) -> list[str]:
        """What a reader of the results must know of these plans, in short sentences.

        ``adapts`` says that the controller keeps no more from walls than the path leaves.
        """
        return [*self._paths(), *([] if adapts else self._passages())]

    def _paths(self) -> Iterator[str]:
        """Agents without a path, by reason: the controller alone drove them."""
        found: dict[tuple[str, str], int] = {}
        for agent, plan in enumerate(self._last):
            said = "" if plan is None or plan.solved else reason_of(plan)
            if self._wanting[agent]:
                when = " at first" if self._led[agent] else ""
                key = f"the planner found no path{when}", self._wanting[agent]
                found[key] = found.get(key, 0) + 1
            if said and self._led[agent]:
                key = "the planner found no new path, and the old one was kept", said
                found[key] = found.get(key, 0) + 1
        for (what, reason), count in found.items():
            yield f"{what}{self._of(count)}: {reason}"

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
    """Why a plan is not solved."""
    return short(plan.reason) or NO_REASON


def checked_plan(plan: Any, planner: object) -> Plan:
    """The plan, if it is one. Raises CallFailed where a planner answered anything else."""
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
