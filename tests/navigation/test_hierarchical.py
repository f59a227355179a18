from dataclasses import replace

import numpy as np
import pytest
from benchnav_baselines.planners.ompl.pairs import OmplOrca, OmplPure
from pydantic import Field

from benchnav.arena.solid import Kind, Solid
from benchnav.errors import ConfigError, UnknownPluginError
from benchnav.navigation.controller import Controller
from benchnav.navigation.hierarchy.hierarchical import Hierarchical
from benchnav.navigation.map import Map
from benchnav.navigation.navigator import Need, PluginConfig
from benchnav.navigation.planner import UNSOLVED, Plan, Planner
from benchnav.navigation.plugin.configure import make
from benchnav.plugins import CONTROLLERS, NAVIGATORS, PLANNERS
from tests.baselines.crowds import answers, briefing, joined, keyed, one_world, permuted

BOUNDS = (-20.0, -20.0, 20.0, 20.0)


class Detour(Planner):
    """Start, a random point, goal."""

    class Config(PluginConfig):
        fails: bool = False
        spread: float = Field(1.0, ge=0)
        timed: bool = False

    def __init__(self, config=None):
        super().__init__(config)
        self.calls = []

    @property
    def reproducible(self):
        return not self.config.timed

    def plan(self, map, start, goal, radius, tolerance, rng):
        self.calls.append((map.revision, tuple(start), tuple(goal), radius, tolerance))
        if self.config.fails:
            return Plan(UNSOLVED, False, 3, "blocked")
        middle = (start + goal) / 2 + self.config.spread * rng.random(2)
        return Plan(np.array([start, middle, goal]), True, 3)


class Spin(Controller):
    """A controller that answers twists."""

    command = "twist"
    needs = frozenset({Need.RAYS})

    def steer(self, observation, guide):
        return np.ones((*observation.active.shape, 2))


@pytest.fixture(autouse=True)
def stubs(monkeypatch):
    for registry, name, thing in (
        (PLANNERS, "detour", Detour),
        (CONTROLLERS, "spin", Spin),
    ):
        monkeypatch.setitem(registry._local, name, (thing, name))


def stand(agents, goal, map=None, **options):
    """(briefing, observation) of one world whose agents stand on the x axis."""
    start = np.column_stack([np.arange(agents) * 2.0, np.zeros(agents)])
    map = Map(BOUNDS, ()) if map is None else map
    told = briefing(start, goal, map=map, **options)
    _, seen = one_world(0, agents, mover=0)
    changes = {"position": start[None], "goal": told.goal[None], "maps": (map,)}
    return told, replace(seen, neighbours=None, edges=None, **changes)


def test_it_goes_to_where_its_plan_leads():
    told, seen = stand(1, [(6.0, 0.0)])
    navigator = make(NAVIGATORS, "detour+path-following")
    command = answers(navigator, [told], seen)[0, 0]
    middle = navigator.plans[0][0].path[1]
    np.testing.assert_allclose(command, middle / np.hypot(*middle), atol=1e-9)


def test_the_planner_is_told_what_the_agents_are_told():
    told, seen = stand(2, [(6.0, 0.0), (0.0, 5.0)], radius=0.25)
    navigator = Hierarchical(Hierarchical.Config(controller="path-following", planner="detour"))
    answers(navigator, [told], seen)
    assert navigator.planner.calls == [
        (0, (0.0, 0.0), (6.0, 0.0), 0.25, 0.2),
        (0, (2.0, 0.0), (0.0, 5.0), 0.25, 0.2),
    ]


def test_without_a_plan_the_goal_is_the_target_and_the_reason_is_kept():
    told, seen = stand(1, [(0.0, 6.0)])
    spec = {"type": "detour", "fails": True}
    navigator = Hierarchical(Hierarchical.Config(controller="path-following", planner=spec))
    np.testing.assert_allclose(answers(navigator, [told], seen), [[(0.0, 1.0)]])
    assert navigator.plans[0][0].reason == "blocked"


@pytest.mark.parametrize(
    ("replan", "times"),
    [
        ("never", []),
        ("map-change", [0.6]),
        ({"every": 0.4}, [0.4, 0.8, 1.2]),
        (["map-change", {"every": 0.4}], [0.4, 0.6, 1.0]),
        ("blocked", []),
    ],
)
def test_when_it_plans_again(replan, times):
    """The map changes at 0.6 s; what is planned then starts where the agent is."""
    told, seen = stand(1, [(6.0, 0.0)])
    navigator = Hierarchical(
        Hierarchical.Config(controller="path-following", planner="detour", replan=replan)
    )
    navigator.reset([told], seen.rows)
    planned = []
    for k in range(7):
        map = Map(BOUNDS, (), revision=int(k >= 3))
        position = np.array([[(0.1 * k, 0.0)]])
        before = len(navigator.planner.calls)
        navigator.act(replace(seen, time=np.array([k * 0.2]), position=position, maps=(map,)))
        for call in navigator.planner.calls[before:]:
            planned.append(round(k * 0.2, 1))
            assert call[0] == map.revision
            assert call[1] == tuple(position[0, 0])
    assert planned == times


def test_who_is_stuck_goes_back_the_way_it_came_and_plans_again():
    told, seen = stand(1, [(6.0, 0.0)])
    navigator = Hierarchical(
        Hierarchical.Config(
            controller="path-following", planner="detour", patience=1.0, give_way=1.0
        )
    )
    navigator.reset([told], seen.rows)
    backward, planned = [], []
    for k in range(60):
        place = np.array([[(min(0.2 * k, 2.0), 0.0)]])  # it comes to 2 m and no farther
        before = len(navigator.planner.calls)
        command = navigator.act(replace(seen, time=np.array([k * 0.2]), position=place))
        backward += [k * 0.2] * bool(command[0, 0, 0] < -0.5)
        planned += [k * 0.2] * (len(navigator.planner.calls) - before)
    assert 2.0 < backward[0] < 4.0
    assert any(backward[0] + 2.0 <= time <= backward[0] + 6.4 for time in planned)


def wall(y, *, revision):
    """A wall from (2, y) to (4, y)."""
    line = np.array([(2.0, y), (4.0, y)])
    return Map(BOUNDS, (Solid(Kind.WALL, (line,)),), revision)


def planned_at(navigator, told, seen, maps, place=lambda k: (0.1 * k, 0.0)):
    """[s] when it planned, seeing the world ``k`` every 0.2 s."""
    navigator.reset([told], seen.rows)
    when = []
    for k, map in enumerate(maps):
        before = len(navigator.planner.calls)
        position = np.array([[place(k)]])
        navigator.act(replace(seen, time=np.array([k * 0.2]), position=position, maps=(map,)))
        when += [round(k * 0.2, 1)] * (len(navigator.planner.calls) - before)
    return when


def straight(**parameters):
    planner = {"type": "detour", "spread": 0.0}
    return Hierarchical(
        Hierarchical.Config(controller="path-following", planner=planner, **parameters)
    )


def test_it_plans_again_when_its_path_is_blocked_and_not_when_another_place_is():
    """The disc (0.3 m) goes along y = 0: a wall 0.35 m beside it does not touch it, 0.25 m does."""
    told, seen = stand(1, [(6.0, 0.0)], radius=0.3)
    beside, across = wall(0.35, revision=1), wall(0.25, revision=2)
    maps = [Map(BOUNDS, ())] * 2 + [beside] * 2 + [across] * 3
    assert planned_at(straight(replan="blocked"), told, seen, maps) == [0.8]
    assert planned_at(straight(replan="map-change"), told, seen, maps) == [0.4, 0.8]
    assert planned_at(straight(replan=["blocked", {"every": 0.6}]), told, seen, maps) == [0.6, 1.0]


def test_what_blocks_the_path_behind_it_is_no_reason():
    told, seen = stand(1, [(6.0, 0.0)], radius=0.3)
    maps = [Map(BOUNDS, ())] * 3 + [wall(0.0, revision=1)] * 3
    walked = straight(replan="blocked")
    assert planned_at(walked, told, seen, maps, lambda k: (2.2 * k, 0.0)) == []
    assert planned_at(straight(replan="blocked"), told, seen, maps) == [0.6]


def test_a_blocked_path_is_planned_anew_at_a_bounded_rate():
    told, seen = stand(1, [(6.0, 0.0)], radius=0.3)
    maps = [wall(0.0, revision=k) for k in range(12)]
    navigator = straight(replan="blocked", pause=0.5, patience=99.0)
    assert planned_at(navigator, told, seen, maps) == [0.6, 1.2, 1.8]


def test_without_a_path_a_changed_map_is_asked_again():
    told, seen = stand(1, [(6.0, 0.0)])
    spec = {"type": "detour", "fails": True}
    navigator = Hierarchical(
        Hierarchical.Config(controller="path-following", planner=spec, replan="blocked")
    )
    empty = [Map(BOUNDS, ()), Map(BOUNDS, (), revision=1)]
    assert planned_at(navigator, told, seen, empty[:1] * 3 + empty[1:] * 3) == [0.6]


def test_who_is_stuck_goes_back_the_way_it_came_and_then_plans_again():
    told, seen = stand(1, [(9.0, 0.0)])
    navigator = straight(give_way=1.0, patience=0.6)
    commands, places = [], [(min(0.5 * k, 3.0), 0.0) for k in range(60)]
    navigator.reset([told], seen.rows)
    calls = []
    for k, place in enumerate(places):
        position = np.array([[place]])
        commands.append(
            navigator.act(replace(seen, time=np.array([k * 0.2]), position=position))[0, 0]
        )
        calls.append(len(navigator.planner.calls))
    forward = [bool(command[0] > 0.0) for command in commands]
    assert all(forward[:8])
    back = forward.index(False)
    assert 2.0 <= 0.2 * forward[back:].index(True) <= 6.3
    assert calls[back] == 1
    assert calls[back + forward[back:].index(True)] == 2


@pytest.mark.parametrize("replan", ["map-change", "never"])
def test_who_waits_too_long_plans_again(replan):
    """One agent walks and one stands; one that has no path needs no other on the same map."""
    told, seen = stand(2, [(9.0, 0.0), (9.0, 5.0)])
    navigator = Hierarchical(
        Hierarchical.Config(
            controller="path-following", planner="detour", replan=replan, patience=0.6, cut=1e-9
        )
    )
    navigator.reset([told], seen.rows)
    planned = []
    for k in range(24):
        position = np.array([[(0.3 * k, 0.0), (2.0, 0.001 * k)]])
        before = len(navigator.planner.calls)
        if k == 9:
            navigator.planner.config = Detour.Config(fails=True)
        navigator.act(replace(seen, time=np.array([k * 0.2]), position=position))
        for call in navigator.planner.calls[before:]:
            planned.append(round(k * 0.2, 1))
            assert call[1] == tuple(position[0, 1])
    assert planned == ([] if replan == "never" else [0.6, 1.8])


def test_a_failed_new_plan_leaves_the_old_path():
    told, seen = stand(1, [(6.0, 0.0)])
    navigator = Hierarchical(Hierarchical.Config(controller="path-following", planner="detour"))
    first = answers(navigator, [told], seen)
    navigator.planner.config = Detour.Config(fails=True)
    after = navigator.act(replace(seen, maps=(Map(BOUNDS, (), revision=1),)))
    np.testing.assert_array_equal(first, after)
    assert not navigator.plans[0][0].solved


def test_agents_that_are_done_are_not_planned_for_again():
    told, seen = stand(2, [(6.0, 0.0), (0.0, 5.0)])
    navigator = Hierarchical(Hierarchical.Config(controller="path-following", planner="detour"))
    answers(navigator, [told], seen)
    active = np.array([[False, True]])
    navigator.act(replace(seen, active=active, maps=(Map(BOUNDS, (), revision=1),)))
    assert [call[0] for call in navigator.planner.calls] == [0, 0, 1]


def test_batch_rows_and_numbering_do_not_matter():
    worlds = []
    for w in range(3):
        told, seen = one_world(w, 5)
        map = Map(BOUNDS, ())
        worlds.append((replace(told, map=map), replace(seen, maps=(map,))))
    told, seen = zip(*worlds, strict=True)

    def fresh():
        parts = {"planner": "detour", "controller": {"type": "orca", "margin": 0.02}}
        return Hierarchical(Hierarchical.Config(**parts))

    together = answers(fresh(), told, joined(seen))
    order = np.array([4, 2, 0, 1, 3])
    for w, (one, view) in enumerate(worlds):
        alone = answers(fresh(), [replace(one, rng=keyed(w))], view)
        np.testing.assert_array_equal(alone[0], together[w])
        other, shuffled = permuted(replace(one, rng=keyed(w)), view, order)
        np.testing.assert_array_equal(answers(fresh(), [other], shuffled)[0], together[w, order])


def test_a_pair_needs_and_gives_what_its_parts_need_and_give():
    spin = Hierarchical(Hierarchical.Config(planner="detour", controller="spin"))
    assert spin.required == {Need.MAP, Need.RAYS}
    assert spin.command == "twist"
    timed = Hierarchical(
        Hierarchical.Config(controller="path-following", planner={"type": "detour", "timed": True})
    )
    assert spin.reproducible
    assert not timed.reproducible
    orca = OmplOrca(OmplOrca.Config(planner="detour", orca={"time_horizon": 2.5}))
    assert orca.required == {Need.MAP, Need.NEIGHBOURS, Need.EDGES}
    assert orca.controller.config.time_horizon == 2.5
    pure = OmplPure(OmplPure.Config(planner="detour"))
    assert pure.required == {Need.MAP}


def test_a_controller_alone_needs_no_map_and_heads_for_the_goal():
    told, seen = stand(1, [(0.0, 6.0)], map=None)
    navigator = make(NAVIGATORS, "none+path-following")
    assert navigator.required == frozenset()
    command = answers(navigator, [replace(told, map=None)], replace(seen, maps=(None,)))
    np.testing.assert_allclose(command, [[(0.0, 1.0)]])


def test_parts_count_with_their_distributions_parameters_and_files():
    navigator = Hierarchical(Hierarchical.Config(planner="detour", controller="recurrent-ppo"))
    assert [part.name for part in navigator.parts] == ["detour", "recurrent-ppo"]
    assert navigator.parts[0].distribution == "registered in this process"
    assert navigator.fingerprint == navigator.controller.fingerprint != ""
    assert navigator.training == navigator.controller.training
    assert navigator.config.planner == {
        "type": "detour", "fails": False, "spread": 1.0, "timed": False,
    }  # fmt: skip


def test_wrong_parts_are_refused_by_name():
    with pytest.raises(ConfigError, match=r"^planner: .*'detour' has no parameter 'fail'.*'fails'"):
        Hierarchical(
            Hierarchical.Config(
                controller="path-following", planner={"type": "detour", "fail": True}
            )
        )
    with pytest.raises(UnknownPluginError, match="There is no controller 'orcaa'"):
        Hierarchical(Hierarchical.Config(planner="detour", controller="orcaa"))
    with pytest.raises(ConfigError, match="must be 'never', or 'map-change' or 'blocked', or"):
        make(NAVIGATORS, {"type": "detour+path-following", "replan": 3})
