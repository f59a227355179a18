"""Planning in the unknown track, on maps that agents make of what they sense."""

from dataclasses import replace

import numpy as np
import pytest
from benchnav_baselines.controllers.orca.controller import OrcaController

from benchnav.arena.solid import Kind, Solid
from benchnav.generation.build import build
from benchnav.geometry.sweep import clearance
from benchnav.metrics.success import success
from benchnav.navigation.hierarchy.learned_map import DOT, GUESSED, way_is_free
from benchnav.navigation.hierarchy.mapping import Mapping, MappingConfig
from benchnav.navigation.map import Map
from benchnav.navigation.plugin.configure import make
from benchnav.navigation.tracks import granted_map
from benchnav.plugins import NAVIGATORS
from benchnav.runner.rollouts import rollout as runner
from benchnav.runner.rollouts.rollout import Assignment, rollout
from benchnav.scenario.catalogue import find
from benchnav.sensors.readings import Edges, Rays
from benchnav.testing.check_navigator import check_navigator
from benchnav.testing.scenes import SENSING, USUAL
from benchnav.world.simulation import Simulation
from tests.baselines.crowds import briefing, joined, one_world

PAIR = "mapping+visibility+orca"
BOUNDS = (-20.0, -20.0, 20.0, 20.0)


def run(spec, name, worlds, track="unknown"):
    """Episodes of validation worlds."""
    scenario = find(name)
    about = Assignment(scenario.identity, scenario.hash, "validation", track, "x", spec, salt="00")
    drawn = [(seed, build(scenario, "validation", seed)) for seed in worlds]
    return [episode for batch in rollout(about, drawn) for episode in batch]


@pytest.fixture
def made(monkeypatch):
    """Navigators that the runner makes."""
    kept = []

    def keeping(*told, **more):
        kept.append(make(*told, **more))
        return kept[-1]

    monkeypatch.setattr(runner, "make", keeping)
    return kept


def sampled(capsules):
    share = np.linspace(0.0, 1.0, 21)[:, None, None]
    return (capsules[:, :2] + share * (capsules[:, 2:4] - capsules[:, :2])).reshape(-1, 2)


@pytest.mark.parametrize("name", ["leaders/dynamic", "office/rooms"])
def test_only_what_stands_is_mapped_and_exactly(name, made):
    (episode,) = run(PAIR, name, [1])
    true = granted_map(episode.world, "known").capsules
    for agent in range(len(episode.world.agents)):
        held = made[0].mapping.capsules(0, agent)
        assert len(held) > 4
        line = held[held[:, 4] == 0.0]
        assert max(abs(clearance(*point, true)) for point in sampled(line)) < 1e-6
        for disc in held[held[:, 4] > 0.0]:
            assert np.abs(true - disc).max(axis=1).min() < 1e-6


def test_rays_alone_guess_near_what_stands(made):
    spec = {"type": PAIR, "mapping": {"sensors": ["rays"]}}
    (episode,) = run(spec, "leaders/dynamic", [2])
    true = granted_map(episode.world, "known").capsules
    radius, mapping = float(episode.world.agents.radius[0]), made[0].mapping
    for agent in range(4):
        held = mapping.capsules(0, agent)
        assert len(held) > 4
        assert (mapping._owner[0, agent, : len(held)] == GUESSED).all()
        assert (held[:, 4] == DOT).all()
        assert max(clearance(x, y, true) for x, y in held[:, :2]) <= 2 * radius + DOT + 1e-6


def test_a_trap_is_left_and_a_maze_crossed_without_a_map():
    for name, least in (("trap/u", 1.0), ("maze/grid", 0.9)):
        found = np.mean([success(episode) for episode in run(PAIR, name, range(3))])
        alone = np.mean([success(episode) for episode in run("orca", name, range(3))])
        assert found >= least
        assert alone < 0.3


@pytest.mark.slow
@pytest.mark.parametrize("sensors", [["rays"], ["edges"]])
def test_either_sensor_is_enough_for_a_trap(sensors):
    spec = {"type": PAIR, "mapping": {"sensors": sensors}}
    assert np.mean([success(episode) for episode in run(spec, "trap/u", range(6))]) >= 0.75


def test_a_stale_map_is_corrected():
    """Furniture moved meanwhile: what follows the old plan hits it, what looks plans again."""
    plain = run("visibility+path-following", "leaders/moved", range(20), "stale")
    mapped = run("mapping+visibility+path-following", "leaders/moved", range(20), "stale")

    def hits(episodes):
        return sum(int((e.contacts.kind == int(Kind.STATIC)).sum()) for e in episodes)

    assert hits(plain) >= 20
    assert hits(mapped) <= 0.6 * hits(plain)


def standing(simulation, row):
    """(P, 5) all that stands now."""
    place = simulation.body_position[row].copy()
    return granted_map(simulation.worlds[row], "known", place).capsules


@pytest.mark.parametrize(
    ("spec", "track", "blocked"),
    [
        ({"type": "visibility+orca", "replan": "never"}, "known", True),
        ({"type": "visibility+orca", "replan": "map-change"}, "known", False),
        ({"type": "visibility+orca", "replan": "blocked"}, "known", False),
        ({"type": "visibility+orca", "replan": "map-change"}, "stale", True),
        ({"type": PAIR, "pause": 0.0}, "stale", False),
        ({"type": PAIR, "pause": 0.0}, "unknown", False),
        ({"type": PAIR, "replan": "never"}, "unknown", True),
    ],
)
def test_nobody_goes_on_along_a_blocked_path(spec, track, blocked, monkeypatch):
    """Held against what it mapped, or else against what stands now."""
    scenario, through = find("leaders/moving-furniture"), []
    steer = OrcaController.steer

    def looking(controller, seen, guide):
        navigator = made[0]
        if controller is navigator.controller:
            for world, agent in np.argwhere(seen.active):
                row = int(seen.rows[world])
                way = navigator._tracker.rest(row, int(agent))
                if navigator.mapping is not None:
                    known = navigator.mapping.capsules(row, int(agent))
                else:
                    known = standing(simulations[0], row)
                radius = navigator._watch[row].radius[agent] - 2e-3
                if navigator.plans[row][agent].solved:
                    through.append(not way_is_free(way, radius, known))
        return steer(controller, seen, guide)

    made, simulations = [], []
    monkeypatch.setattr(runner, "make", lambda *t, **m: made.append(make(*t, **m)) or made[-1])
    monkeypatch.setattr(
        runner, "Simulation", lambda w: simulations.append(Simulation(w)) or simulations[-1]
    )
    monkeypatch.setattr(OrcaController, "steer", looking)
    drawn = [(seed, build(scenario, "validation", seed)) for seed in range(24)]
    about = Assignment(scenario.identity, scenario.hash, "validation", track, "x", spec, salt="00")
    list(rollout(about, drawn))
    assert len(through) > 1000
    assert any(through) == blocked


def view(agents=1):
    """One world, agents looking along +x, without sensors' readings."""
    _, seen = one_world(0, agents, mover=0)
    position = np.column_stack([np.zeros(agents), np.arange(agents) * 3.0])
    told = briefing(position, position + np.array([9.0, 0.0]))
    return told, replace(seen, position=position[None], neighbours=None, edges=None)


def rays(seen, distance, kind=Kind.NOTHING):
    shape = (*seen.active.shape, 1)
    return Rays(
        np.zeros(1), np.full(shape, distance), np.full(shape, int(kind), np.int8),
        np.zeros(shape), np.full(shape, np.inf), np.full(seen.active.shape, 0.3),
    )  # fmt: skip


def edge(seen, start, end):
    shape = (*seen.active.shape, 1)

    def point(p):
        return np.broadcast_to(np.array(p, float), (*shape, 2)).copy()

    way = np.subtract(end, start) / np.hypot(*np.subtract(end, start))
    flag = np.ones(shape, bool)
    one = np.ones(shape[:2], np.int64)
    return Edges(point(start), point(end), point(way), point(way), flag, flag, one)


def box(x, y):
    corner = np.array([(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)]) + np.array([x, y])
    return Solid(Kind.STATIC, (corner,))


def test_a_granted_solid_that_a_ray_goes_through_is_taken_off_the_map():
    told, seen = view()
    granted = Map(BOUNDS, (box(3.0, 0.0), box(3.0, 5.0)))
    mapping = Mapping(MappingConfig())
    mapping.reset([replace(told, map=granted)], seen.rows)
    before = mapping.map(0, 0)
    assert before.solids == granted.solids
    seen = replace(seen, maps=(granted,))
    mapping.see(replace(seen, rays=rays(seen, 2.2, Kind.STATIC)))
    assert mapping.map(0, 0) is before
    mapping.see(replace(seen, rays=rays(seen, 8.0)))
    after = mapping.map(0, 0)
    assert after.solids == granted.solids[1:]
    assert after.bounds == granted.bounds
    assert after.revision > before.revision


@pytest.mark.parametrize("kind", [Kind.AGENT, Kind.DYNAMIC, Kind.NOTHING])
def test_what_moves_is_not_mapped(kind):
    told, seen = view()
    mapping = Mapping(MappingConfig(sensors=("rays",)))
    mapping.reset([told], seen.rows)
    mapping.see(replace(seen, rays=rays(seen, 2.0, kind)))
    assert mapping.map(0, 0).solids == ()
    mapping.see(replace(seen, rays=rays(seen, 2.0, Kind.WALL)))
    (dot,) = mapping.map(0, 0).solids
    np.testing.assert_allclose(dot.center, (2.0 + told.radius[0] + DOT, 0.0))


def test_guesses_can_be_given_up_and_what_was_told_cannot():
    told, seen = view()
    mapping = Mapping(MappingConfig(sensors=("rays",)))
    mapping.reset([replace(told, map=Map(BOUNDS, (box(3.0, 5.0),)))], seen.rows)
    assert not mapping.doubt(0, 0)
    mapping.see(replace(seen, rays=rays(seen, 2.0, Kind.WALL)))
    assert len(mapping.capsules(0, 0)) == 5
    version = mapping.version(0, 0)
    assert mapping.doubt(0, 0)
    assert len(mapping.capsules(0, 0)) == 4
    assert mapping.version(0, 0) > version


def test_agents_map_for_themselves_unless_they_share():
    told, seen = view(agents=2)
    seen = replace(
        seen, active=np.array([[True, False]]), edges=edge(seen, (2.0, 1.0), (2.0, -1.0))
    )
    for share in (False, True):
        mapping = Mapping(MappingConfig(sensors=("edges",), share=share))
        mapping.reset([told], seen.rows)
        mapping.see(seen)
        assert len(mapping.capsules(0, 0)) == 1
        assert len(mapping.capsules(0, 1)) == int(share)
        assert (mapping.map(0, 0) is mapping.map(0, 1)) == share


def test_a_new_revision_of_the_granted_map_is_started_from():
    told, seen = view()
    first, second = Map(BOUNDS, (box(3.0, 0.0),)), Map(BOUNDS, (box(5.0, 1.0),), revision=1)
    mapping = Mapping(MappingConfig(sensors=("edges",)))
    mapping.reset([replace(told, map=first)], seen.rows)
    mapping.see(replace(seen, maps=(first,), edges=edge(seen, (1.0, 1.0), (1.0, -1.0))))
    assert len(mapping.map(0, 0).solids) == 2
    version = mapping.version(0, 0)
    mapping.see(replace(seen, maps=(second,), edges=edge(seen, (2.0, 1.0), (2.0, -1.0))))
    assert mapping.map(0, 0).solids[0] is second.solids[0]
    assert len(mapping.map(0, 0).solids) == 2
    assert mapping.version(0, 0) > version


def test_rows_keep_their_maps_and_grow():
    told, seen = view()
    mapping = Mapping(MappingConfig(sensors=("edges",)))
    rows = np.array([5, 1])
    mapping.reset([told, told], rows)
    two = replace(joined([seen, seen]), rows=rows)
    for k in range(40):
        lines = [edge(seen, (2.0 + k, 1.0), (2.0 + k, -1.0)), edge(seen, (1.0, 0.0), (1.0, 9.0))]
        mapping.see(replace(two, edges=joined(lines)))
    assert len(mapping.capsules(5, 0)) == 40
    assert len(mapping.capsules(1, 0)) == 1
    mapping.reset([told], np.array([5]))
    assert len(mapping.capsules(5, 0)) == 0
    assert len(mapping.capsules(1, 0)) == 1


def test_thin_rays_cannot_be_mapped_with():
    assert make(NAVIGATORS, PAIR).unfit(SENSING) == (
        "maps with thick rays, and those there are thin"
    )
    assert make(NAVIGATORS, PAIR).unfit(USUAL) == ""
    edges = {"type": PAIR, "mapping": {"sensors": ["edges"]}}
    assert make(NAVIGATORS, edges).unfit(SENSING) == ""


@pytest.mark.parametrize(
    "more", [{}, {"share": True}, {"sensors": ["rays"]}, {"sensors": ["edges"], "share": True}]
)
def test_it_is_a_navigator_as_any_other(more):
    check_navigator({"type": PAIR, "mapping": more, "give_way": 0.5, "patience": 0.4})
