import math
import sys

import numpy as np
import pytest
import shapely
from benchnav_baselines.common.disc_planner import Query, frame_of
from benchnav_baselines.common.validity_checker import PlanarChecker
from benchnav_baselines.planners.navmesh.free_polygon import capsule_polygons, free_polygons
from benchnav_baselines.planners.navmesh.funnel import pulled
from benchnav_baselines.planners.navmesh.mesh import mesh_of
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st

from benchnav.errors import MissingExtraError
from benchnav.geometry.sweep import inside_solid, solid_index
from benchnav.navigation.map import Map
from benchnav.navigation.plugin.configure import make
from benchnav.plugins import PLANNERS
from benchnav.scenario.files.occupancy import trace
from benchnav.scenario.importers import movingai
from tests.baselines.planning import (
    GOAL,
    RADIUS,
    START,
    arena,
    assert_valid,
    block,
    drawn,
    excess,
    furnished,
    plan,
    space,
)
from tests.importers.data import published
from tests.importers.test_movingai import MAPS

pytest.importorskip("networkx")
NAVMESH = {"type": "navmesh", "clearance": 0.0}
seeds = st.integers(0, 2**32 - 1)


def free_of(map, radius=RADIUS, segments=8):
    query = Query(map, START, GOAL, radius, 0.0, PlanarChecker(map, radius))
    return free_polygons(map, query.inflation, frame_of(query, 1.0), segments)


# free space


@given(seeds, st.integers(1, 20))
def test_polygons_hold_the_capsules_and_little_more(seed, segments):
    rng = np.random.default_rng(seed)
    capsules = rng.uniform(-3.0, 3.0, (4, 5))
    capsules[:, 4] = rng.uniform(0.0, 0.5, 4)
    capsules[0, 2:4] = capsules[0, :2]  # a disc
    for c, ring in zip(capsules, capsule_polygons(capsules, 0.4, segments), strict=True):
        polygon, reach = shapely.Polygon(ring), c[4] + 0.4
        line = shapely.LineString([c[:2], c[2:4]])
        assert polygon.is_valid
        assert len(ring) == 4 * segments
        assert polygon.exterior.distance(line) == pytest.approx(reach)
        corner = reach / math.cos(math.pi / (4 * segments))
        assert max(line.distance(shapely.Point(p)) for p in ring) == pytest.approx(corner)


@pytest.mark.parametrize("seed", range(3))
def test_free_polygons_are_free_and_miss_only_slivers(seed):
    map = furnished(seed)
    free = shapely.union_all(free_of(map))
    checker, index = PlanarChecker(map, RADIUS), (map.capsules, *solid_index(map.solids))
    # arcs around discs of up to 1 m are the widest
    loose = PlanarChecker(map, (1.0 + RADIUS) / math.cos(math.pi / 32) - 1.0 + 1e-4)
    rng = np.random.default_rng(seed)
    for x, y in rng.uniform(0.0, 20.0, (2000, 2)):
        inside = free.contains(shapely.Point(x, y))
        assert not inside or (checker.point_is_free(x, y) and not inside_solid(x, y, *index))
        assert inside or not loose.point_is_free(x, y)


# triangles


def test_triangles_cover_free_space_and_share_every_inner_side():
    for map in (furnished(0), furnished(1), drawn("office/rooms")[0][0]):
        free = free_of(map)
        mesh = mesh_of(free, 1.0)
        (ax, ay), (bx, by), (cx, cy) = (mesh.corner[:, k].T for k in range(3))
        area = 0.5 * ((bx - ax) * (cy - ay) - (by - ay) * (cx - ax))
        assert area.min() > 0.0
        assert area.sum() == pytest.approx(sum(part.area for part in free))
        sides = np.hypot(*(np.roll(mesh.corner, -1, axis=1) - mesh.corner).T).sum()
        inner = np.unique(mesh.portal[:, 0], axis=0)
        tail = mesh.corner[inner[:, 0], inner[:, 1]]
        head = mesh.corner[inner[:, 0], (inner[:, 1] + 1) % 3]
        shared = np.hypot(*(head - tail).T).sum()
        assert sides - 2.0 * shared == pytest.approx(sum(part.length for part in free))


def test_parts_are_what_is_joined():
    map = arena(block(0.0, 9.0, 20.0, 1.0))
    free = free_of(map)
    mesh = mesh_of(free, 1.0)
    below, above = (mesh.nearest(10.0, y)[0] for y in (5.0, 15.0))
    assert len(free) == 2
    assert mesh.part[below] != mesh.part[above]
    assert mesh.nearest(10.0, 15.0, int(mesh.part[below]))[2:] == pytest.approx((8.7, 6.3))


def test_the_nearest_place_is_shapelys():
    free = free_of(furnished(0))
    mesh, whole = mesh_of(free, 1.0), shapely.union_all(free)
    for x, y in np.random.default_rng(0).uniform(-1.0, 21.0, (100, 2)):
        triangle, px, py, far = mesh.nearest(x, y)
        assert far == pytest.approx(whole.distance(shapely.Point(x, y)), abs=1e-9)
        assert math.dist((x, y), (px, py)) == pytest.approx(far)
        assert shapely.Polygon(mesh.corner[triangle]).distance(shapely.Point(px, py)) < 1e-12


def test_places_on_a_side_are_no_farther_apart_than_asked():
    coarse, fine = (mesh_of(free_of(arena()), spacing) for spacing in (1000.0, 2.0))
    (one,) = coarse.place
    side = coarse.corner[coarse.portal[0, 0, 0]]
    assert one == pytest.approx((10.0, 10.0))
    assert np.hypot(*(side[0] - side[1])) > 19.0
    assert len(fine.place) == math.ceil(19.4 * math.sqrt(2) / 2)
    gaps = np.hypot(*np.diff(fine.place, axis=0).T)
    assert gaps.max() <= 2.0
    assert len(mesh_of(free_of(arena()), 0.01).place) == 16


# the string


def corridor(rng, count):
    """(start, goal, doors): portals along a way that bends, each wholly before the next."""
    heading, at, doors = 0.0, np.zeros(2), []
    left = right = None
    for _ in range(count):
        turn = rng.uniform(-0.6, 0.6)
        heading += turn
        ahead = np.array([math.cos(heading), math.sin(heading)])
        side = np.array([-ahead[1], ahead[0]])
        left, right = at + rng.uniform(0.1, 1.5) * side, at - rng.uniform(0.1, 1.5) * side
        doors.append((left, right))
        at = at + 4.0 * ahead
    begin = doors[0][0] + rng.uniform() * (doors[0][1] - doors[0][0]) - np.array([2.0, 0.0])
    return begin, at, np.array(doors)


def shortest(start, goal, doors):
    """The shortest way through doors, over all their ends: a motion must pass each between."""
    points = [(-1, start), *((k, p) for k, pair in enumerate(doors) for p in pair)]
    points.append((len(doors), goal))

    def passes(k, p, m, q):
        line = shapely.LineString([p, q])
        return all(line.distance(shapely.LineString(door)) < 1e-9 for door in doors[k + 1 : m])

    best = [0.0] + [math.inf] * (len(points) - 1)
    for b, (m, q) in enumerate(points):
        for a, (k, p) in enumerate(points[:b]):
            if k < m and best[a] + math.dist(p, q) < best[b] and passes(k, p, m, q):
                best[b] = best[a] + math.dist(p, q)
    return best[-1]


def length(path):
    return np.hypot(*np.diff(path, axis=0).T).sum()


@settings(max_examples=50)
@given(seeds, st.integers(1, 6))
def test_a_pulled_string_is_as_short_as_its_slow_twin(seed, count):
    start, goal, doors = corridor(np.random.default_rng(seed), count)
    path = pulled(start, goal, doors)
    assert path[0] == pytest.approx(start)
    assert path[-1] == pytest.approx(goal)
    assert length(path) == pytest.approx(shortest(start, goal, doors))


@settings(max_examples=50, suppress_health_check=list(HealthCheck))
@given(seeds, st.integers(3, 9), st.sampled_from(["inside", "on a side", "at a corner"]))
def test_a_string_through_a_strip_of_triangles_is_taut(seed, count, where):
    """Portals that share ends, as in a mesh, and a start that lies on the first of them."""
    rng = np.random.default_rng(seed)
    x = np.cumsum(rng.uniform(0.3, 1.5, count))
    lower = np.column_stack([x, np.cumsum(rng.uniform(-1, 1, count))])
    upper = lower + np.column_stack([rng.uniform(-0.2, 0.2, count), rng.uniform(0.2, 3, count)])
    ends, doors = [upper[0], lower[0]], [(upper[0], lower[0])]
    for k in range(1, count):
        first = int(rng.integers(2))
        for side in (first, 1 - first):
            corner = (upper, lower)[side][k]
            (ax, ay), (bx, by) = ends[0] - ends[1], corner - ends[1]
            assume(ax * by - ay * bx < -1e-3)  # it lies beyond: no triangle is turned over
            ends[side] = corner
            doors.append(tuple(ends))
    share = {"inside": 0.5, "on a side": rng.uniform(0.1, 0.9), "at a corner": 1.0}[where]
    start = upper[0] + share * (lower[0] - upper[0])
    start = start - np.array([0.1, 0.0]) if where == "inside" else start
    goal = 0.5 * (upper[-1] + lower[-1])
    doors = np.array(doors)
    assert length(pulled(start, goal, doors)) == pytest.approx(shortest(start, goal, doors))


def test_a_start_on_a_portal_does_not_slip_to_its_end():
    """Left, start and right in one line: rounding may not say that right crosses left."""
    doors = [[(24.03, 22.7), (24.97, 22.3)], [(24.97, 22.7), (24.97, 22.3)]]
    path = pulled(np.array([24.5, 22.5]), np.array([26.0, 22.5]), np.array(doors))
    assert length(path) == pytest.approx(1.5)


# paths


@pytest.mark.parametrize(
    ("scenario", "mean", "worst"),
    [
        ("leaders/static", 0.005, 0.03),
        ("maze/grid", 0.005, 0.03),
        ("office/rooms", 0.006, 0.05),
        ("trap/u", 0.005, 0.01),
    ],
)
def test_paths_in_drawn_worlds_are_near_the_shortest(scenario, mean, worst):
    over = [excess(plan(NAVMESH, *query), *query[:4]) for query in drawn(scenario)]
    assert np.mean(over) < mean
    assert np.max(over) < worst


def test_more_places_on_a_side_find_better_rows_of_triangles():
    over = {}
    for spacing in (1000.0, 0.5):
        queries = drawn("leaders/static", 6)
        spec = {**NAVMESH, "spacing": spacing}
        over[spacing] = np.mean([excess(plan(spec, *q), *q[:4]) for q in queries])
    assert over[0.5] < 0.5 * over[1000.0]


def test_more_segments_keep_nearer_to_arcs():
    map = arena(block(8.0, 8.0, 4.0, 4.0))
    over = [excess(plan({**NAVMESH, "segments": n}, map), map) for n in (1, 4, 32)]
    assert 1e-6 < over[2] < over[1] < over[0]
    assert over[2] < 1e-4


def test_agents_of_one_radius_share_a_mesh_and_others_do_not():
    planner, map = make(PLANNERS, NAVMESH), furnished(0)
    for start, goal in ((START, GOAL), (GOAL, START)):
        plan(planner, map, start, goal)
    (meshes,) = planner._meshes.values()
    (mesh,) = meshes.values()
    assert mesh.graph.number_of_nodes() == len(mesh.place)
    plan(planner, map, radius=0.4)
    assert len(meshes) == 2


def test_without_the_extra_it_says_what_to_install(monkeypatch):
    monkeypatch.setitem(sys.modules, "networkx", None)
    with pytest.raises(MissingExtraError, match=r"benchnav\[plan\]"):
        plan(NAVMESH, furnished(0))


# what others say


@pytest.mark.parametrize(
    "name",
    [pytest.param(n, marks=[] if n == "room-32-32-4" else [pytest.mark.slow]) for n in MAPS],
)
def test_paths_on_published_maps_are_free_and_near_the_shortest(name):
    path = published(f"movingai/{name}.map")
    occupancy = movingai.read_map(path)
    queries = movingai.read_scen(published(f"movingai/{MAPS[name]}"), path, occupancy)
    map, planners = Map(occupancy.bounds, trace(occupancy)), {}
    for other in ("navmesh", "visibility", "grid.theta-star"):
        planners[other] = make(PLANNERS, {"type": other, "clearance": 0.0})
    over = []
    for k in range(0, min(200, len(queries.length)), 25):
        start, goal = (occupancy.centres(*end[k]) for end in (queries.start, queries.goal))
        for other, planner in planners.items():
            found = plan(planner, map, start, goal, tolerance=0.0)
            assert_valid(found, map, start, goal, tolerance=0.0)
            if other == "navmesh" and found.length:
                over.append(excess(found, map, start, goal))
    assert -1e-5 < np.min(over) < np.mean(over) < 0.02


def test_paths_are_not_longer_than_those_of_jupedsim():
    """Its RoutingEngine: triangles, midpoints and a funnel too, in the same free polygon.

    Version 1.4.2 keeps away from corners, and leaves the polygon in some offices.
    """
    jupedsim = pytest.importorskip("jupedsim", reason="jupedsim is not installed")
    ours, theirs = [], []
    for name in ("maze/grid", "leaders/static", "trap/u", "office/rooms"):
        for map, start, goal, radius, _ in drawn(name):
            free = shapely.union_all(free_of(map, radius))
            assert free.geom_type == "Polygon"
            if not free.contains(shapely.MultiPoint([start, goal])):
                continue  # an end beside the polygon is none for it
            way = np.array(
                jupedsim.RoutingEngine(free).compute_waypoints(tuple(start), tuple(goal))
            )
            if shapely.LineString(way).difference(free.buffer(1e-6)).length > 0.0:
                assert name == "office/rooms"
                continue
            theirs.append(length(way))
            ours.append(plan(NAVMESH, map, start, goal, radius, 0.0).length)
            exact = space(map, radius).length(start, goal)
            assert exact * (1.0 - 1e-5) <= theirs[-1] <= 1.2 * exact
    assert len(ours) >= 24
    assert np.all(np.array(ours) <= 1.01 * np.array(theirs))
    assert np.sum(ours) < np.sum(theirs)
