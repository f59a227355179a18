import math

import numpy as np
import pytest
import shapely
from benchnav_baselines.common.disc_planner import Query, frame_of
from benchnav_baselines.common.validity_checker import PlanarChecker
from benchnav_baselines.planners.navmesh import tile_store
from benchnav_baselines.planners.navmesh.free_polygon import capsule_polygons
from benchnav_baselines.planners.navmesh.mesh import mesh_of, nearest
from benchnav_baselines.planners.navmesh.taut_search import shortest_path
from benchnav_baselines.planners.navmesh.tile import tiles_of, tiling, triangulated
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.sparse import coo_array
from scipy.sparse.csgraph import dijkstra

from benchnav.arena.solid import Kind, Solid
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
    disc,
    drawn,
    excess,
    furnished,
    plan,
    space,
)
from tests.importers.data import published
from tests.importers.test_movingai import MAPS

NAVMESH = {"type": "navmesh", "clearance": 0.0}
seeds = st.integers(0, 2**32 - 1)


def meshed(map, radius=RADIUS, segments=8):
    """The mesh of a map, without a cache."""
    query = Query(map, START, GOAL, radius, 0.0, PlanarChecker(map, radius))
    frame = tiling(frame_of(query, 1.0))
    tiles = tiles_of(map.capsules, query.inflation, segments, frame)
    return mesh_of(triangulated(tiles, query.inflation, segments), frame, map)


def triangles_of(mesh):
    """The free triangles, as shapely polygons."""
    return shapely.polygons(mesh.corner[mesh.part >= 0])


def free_of(map, radius=RADIUS, segments=8):
    """The free space in one piece: the frame without all polygons, but for the solids' inside."""
    query = Query(map, START, GOAL, radius, 0.0, PlanarChecker(map, radius))
    tiles = tiling(frame_of(query, 1.0))
    (i, j), (columns, rows), side = tiles.first, tiles.count, tiles.side
    frame = shapely.box(i * side, j * side, (i + columns) * side, (j + rows) * side)
    grown = shapely.polygons(capsule_polygons(map.capsules, query.inflation, segments))
    parts = shapely.get_parts(shapely.difference(frame, shapely.union_all(grown)))
    index = (map.capsules, *solid_index(map.solids))
    places = [part.representative_point() for part in parts]
    return [
        part for part, at in zip(parts, places, strict=True) if not inside_solid(at.x, at.y, *index)
    ]


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
def test_triangles_are_free_and_miss_only_slivers(seed):
    map = furnished(seed)
    free = shapely.union_all(triangles_of(meshed(map)))
    checker, index = PlanarChecker(map, RADIUS), (map.capsules, *solid_index(map.solids))
    # arcs around discs of up to 1 m are the widest
    loose = PlanarChecker(map, (1.0 + RADIUS) / math.cos(math.pi / 32) - 1.0 + 1e-4)
    rng = np.random.default_rng(seed)
    for x, y in rng.uniform(0.0, 20.0, (2000, 2)):
        inside = free.contains(shapely.Point(x, y))
        assert not inside or (checker.point_is_free(x, y) and not inside_solid(x, y, *index))
        assert inside or not loose.point_is_free(x, y)


# triangles and doors


def lengths_of(sides):
    return np.hypot(*(sides[:, 1] - sides[:, 0]).T).sum()


def test_triangles_cover_free_space_and_doors_join_all_of_it():
    """Sides of triangles are doors, or the boundary of free space, in all their length."""
    for map in (furnished(0), furnished(1), drawn("office/rooms")[0][0]):
        free, mesh = free_of(map), meshed(map)
        (ax, ay), (bx, by), (cx, cy) = (mesh.corner[:, k].T for k in range(3))
        area = 0.5 * ((bx - ax) * (cy - ay) - (by - ay) * (cx - ax))
        held = mesh.part >= 0
        assert area.min() > 0.0
        assert area[held].sum() == pytest.approx(sum(part.area for part in free))
        sides = np.hypot(*(np.roll(mesh.corner[held], -1, axis=1) - mesh.corner[held]).T).sum()
        from_ = np.repeat(np.arange(len(mesh.corner)), np.diff(mesh.first))
        ends = np.stack([mesh.vertex[mesh.left], mesh.vertex[mesh.right]], axis=1)
        doors = lengths_of(ends[held[from_]])
        assert sides - doors == pytest.approx(sum(part.length for part in free))


def test_doors_lead_both_ways_and_lie_on_both_triangles():
    mesh = meshed(furnished(2))
    here = np.repeat(np.arange(len(mesh.corner)), np.diff(mesh.first))
    ways = set(
        zip(here.tolist(), mesh.to.tolist(), mesh.left.tolist(), mesh.right.tolist(), strict=True)
    )
    assert {(b, a, right, left) for a, b, left, right in ways} == ways
    assert len(ways) == len(mesh.to)
    polygons = shapely.polygons(mesh.corner)
    for a, b, left, right in ways:
        line = shapely.LineString(mesh.vertex[[left, right]])
        for t in (a, b):
            assert shapely.distance(polygons[t], line.interpolate(0.5, normalized=True)) < 2e-9
        (x, y), (u, v) = mesh.corner[a].mean(axis=0), mesh.vertex[left]
        p, q = mesh.vertex[right]
        assert (u - p) * (y - q) - (v - q) * (x - p) > 0.0  # left and right seen from inside a


def test_parts_are_what_is_joined():
    mesh = meshed(arena(block(0.0, 9.0, 20.0, 1.0)))
    below, above = (nearest(mesh, -1, 10.0, y)[0] for y in (5.0, 15.0))
    inside = nearest(mesh, -1, 10.0, 9.5)
    assert mesh.part[below] != mesh.part[above]
    assert min(mesh.part[below], mesh.part[above]) >= 0
    assert inside[3] > 0.5
    assert nearest(mesh, int(mesh.part[below]), 10.0, 15.0)[2:] == pytest.approx((8.7, 6.3))


def test_the_nearest_place_is_shapelys():
    mesh = meshed(furnished(0))
    whole = shapely.union_all(triangles_of(mesh))
    for x, y in np.random.default_rng(0).uniform(-1.0, 21.0, (100, 2)):
        triangle, px, py, far = nearest(mesh, -1, x, y)
        assert far == pytest.approx(whole.distance(shapely.Point(x, y)), abs=1e-9)
        assert math.dist((x, y), (px, py)) == pytest.approx(far)
        assert shapely.Polygon(mesh.corner[triangle]).distance(shapely.Point(px, py)) < 1e-12


# the search


def length(path):
    return np.hypot(*np.diff(path, axis=0).T).sum()


def visibility_length(free, start, goal):
    """The shortest path in a polygon, over all pairs of its corners that see each other."""
    rings = [ring for part in free for ring in (part.exterior, *part.interiors)]
    corners = np.unique(np.vstack([np.array(ring.coords) for ring in rings]), axis=0)
    points = np.vstack([start, goal, corners])
    whole = shapely.buffer(shapely.union_all(free), 1e-7)
    shapely.prepare(whole)
    a, b = np.triu_indices(len(points), 1)
    lines = shapely.linestrings(np.stack([points[a], points[b]], axis=1))
    sees = shapely.covers(whole, lines)
    weight = np.hypot(*(points[a] - points[b]).T)[sees]
    graph = coo_array((weight, (a[sees], b[sees])), shape=(len(points),) * 2)
    return dijkstra(graph.tocsr(), directed=False, indices=0)[1]


@pytest.mark.parametrize("segments", [1, 3])
@pytest.mark.parametrize("seed", range(6))
def test_paths_are_the_shortest_among_the_polygons(seed, segments):
    """The slow twin tries all pairs of corners of the free space, which knows no tiles."""
    map = furnished(seed)
    mesh, free = meshed(map, segments=segments), free_of(map, segments=segments)
    rng, tried = np.random.default_rng(seed), 0
    while tried < 8:
        (sx, sy), (gx, gy) = rng.uniform(1.0, 19.0, (2, 2)).tolist()
        begin, end = nearest(mesh, -1, sx, sy), nearest(mesh, -1, gx, gy)
        if begin[3] > 0.0 or end[3] > 0.0:
            continue
        tried += 1
        path = shortest_path(mesh, sx, sy, begin[0], gx, gy, end[0], 1024)
        expected = visibility_length(free, (sx, sy), (gx, gy))
        if mesh.part[begin[0]] != mesh.part[end[0]]:
            assert len(path) == 0
            assert expected == math.inf
            continue
        assert length(path) == pytest.approx(expected, abs=1e-6)
        inside = shapely.buffer(shapely.union_all(free), 1e-7)
        assert inside.covers(shapely.LineString(path))
        assert path[0].tolist() == [sx, sy]
        assert path[-1].tolist() == [gx, gy]


@settings(max_examples=25, deadline=None)
@given(seeds)
def test_paths_on_a_lattice_of_blocks_are_the_shortest(seed):
    """Blocks on a grid: many corners in one line, on the borders of tiles, and equal paths."""
    rng = np.random.default_rng(seed)
    cells = np.argwhere(rng.random((6, 6)) < 0.35)
    blocks = [block(4.0 * i, 4.0 * j, 2.0, 2.0) for i, j in cells.tolist()]
    map = arena(*blocks, side=24.0)
    mesh, free = meshed(map, 0.5, 1), free_of(map, 0.5, 1)
    for _ in range(4):
        (sx, sy), (gx, gy) = (0.5 * rng.integers(2, 46, (2, 2))).tolist()
        begin, end = nearest(mesh, -1, sx, sy), nearest(mesh, -1, gx, gy)
        if begin[3] == 0.0 and end[3] == 0.0 and mesh.part[begin[0]] == mesh.part[end[0]]:
            path = shortest_path(mesh, sx, sy, begin[0], gx, gy, end[0], 1024)
            expected = visibility_length(free, (sx, sy), (gx, gy))
            assert length(path) == pytest.approx(expected, abs=1e-6)


def test_a_search_with_little_room_begins_again():
    posts = [disc(1.5 + k, 1.5 + m, 0.1) for k in range(18) for m in range(18)]
    mesh = meshed(arena(*posts), 0.2, 2)
    begin, end = nearest(mesh, -1, 1.0, 0.9), nearest(mesh, -1, 19.0, 19.1)
    ends = (1.0, 0.9, begin[0], 19.0, 19.1, end[0])
    little, enough = (shortest_path(mesh, *ends, room) for room in (1, 1 << 16))
    assert little.tobytes() == enough.tobytes()
    assert 25.6 < length(enough) < 27.0


# maps that change


def learned(capsules):
    """A map as mapping makes it: a solid for every capsule."""
    solids = [
        disc(x0, y0, r) if r > 0.0 else Solid(Kind.WALL, (np.array([(x0, y0), (x1, y1)]),))
        for x0, y0, x1, y1, r in capsules.tolist()
    ]
    return Map((0.0, 0.0, 40.0, 40.0), tuple(solids))


def test_a_growing_map_is_meshed_where_it_changed_and_plans_are_those_from_scratch(monkeypatch):
    meshed_tiles = []

    def counted(tiles, inflation, segments):
        meshed_tiles.append(len(tiles))
        return triangulated(tiles, inflation, segments)

    monkeypatch.setattr(tile_store, "triangulated", counted)
    rng = np.random.default_rng(0)
    low = rng.uniform(3.0, 36.0, (60, 2))
    capsules = np.column_stack([low, low + rng.uniform(-2.5, 2.5, (60, 2)), np.zeros(60)])
    capsules[::5, 2:4], capsules[::5, 4] = capsules[::5, :2], 0.4
    kept, start, goal = make(PLANNERS, NAVMESH), (1.0, 1.0), (39.0, 38.0)
    plan(kept, learned(capsules[:20]), start, goal)
    whole = meshed_tiles.pop()
    assert whole >= 25
    for count in range(21, 60):
        seen = capsules[rng.permutation(count)]  # the order of a map's solids does not matter
        found = plan(kept, learned(seen), start, goal)
        assert meshed_tiles.pop() <= 9
        scratch = plan(NAVMESH, learned(seen), start, goal)
        assert meshed_tiles.pop() >= whole
        assert found.path.tobytes() == scratch.path.tobytes()


def test_a_map_that_is_seen_again_is_not_meshed_at_all(monkeypatch):
    planner = make(PLANNERS, NAVMESH)
    first = plan(planner, furnished(0))
    monkeypatch.setattr(tile_store, "triangulated", None)
    assert plan(planner, furnished(0)).path.tobytes() == first.path.tobytes()


def test_a_store_forgets_the_tiles_that_were_not_used_for_longest():
    tiles = tiling((0.0, 0.0, 40.0, 40.0))
    capsules = np.random.default_rng(0).uniform(0.0, 40.0, (60, 5)) * [1, 1, 1, 1, 0.01]
    needed = tiles_of(capsules, 0.3, 8, tiles)
    expected = triangulated(needed, 0.3, 8)
    large, small = tile_store.TileStore(), tile_store.TileStore(10_000)
    for _ in range(2):
        for store in (large, small):
            for one, other in zip(store.triangles(needed, 0.3, 8), expected, strict=True):
                np.testing.assert_array_equal(one, other)
    assert [tile for *_, tile in large._held] == needed
    assert [tile for *_, tile in small._held] == needed[-len(small._held) :]
    assert 0 < small._bytes <= 10_000 < large._bytes
    assert large._bytes == sum(tile_store._size(*pair) for pair in large._held.items())


def test_long_maps_have_larger_tiles():
    assert tiling((-1.0, -1.0, 21.0, 21.0)).side == 8.0
    long = tiling((0.0, 0.0, 3000.0, 10.0))
    assert long.side == 64.0
    assert long.count == (47, 1)


def test_a_tile_holds_all_capsules_that_reach_it():
    rng = np.random.default_rng(1)
    low = rng.uniform(-20.0, 20.0, (50, 2))
    capsules = np.column_stack([low, low + rng.uniform(-20, 20, (50, 2)), rng.uniform(0, 1, 50)])
    tiles = tiling((-42.0, -42.0, 42.0, 42.0))
    grown = shapely.polygons(capsule_polygons(capsules, 0.3, 4))
    for side, i, j, data in tiles_of(capsules, 0.3, 4, tiles):
        held = {row.tobytes() for row in np.frombuffer(data).reshape(-1, 5)}
        square = shapely.box(side * i, side * j, side * (i + 1), side * (j + 1))
        reach = capsules[shapely.intersects(grown, square)]
        assert {row.tobytes() for row in reach} <= held


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
    assert len(meshes) == 1
    plan(planner, map, radius=0.4)
    assert len(meshes) == 2


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
