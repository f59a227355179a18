"""The checks that every navigator must pass, also those of plugins.

`check_navigator("name")` or `check_navigator(Class)` raises AssertionError with a
sentence that names the violated rule. The quality of a navigator is not checked.
"""

from collections.abc import Callable
from dataclasses import replace
from functools import lru_cache, partial
from typing import Any

import numpy as np

from benchnav.arena.noise import Noise
from benchnav.arena.sensing import Sensing
from benchnav.arena.world import World
from benchnav.navigation.command_check import exception_text, short
from benchnav.navigation.navigator import ALL_DYNAMICS, Navigator, Need
from benchnav.plugins import NAVIGATORS
from benchnav.testing.observations import (
    answers_of,
    briefings_of,
    called,
    contents,
    masked,
    observations_of,
)
from benchnav.testing.requirement import (
    Subject,
    global_generators_untouched,
    maker,
    require,
    require_config,
    require_same,
)
from benchnav.testing.scenes import NOISE, USUAL, renumbered, scene, with_bodies
from benchnav.testing.sensings import accepted

Make = Callable[[], Navigator]
Worlds = tuple[World, ...]


def check_navigator(navigator: Subject, sensing: Sensing | None = None) -> None:
    """Check that a navigator keeps the contract of navigators.

    Args:
        navigator: a registered name, ``{type: name, …parameters}``, a class, or any
            function that makes a fresh instance.
        sensing: the sensors of the worlds of the checks; None: usual ones, or others that the
            navigator accepts (`Navigator.unfit`).

    Raises:
        AssertionError: the navigator breaks the contract; the message names the rule.
    """
    make: Make = maker(NAVIGATORS, navigator)
    check_declaration(make)
    worlds = _scenes(make(), sensing)
    for check in CHECKS:
        check(make, worlds)


def check_declaration(make: Make) -> None:
    """Check that Config, needs, command, bodies and rehearsals are declared correctly."""
    navigator = make()
    name = type(navigator).__name__
    require(isinstance(navigator, Navigator), f"{name} must derive from Navigator.")
    require_config(navigator)
    needs = navigator.required
    wrong = not isinstance(needs, frozenset) or needs - set(Need)
    require(not wrong, f"{name} must need a frozenset of {[*map(str, Need)]}. Got {needs!r}.")
    require(
        navigator.command in ("velocity", "twist"),
        f"{name}.command must be 'velocity' or 'twist'. Got {navigator.command!r} instead.",
    )
    drives = navigator.drives
    known = isinstance(drives, frozenset) and drives and drives <= ALL_DYNAMICS
    require(
        bool(known),
        f"{name}.drives must be a frozenset of {sorted(ALL_DYNAMICS)} that is not empty."
        f" Got {drives!r}.",
    )
    count = navigator.rehearsal
    whole = isinstance(count, int) and not isinstance(count, bool) and count >= 0
    require(whole, f"{name}.rehearsal must be how many rehearsals it asks for. Got {count!r}.")
    require(
        not count or navigator.leader is not None,
        f"{name} asks for rehearsals, so {name}.leader must name the navigator of the leaders.",
    )


def check_answer(
    make: Make, worlds: Worlds, noise: Noise | None = None, circumstance: str = ""
) -> None:
    """Check for finite commands of the right shape, from needed inputs only, without writes.

    ``noise`` is that of the senses (None: they are exact), ``circumstance`` a part of messages.
    """
    navigator = make()
    name, needs = type(navigator).__name__, navigator.required
    briefings = briefings_of(worlds, needs, navigator.rehearsal)
    before = [contents(briefing) for briefing in briefings]
    with global_generators_untouched(name):
        _call(name, "reset", needs, navigator.reset, briefings, np.arange(len(briefings)))
    _unchanged(name, "briefing", before, [contents(briefing) for briefing in briefings])
    for observation in observations_of(worlds, needs, noise=noise):
        copy, shape = contents(observation), (*observation.active.shape, 2)
        with global_generators_untouched(name):
            answer = _call(name, f"act{circumstance}", needs, navigator.act, observation)
        _unchanged(name, "observation", [copy], [contents(observation)])
        real = isinstance(answer, np.ndarray) and answer.dtype.kind in "iuf"
        require(real, f"{name}.act must return an array of real numbers. Got {answer!r} instead.")
        require(answer.shape == shape, f"{name}.act must return shape {shape}. Got {answer.shape}.")
        finite = np.isfinite(answer[observation.active]).all()
        require(
            finite, f"{name}.act must return finite commands for all active agents{circumstance}."
        )


def check_repeatable(make: Make, worlds: Worlds) -> None:
    """Check that equal briefings and observations give equal commands, in any instance."""
    navigator = make()
    if navigator.reproducible:
        first, name = answers_of(navigator, worlds), type(navigator).__name__
        again = answers_of(navigator, worlds)
        require_same(first, again, name, "after a second reset with the same briefings")
        require_same(first, answers_of(make(), worlds), name, "in another instance")


def check_batch(make: Make, worlds: Worlds) -> None:
    """Check that a world's commands do not depend on other worlds of the call or on its row."""
    if not make().reproducible:
        return
    together, name = answers_of(make(), worlds), type(make()).__name__
    single = [
        answers_of(make(), [world], np.array([7]), circumstance="for a world in row 7")[0]
        for world in worlds
    ]
    require_same(together, single, name, "for a world alone as in a batch")
    where = "for worlds in rows 4, 9 and 2"
    turned = answers_of(make(), worlds[::-1], np.array([4, 9, 2]), circumstance=where)[::-1]
    require_same(together, turned, name, "whatever the order of worlds and their rows")
    padded = answers_of(make(), worlds, padding=3, circumstance="with more padding")
    require_same(together, padded, name, "with more padding")


def check_order_of_agents(make: Make, worlds: Worlds) -> None:
    """Check that another numbering of the agents only renumbers the commands."""
    if not make().reproducible:
        return
    orders = [np.roll(np.arange(len(world.agents))[::-1], 1) for world in worlds]
    other = [renumbered(world, order) for world, order in zip(worlds, orders, strict=True)]
    expected = [a[:, order] for a, order in zip(answers_of(make(), worlds), orders, strict=True)]
    name = type(make()).__name__
    require_same(expected, answers_of(make(), other), name, "whatever the order of agents")


def check_rows(make: Make, worlds: Worlds) -> None:
    """Check that state belongs to a row: calls and resets of other rows have no effect."""
    navigator = make()
    if not navigator.reproducible:
        return
    kept, disturbing, _ = worlds
    needs, row, other = navigator.required, np.array([0]), np.array([1])
    expected = answers_of(make(), [kept], row)
    count = navigator.rehearsal
    name, call = type(navigator).__name__, partial(called, navigator, "in one row of several")
    call("reset", briefings_of([kept, disturbing], needs, count), np.array([0, 1]))
    got = []
    noise = observations_of([disturbing], needs, other)
    for k, observation in enumerate(observations_of([kept], needs, row)):
        if k == 3:
            call("reset", briefings_of([disturbing], needs, count), other)
        call("act", noise[k % 3])
        got.append(masked(call("act", observation), observation)[0])
    require_same(expected, [np.stack(got)], name, "whatever happens in other rows")


def check_map(make: Make, worlds: Worlds) -> None:
    """Check that a navigator with ``uses_map`` False needs no map and ignores one."""
    navigator, name = make(), type(make()).__name__
    if navigator.uses_map or not navigator.reproducible:
        return
    require(
        Need.MAP not in navigator.required,
        f"{name} must not need a map if its uses_map is False.",
    )
    without = answers_of(navigator, worlds)
    with_map = answers_of(make(), worlds, shown=frozenset({Need.MAP}))
    require_same(without, with_map, name, "with a map as without: its uses_map is False")


def check_bodies(make: Make, worlds: Worlds) -> None:
    """Check the commands for all bodies that the navigator drives, capsules too, with limits."""
    drives = make().drives
    bodies = tuple(with_bodies(world, drives) for world in worlds)
    check_answer(make, bodies, circumstance=" for every body that it drives")


def check_noisy_senses(make: Make, worlds: Worlds) -> None:
    """Check the commands with noisy senses: late and missing readings, a pose that drifts."""
    check_answer(make, worlds, NOISE, circumstance=" with noisy senses")


CHECKS: tuple[Callable[[Make, Worlds], None], ...] = (
    check_answer, check_repeatable, check_batch, check_order_of_agents,
    check_rows, check_map, check_bodies, check_noisy_senses,
)  # fmt: skip


def _scenes(navigator: Navigator, sensing: Sensing | None) -> Worlds:
    """Return worlds with these sensors, or with sensors that the navigator accepts."""
    name = type(navigator).__name__
    chosen = accepted(navigator) if sensing is None else sensing
    if chosen is None:
        raise AssertionError(
            f"{name} must be able to drive agents with some sensors. Of all that were tried it"
            f" accepts none; of those that scenarios usually have, {name}.unfit says:"
            f" {short(navigator.unfit(USUAL))}. Give the sensors that it is made for:"
            " check_navigator(…, sensing=Sensing(…))."
        )
    reason = navigator.unfit(chosen)
    require(
        not reason, f"{name} must accept the sensing that it is checked with. It says: {reason}."
    )
    return _drawn(chosen, navigator.drives)


@lru_cache
def _drawn(sensing: Sensing, drives: frozenset[str]) -> Worlds:
    drawn = scene(1, 3), scene(2, 5), scene(3, 1)
    usual = drives >= {"holonomic", "unicycle"}
    bodies = drawn if usual else tuple(with_bodies(world, drives) for world in drawn)
    return tuple(replace(world, sensing=sensing) for world in bodies)


def _call(
    name: str, method: str, needs: frozenset[Need], call: Callable[..., Any], *arguments: Any
) -> Any:
    try:
        return call(*arguments)
    except Exception as error:
        hint = (
            f" Where it is made for certain sensors, {name}.unfit(sensing) must say why it cannot"
            " drive with others."
        )
        raise AssertionError(
            f"{name}.{method} must work with what it needs"
            f" ({', '.join(sorted(needs)) or 'nothing'})"
            f" and nothing more. It raised {exception_text(error)}."
            f"{hint if needs - {Need.MAP} else ''}"
        ) from error


def _unchanged(name: str, input: str, before: list[list[Any]], after: list[list[Any]]) -> None:
    same = all(
        np.array_equal(a, b, equal_nan=a.dtype.kind == "f")
        for one, other in zip(before, after, strict=True)
        for a, b in zip(one, other, strict=True)
    )
    require(same, f"{name} must not write into its {input}.")
