"""The checks that every planner must pass, also those of plugins."""

from collections.abc import Callable
from functools import lru_cache
from itertools import pairwise

import numpy as np

from benchnav.arena.solid import Kind, Solid
from benchnav.arrays import FloatArray
from benchnav.geometry.sweep import motion_is_free
from benchnav.navigation.map import Map
from benchnav.navigation.planner import Plan, Planner
from benchnav.plugins import PLANNERS
from benchnav.testing.requirement import (
    Subject,
    global_generators_untouched,
    maker,
    require,
    require_config,
)

RADIUS, TOLERANCE = 0.3, 0.25  # [m]
SKIN = 1e-5  # [m] by which a path may cut into an obstacle
START, GOAL = np.array([1.0, 1.0]), np.array([9.0, 9.0])
BLOCKED = np.array([5.0, 5.0])

Make = Callable[[], Planner]


def check_planner(planner: Subject) -> None:
    """Check that a planner keeps the contract of planners.

    Args:
        planner: a registered name, ``{type: name, …parameters}``, a class, or any
            function that makes a fresh instance.

    Raises:
        AssertionError: the planner breaks the contract; the message names the rule.
    """
    make: Make = maker(PLANNERS, planner)
    for check in CHECKS:
        check(make)


def check_declaration(make: Make) -> None:
    """Check that it is a planner with a declared Config."""
    planner = make()
    require(isinstance(planner, Planner), f"{type(planner).__name__} must derive from Planner.")
    require_config(planner)


def check_path(make: Make) -> None:
    """Check that paths are finite, free for the disc and end at the goal; the map is unchanged."""
    for map in (empty(), furnished()):
        planner, before = make(), map.capsules.copy()
        name = type(planner).__name__
        with global_generators_untouched(name):
            plan = ask(planner, map)
        require(np.array_equal(before, map.capsules), f"{name} must not write into the map.")
        require(plan.solved, f"{name} must find a path in a plain map. It says: {plan.reason!r}.")
        _require_path(name, plan, map)


def check_unsolvable(make: Make) -> None:
    """Check that it returns an unsolved plan with a reason if there is no path."""
    for title, map, start, goal in (
        ("to a goal that is walled in", walled_in(), START, GOAL),
        ("from a start inside an obstacle", furnished(), BLOCKED, GOAL),
        ("to a goal inside an obstacle", furnished(), START, BLOCKED),
    ):
        planner = make()
        name = type(planner).__name__
        plan = ask(planner, map, start, goal)
        consistent = not plan.solved and len(plan.path) == 0 and plan.reason
        require(
            consistent, f"{name} must answer Plan(UNSOLVED, False, reason=…) {title}. Got {plan}."
        )


def check_repeatable(make: Make) -> None:
    """Check that plans depend on the generator, not on earlier plans."""
    planner, other = make(), make()
    if not planner.reproducible:
        return
    name, map = type(planner).__name__, furnished()
    first = ask(planner, map).path
    ask(other, map, GOAL, START, seed=5)
    for again, when in ((planner, "a second time"), (other, "after other plans")):
        same = np.array_equal(first, ask(again, furnished()).path)
        require(same, f"{name} must plan the same path for the same generator {when}.")


CHECKS: tuple[Callable[[Make], None], ...] = (
    check_declaration, check_path, check_unsolvable, check_repeatable,
)  # fmt: skip


def ask(
    planner: Planner, map: Map, start: FloatArray = START, goal: FloatArray = GOAL, seed: int = 0
) -> Plan:
    """Return the plan of one query. Raises AssertionError if the planner raises."""
    try:
        plan = planner.plan(
            map, start.copy(), goal.copy(), RADIUS, TOLERANCE, np.random.default_rng(seed)
        )
    except Exception as error:
        raise AssertionError(
            f"{type(planner).__name__}.plan must answer with a Plan."
            f" It raised {type(error).__name__}: {error}."
        ) from error
    require(
        isinstance(plan, Plan), f"{type(planner).__name__}.plan must return a Plan. Got {plan!r}."
    )
    return plan


def _require_path(name: str, plan: Plan, map: Map) -> None:
    path = plan.path
    shaped = path.ndim == 2 and path.shape[1] == 2 and len(path) > 0 and np.isfinite(path).all()
    require(shaped, f"{name}'s path must be a finite array (W, 2). Got {path!r}.")
    require(np.array_equal(path[0], START), f"{name}'s path must begin at the start {START}.")
    off = float(np.hypot(*(path[-1] - GOAL)))
    require(
        off <= TOLERANCE,
        f"{name}'s path must end within {TOLERANCE} m of the goal. It ends {off:g} m off.",
    )
    for (px, py), (qx, qy) in pairwise(path.tolist()):
        require(
            motion_is_free(px, py, qx, qy, RADIUS - SKIN, map.capsules),
            f"{name}'s path must be free for a disc of {RADIUS} m."
            f" From ({px:g}, {py:g}) to ({qx:g}, {qy:g}) it is not.",
        )


def _box(x0: float, y0: float, x1: float, y1: float) -> FloatArray:
    return np.array([(x0, y0), (x1, y0), (x1, y1), (x0, y1)])


def _arena(*solids: Solid) -> Map:
    wall = Solid(Kind.WALL, (_box(0.0, 0.0, 10.0, 10.0)[::-1].copy(),))
    return Map((0.0, 0.0, 10.0, 10.0), (wall, *solids))


@lru_cache
def empty() -> Map:
    """Return the map of a walled square of 10 m."""
    return _arena()


def furnished() -> Map:
    """Return the map of the square with boxes, a disc and a thin wall in the way."""
    return _arena(
        Solid(Kind.STATIC, (_box(4.0, 4.0, 6.0, 6.0),)),
        Solid(Kind.STATIC, (_box(1.0, 7.0, 2.5, 8.0),)),
        Solid(Kind.STATIC, center=(7.5, 3.0), radius=0.7),
        Solid(Kind.WALL, (np.array([(6.0, 6.0), (6.0, 9.0)]),)),
    )


def walled_in() -> Map:
    """Return the map of the square with a closed wall around the goal."""
    return _arena(Solid(Kind.WALL, (np.array([(7.0, 10.0), (7.0, 7.0), (10.0, 7.0), (7.0, 7.0)]),)))
