"""The page of a scenario: arena, teams, obstacles, terms, parameters and worlds."""

from collections.abc import Iterator
from textwrap import fill
from typing import TYPE_CHECKING

from benchnav.text.plural import counted

if TYPE_CHECKING:
    from benchnav.scenario.obstacle import DynamicGroup, StaticGroup
    from benchnav.scenario.sampling.region import Region
    from benchnav.scenario.sampling.sampler import Scalar
    from benchnav.scenario.scenario import Scenario
    from benchnav.scenario.shape import Shape
    from benchnav.scenario.team import Team

Fact = tuple[str, str]
WIDTH = 100  # of a page [characters]
_PLACES = {
    "circle": "on a circle",
    "grid": "in a grid",
    "points": "at points",
    "antipodal": "opposite",
    "packed": "packed side by side",
    "shifted": "as far away for all",
}


def scenario_page(scenario: "Scenario") -> str:
    """Return the page of a scenario. Draws six worlds to compare them."""
    from benchnav.errors import UnsolvableError

    try:
        worlds = worlds_text(scenario)
    except UnsolvableError as error:
        worlds = f"none: {error}"
    facts = [
        *_arena(scenario),
        *(("team" if not i else "", _team(team)) for i, team in enumerate(scenario.teams)),
        *_terms(scenario),
        ("tracks", ", ".join(scenario.granted_tracks)),
        *(("may set", text) for text in _parameters(scenario)),
        ("worlds", worlds),
        ("hash", scenario.hash),
    ]
    head = [("is", f"a scenario: {scenario.title or 'without a title'}")]
    page = [scenario.identity, *(_line(*fact) for fact in [*head, *facts])]
    if scenario.description.strip():
        page += ["", fill(scenario.description.strip(), WIDTH)]
    return "\n".join(page)


def _parameters(scenario: "Scenario") -> Iterator[str]:
    from benchnav.scenario.parameters import written

    for name, p in scenario.parameters.items():
        note = f" ({p.description})" if p.description else ""
        yield f"{name} = {written(p.default)} by default, {p.allowed}{note}"


def _line(key: str, value: str) -> str:
    first, rest = f"  {key:8} ", " " * 11
    return fill(value, WIDTH, initial_indent=first, subsequent_indent=rest, break_on_hyphens=False)


def worlds_text(scenario: "Scenario") -> str:
    """Return whether worlds differ between seeds and splits, from seeds 0 and 1 of each split.

    Raises UnsolvableError if a world cannot be drawn.
    """
    from benchnav.generation.world_digest import coincidences
    from benchnav.scenario.terms import SPLITS

    same = coincidences(scenario, (0, 1))
    if not same:
        return "differ from seed to seed, and between train, validation and test"
    if len(same[0]) == 2 * len(SPLITS):
        return "are all the same: nothing in them is random, so train, validation and test coincide"
    groups = (" = ".join(f"{split} {seed}" for split, seed in group) for group in same)
    return f"coincide in part (split and seed): {'; '.join(groups)}"


def _arena(scenario: "Scenario") -> Iterator[Fact]:
    x0, y0, x1, y1 = scenario.bounds
    around = "walled" if scenario.walled else "open"
    yield "arena", f"{x1 - x0:g} m × {y1 - y0:g} m, {around}"
    layout = scenario.layout
    if layout is not None:
        yield "walls", f"a {layout.type} layout of {layout.columns} × {layout.rows} cells"
    for i, wall in enumerate(scenario.walls[:6]):
        count = str(len(wall.places)) if len(wall.places) > 1 else "one"
        yield "" if i or layout else "walls", f"{count} {_shape(wall.shape)}"
    if len(scenario.walls) > 6:
        yield "", f"and {len(scenario.walls) - 6} more"
    for i, group in enumerate(scenario.static):
        yield "static" if not i else "", _static(group)
    for i, moving in enumerate(scenario.dynamic):
        yield "dynamic" if not i else "", _dynamic(moving)


def _static(group: "StaticGroup") -> str:
    text = f"{_count(group)} × {_shape(group.shape)}, {_where(group)}"
    if group.gap:
        text += f", at least {group.gap:g} m from all others"
    if group.was_moved:
        by = "" if group.moved is True else f" by {group.moved:g} m"
        text += f"; moved{by} since the stale map was made"
    if group.relocate_at is not None:
        text += f"; each re-placed once, after {number(group.relocate_at)} s"
    return text


def _dynamic(group: "DynamicGroup") -> str:
    law = group.law
    speed = getattr(law, "speed", None)
    way = law.type if speed is None else f"{law.type} at {number(speed)} m/s"
    return f"{_count(group)} × {_shape(group.shape)}, {way}, never yielding"


def _count(group: "StaticGroup | DynamicGroup") -> str:
    if group.at is not None:
        return str(len(group.points))
    return "1" if group.count is None else number(group.count)


def _where(group: "StaticGroup") -> str:
    return "at fixed points" if group.region is None else f"drawn {_region(group.region)}"


def _region(region: "Region") -> str:
    if region.type == "points":
        return f"from {counted(len(region.points), 'point')}"
    return "anywhere" if region.type == "anywhere" else f"in a {region.type}"


def _shape(shape: "Shape") -> str:
    if shape.type == "disc":
        return f"disc of radius {number(shape.radius)} m"
    if shape.type == "box":
        depth = shape.width if shape.depth is None else shape.depth
        return f"box of {number(shape.width)} m × {number(depth)} m"
    if shape.type == "polygon" or shape.type == "polyline":
        return f"{shape.type} of {len(shape.points)} points"
    return f"{shape.type} {shape.file}"


def _team(team: "Team") -> str:
    from benchnav.scenario.sampling.sampler import support

    speed = team.max_speed if team.preferred_speed is None else team.preferred_speed
    start, goal = (
        _region(place.region) if place.type == "region" else _PLACES[place.type]
        for place in (team.start, team.goal)
    )
    many = "" if support(team.count)[1] == 1 else "s"
    text = (
        f"{team.name}: {number(team.count)} {team.dynamics.type} {team.role}{many},"
        f" {_robot(team)}{_body(team)}, {number(speed)} m/s{_limits(team)}; start {start},"
        f" goal {goal}"
    )
    if team.goal.type == "region" and team.goal.min_distance:
        text += f" at least {team.goal.min_distance:g} m away"
    if not team.evaluated:
        text += f"; background, driven by {team.driver.type}"
    return text + (f"; does not see {', '.join(team.ignores)}" if team.ignores else "")


def _robot(team: "Team") -> str:
    if team.robot is None:
        return ""
    limits = "" if team.robot.acceleration_limits else " without acceleration limits"
    return f"robot {team.robot.type}{limits}, "


def _body(team: "Team") -> str:
    shape = team.footprint
    if team.disc_radius is not None or shape is None or shape.type == "disc":
        return f"radius {number(team.disc_radius or 0.0)} m"
    return f"{shape.type} of {number(shape.length)} m × {number(shape.width)} m"


def _limits(team: "Team") -> str:
    limits = [
        f"{verb} at {number(limit)} {unit}"
        for verb, limit, unit in (
            ("accelerates", team.max_acceleration, "m/s²"),
            ("brakes", team.max_deceleration, "m/s²"),
            ("turns faster", team.max_turn_acceleration, "rad/s²"),
        )
        if limit is not None
    ]
    return "".join(f", {limit}" for limit in limits)


def _noise(scenario: "Scenario") -> str:
    """Return the errors of noisy perception: those of the scenario's own sensors with numbers."""
    usual, texts = type(scenario.noise)(), []
    for sense in ("rays", "neighbours", "edges", "odometry"):
        errors = getattr(scenario.noise, sense)
        text = f"{sense} {errors.sensor}"
        if errors != getattr(usual, sense):
            numbers = errors.numbers.items()
            shown = (f"no {k}" if value is None else f"{k} {value:.4g}" for k, value in numbers)
            text += f" ({', '.join(shown)})"
        texts.append(text)
    return f"{'; '.join(texts)}; late by {counted(scenario.noise.delay, 'decision')}"


def _terms(scenario: "Scenario") -> Iterator[Fact]:
    clock, rules, sensing = scenario.clock, scenario.rules, scenario.sensing
    seen = []
    if sensing.rays is not None:
        seen.append(f"{sensing.rays.count} rays to {sensing.rays.range:g} m")
    if sensing.neighbours is not None:
        near = sensing.neighbours
        seen.append(f"the nearest {near.count} neighbours within {near.range:g} m")
    if sensing.edges is not None:
        seen.append(f"the nearest {sensing.edges.count} edges within {sensing.edges.range:g} m")
    hidden = "" if sensing.occlusion else "; without occlusion"
    yield "sensing", (", ".join(seen) or "nothing") + hidden
    if scenario.noise != type(scenario.noise)():
        yield "noise", _noise(scenario)
    budget = "" if clock.decision_budget is None else f" within {clock.decision_budget:g} s"
    yield (
        "clock",
        f"a decision every {clock.dt:g} s{budget}, {clock.substeps} substeps, until"
        f" {clock.horizon:g} s",
    )
    yield (
        "rules",
        f"arrived within {rules.goal_tolerance:g} m of the goal, then {rules.on_arrival};"
        f" contact: {rules.contact}",
    )


def number(scalar: "Scalar") -> str:
    """Return a number, or the distribution that it is drawn from."""
    from benchnav.scenario.sampling.sampler import Choice, Normal, support

    if isinstance(scalar, int | float):
        return f"{scalar:g}"
    if isinstance(scalar, Choice):
        return " or ".join(f"{value:g}" for value in scalar.choice)
    low, high = support(scalar)
    if isinstance(scalar, Normal):
        mean, deviation = scalar.normal[:2]
        return f"{mean:g} ± {deviation:g} ({low:g} to {high:g})"
    return f"{low:g} to {high:g}"
