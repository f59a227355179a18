"""Sensors against slow twins built on shapely, and what must hold of them."""

import math
from dataclasses import replace

import numpy as np
import pytest
import shapely

from benchnav.arena.body import Body, still
from benchnav.arena.sensing import EdgeSensor, NeighbourSensor, RaySensor, Sensing
from benchnav.arena.solid import Kind
from benchnav.navigation.navigator import Need
from benchnav.sensors.nearest import (
    CHAIN,
    LANES,
    SLOTS,
    put_into_lane,
    sort_lanes,
    take_from_lane,
)
from benchnav.sensors.sense import ray_angles, sense
from benchnav.world.simulation import Simulation
from tests.worlds import agents, back_and_forth, box, disc, random_world, walls, world

ALL = frozenset({Need.RAYS, Need.NEIGHBOURS, Need.EDGES})


def everybody(simulation):
    index = np.tile(np.arange(simulation.A), (simulation.B, 1))
    return np.where(simulation.present, index, -1)


def outline(solid, offset=(0.0, 0.0)):
    """The boundary of a solid as shapely lines, or its disc."""
    if solid.is_disc:
        return shapely.Point(np.add(solid.center, offset)).buffer(solid.radius, 512)
    return shapely.MultiLineString(
        [shapely.LinearRing(loop + offset).coords for loop in solid.loops]
    )


def things(simulation, b=0):
    """(kind, index, shape) of everything solid in world b, at its place."""
    drawn = simulation.worlds[b]
    for k, solid in enumerate(drawn.solids):
        yield int(solid.kind), k, outline(solid)
    for m, body in enumerate(drawn.bodies):
        yield int(body.solid.kind), m, outline(body.solid, simulation.body_position[b, m])


def slow_ray(simulation, i, angle, sensor):
    """March the ray in 2 mm steps, then bisect: (distance, kind)."""
    a = simulation.agents[0, i]
    own = float(a["radius"]) if sensor.thick else 0.0
    d = np.array([math.cos(a["heading"] + angle), math.sin(a["heading"] + angle)])
    p = simulation.position[0, i]
    shapes = [(kind, shape) for kind, _, shape in things(simulation)]
    for j in np.flatnonzero(simulation.present[0]):
        if j != i:
            body = shapely.Point(simulation.position[0, j]).buffer(0.5, 512)
            shapes.append((int(Kind.AGENT), body))
    best = (sensor.range, int(Kind.NOTHING))
    far = shapely.LineString([p, p + sensor.range * d])
    for kind, shape in shapes:
        if shape.distance(far) > own:
            continue
        marks = np.linspace(0.0, sensor.range, int(sensor.range / 0.002) + 1)
        gaps = shapely.distance(shapely.points(p + marks[:, None] * d), shape) - own
        inside = np.flatnonzero(gaps <= 0.0)
        if own == 0.0:
            hit = shape.distance(shapely.Point(p)) if shape.geom_type == "Polygon" else None
            crossing = shape.boundary if shape.geom_type == "Polygon" else shape
            met = crossing.intersection(far)
            if met.is_empty or hit == 0.0:
                continue
            distance = met.distance(shapely.Point(p))
        elif len(inside) == 0:
            continue
        else:
            low, high = marks[max(inside[0] - 1, 0)], marks[inside[0]]
            for _ in range(40):
                middle = 0.5 * (low + high)
                touching = shape.distance(shapely.Point(p + middle * d)) <= own
                low, high = (low, middle) if touching else (middle, high)
            distance = high
        best = min(best, (distance, kind))
    return best


@pytest.mark.parametrize("thick", [True, False])
@pytest.mark.parametrize("seed", range(3))
def test_rays_agree_with_marching(seed, thick):
    sensor = RaySensor(9, 2.0 * math.pi, 8.0, thick)
    drawn = random_world(seed, sensing=Sensing(sensor, None, None))
    simulation = Simulation([drawn])
    rays, _, _ = sense(simulation, everybody(simulation), ALL)
    for i in range(4):
        for r, angle in enumerate(rays.angle):
            distance, kind = slow_ray(simulation, i, angle, sensor)
            assert rays.distance[0, i, r] == pytest.approx(distance, abs=2e-3)
            if abs(distance - sensor.range) > 2e-3:
                assert rays.kind[0, i, r] == kind


@pytest.mark.parametrize("seed", range(4))
def test_rays_ahead_hit_the_same_as_within_a_full_turn(seed):
    """Objects behind the agent are skipped only if no ray leads there."""
    drawn, rays = random_world(seed), []
    for count, fan in ((9, math.pi), (16, 2.0 * math.pi)):
        sensing = Sensing(RaySensor(count, fan, 8.0, True), None, None)
        simulation = Simulation([replace(drawn, sensing=sensing)])
        rays.append(sense(simulation, everybody(simulation), ALL)[0])
    ahead, around = rays
    np.testing.assert_allclose(ahead.angle, around.angle[4:13], atol=1e-12)
    np.testing.assert_allclose(ahead.distance, around.distance[..., 4:13], atol=1e-9)
    assert (ahead.kind == around.kind[..., 4:13]).all()


def test_what_a_thick_ray_meets_is_what_the_body_meets():
    """Driving along the ray, the body is stopped where the ray ended."""
    compared = 0
    for seed in range(30):
        still_world = random_world(seed, count=1, unicycle=False)
        drawn = world(still_world.agents, still_world.solids)
        simulation = Simulation([drawn])
        rays, _, _ = sense(simulation, everybody(simulation), ALL)
        heading = simulation.heading[0, 0]
        middle = len(rays.angle) // 2
        if rays.kind[0, 0, middle] == Kind.NOTHING or np.isfinite(rays.goal[0, 0, middle]):
            continue
        way = 2.0 * np.array([math.cos(heading), math.sin(heading)])
        while len(simulation.contacts(0)) == 0:
            simulation.step(way[None, None], np.zeros((1, 1), bool))
        time = simulation.contacts(0).start[0]
        assert 2.0 * time == pytest.approx(rays.distance[0, 0, middle], abs=1e-6)
        assert simulation.contacts(0).kind[0] == rays.kind[0, 0, middle]
        compared += 1
    assert compared >= 10


def test_the_goal_is_on_a_layer_of_its_own():
    crew = agents([5.0, 5.0], [9.0, 5.0], radius=0.5)
    post = disc(Kind.STATIC, 7.0, 5.0, 0.2)
    free, hidden = Simulation([world(crew)]), Simulation([world(crew, [post])])
    ahead = 3
    rays, _, _ = sense(free, everybody(free), ALL)
    assert rays.kind[0, 0, ahead] == Kind.NOTHING
    assert rays.goal[0, 0, ahead] == pytest.approx(4.0 - 0.5 - 0.3)
    assert np.isinf(rays.goal[0, 0, 0])
    rays, _, _ = sense(hidden, everybody(hidden), ALL)
    assert np.isinf(rays.goal[0, 0, ahead])


def test_a_mover_tells_how_fast_it_approaches():
    mover = back_and_forth(box(Kind.DYNAMIC, 0, 0, 0.5, 0.5), [12, 5], [5, 5], 1.5)
    simulation = Simulation([world(agents([6.0, 5.0], [1.0, 1.0]), bodies=[mover])])
    rays, seen, _ = sense(simulation, everybody(simulation), ALL)
    assert rays.kind[0, 0, 3] == Kind.DYNAMIC
    assert rays.approach[0, 0, 3] == pytest.approx(1.5)
    assert rays.distance[0, 0, 3] == pytest.approx(5.0)
    assert seen.kind[0, 0, 0] == Kind.DYNAMIC
    assert seen.radius[0, 0, 0] == pytest.approx(math.sqrt(0.5))
    np.testing.assert_allclose(seen.velocity[0, 0, 0], [-1.5, 0.0])


def test_a_mover_tells_how_fast_it_crosses():
    mover = back_and_forth(box(Kind.DYNAMIC, 0, 0, 0.5, 0.5), [10, 4.8], [10, 9], 1.5)
    crew = agents([6.0, 5.0], [1.0, 1.0])
    simulation = Simulation([world(crew, bodies=[mover])])
    rays, _, _ = sense(simulation, everybody(simulation), ALL)
    assert rays.kind[0, 0, 3] == Kind.DYNAMIC
    assert rays.approach[0, 0, 3] == pytest.approx(0.0, abs=1e-9)
    assert rays.across[0, 0, 3] == pytest.approx(1.5)  # to the left of the ray
    assert (rays.across[0, 0, rays.kind[0, 0] != Kind.DYNAMIC] == 0.0).all()


@pytest.mark.parametrize("seed", range(4))
def test_neighbours_agree_with_sorting_everybody(seed):
    """Range, count, order and lines of sight, in a world of few and in a crowd."""
    sensing = Sensing(None, NeighbourSensor(5, 7.0), None)
    for count in (6, 40):
        solids = random_world(seed).solids
        rng = np.random.default_rng(seed)
        crew = agents(rng.uniform(1, 19, (count, 2)), rng.uniform(1, 19, (count, 2)), radius=0.05)
        simulation = Simulation([world(crew, solids, random_world(seed).bodies, sensing=sensing)])
        _, seen, _ = sense(simulation, everybody(simulation), ALL)
        for i in range(count):
            expected = slow_neighbours(simulation, i, 5, 7.0)
            assert seen.count[0, i] == len(expected)
            for k, (position, kind) in enumerate(expected):
                np.testing.assert_allclose(seen.position[0, i, k], position)
                assert seen.kind[0, i, k] == kind


def slow_neighbours(simulation, i, most, limit):
    p, found = simulation.position[0, i], []
    shapes = list(things(simulation))
    others = [j for j in range(simulation.A) if j != i]
    found += [(simulation.position[0, j], Kind.AGENT, None) for j in others]
    found += [(simulation.body_position[0, m], Kind.DYNAMIC, m) for m in range(simulation.M)]
    visible = []
    for q, kind, m in found:
        line = shapely.LineString([p, q])
        blocked = any(
            shape.intersects(line)
            for what, index, shape in shapes
            if not (what == Kind.DYNAMIC and index == m)
        )
        if np.hypot(*(q - p)) <= limit and not blocked:
            visible.append((np.hypot(*(q - p)), q, kind))
    visible.sort(key=lambda item: item[0])
    return [(q, kind) for _, q, kind in visible[:most]]


def test_where_the_search_starts_changes_no_neighbour():
    """Agents at one place, equal distances and searches that start too near or too far."""
    rng = np.random.default_rng(1)
    start = rng.integers(1, 19, (400, 2)).astype(float)
    sensing = Sensing(None, NeighbourSensor(7, 6.0), None)
    simulation = Simulation([world(agents(start, start), [], sensing=sensing)])
    seen = []
    for hint in (0.0, 1e-9, rng.uniform(0.0, 9.0, (1, 400)), 100.0, None):
        if hint is not None:
            simulation.near[:] = hint
        seen.append(sense(simulation, everybody(simulation), ALL)[1])
    for name in ("position", "velocity", "radius", "kind", "count"):
        assert len({getattr(one, name).tobytes() for one in seen}) == 1, name
    for i in range(0, 400, 7):
        d2 = ((np.delete(start, i, axis=0) - start[i]) ** 2).sum(axis=1)
        expected = np.sort(d2[d2 <= 36.0])[:7]
        found = ((seen[0].position[0, i, : len(expected)] - start[i]) ** 2).sum(axis=1)
        assert found.tolist() == expected.tolist()
        assert seen[0].count[0, i] == len(expected)


def test_neighbours_at_nearly_equal_distances_are_in_order():
    """More candidates than slots, and distances that differ in their last bits only."""
    rng = np.random.default_rng(2)
    turn = rng.uniform(0.0, 2.0 * math.pi, 1400)
    ring = np.stack([np.cos(turn), np.sin(turn)], axis=1) * rng.choice([2.0, 3.0], (1400, 1))
    start = np.concatenate([[[0.0, 0.0]], ring]) + 10.0
    for count in (4, 10, 12):
        sensing = Sensing(None, NeighbourSensor(count, 3.5), None)
        for few in (start, start[:300]):
            simulation = Simulation([world(agents(few, few), [], sensing=sensing)])
            for _ in range(2):  # the second search starts where the first one ended
                seen = sense(simulation, everybody(simulation), ALL)[1]
                for i in (0, 1, 7):
                    d2 = (few[:, 0] - few[i, 0]) ** 2 + (few[:, 1] - few[i, 1]) ** 2
                    d2[i] = math.inf
                    nearest = np.lexsort((np.arange(len(few)), d2))[:count]
                    assert seen.position[0, i].tolist() == few[nearest].tolist()


def test_ignored_teams_are_not_sensed():
    crew = agents([[5, 5], [7, 5]], [[9, 9], [1, 1]], team=[0, 1])
    sees = [[True, False], [True, True]]
    simulation = Simulation([world(crew, sees=sees)])
    rays, seen, _ = sense(simulation, everybody(simulation), ALL)
    assert seen.count[0].tolist() == [0, 1]
    assert Kind.AGENT not in rays.kind[0, 0]


def test_edges_face_the_agent_and_are_sorted():
    simulation = Simulation([random_world(5)])
    _, _, edges = sense(simulation, everybody(simulation), ALL)
    assert edges.count.min() > 0
    for i in range(4):
        p, gaps = simulation.position[0, i], []
        for k in range(edges.count[0, i]):
            a, b = edges.start[0, i, k], edges.end[0, i, k]
            d = b - a
            assert d[0] * (p[1] - a[1]) - d[1] * (p[0] - a[0]) < 0  # the agent is to its right
            gaps.append(shapely.LineString([a, b]).distance(shapely.Point(p)))
        assert gaps == sorted(gaps)
        assert gaps[-1] <= 8.0


def test_edges_behind_a_wall_are_not_seen():
    wall = box(Kind.WALL, 10.0, 10.0, 0.1, 9.0)
    beyond = box(Kind.STATIC, 12.0, 10.0, 0.5, 0.5)
    crew = agents([8.0, 10.0], [1.0, 1.0])
    for occlusion in (True, False):
        sensing = Sensing(None, None, EdgeSensor(16, 8.0), occlusion)
        simulation = Simulation([world(crew, [wall, beyond], sensing=sensing)])
        _, _, edges = sense(simulation, everybody(simulation), ALL)
        xs = edges.start[0, 0, : edges.count[0, 0], 0]
        assert (xs > 11.0).any() == (not occlusion)


def test_an_edge_knows_its_corners():
    """An L of six corners: five convex, one reflex; seen from the reflex corner's side."""
    loop = np.array([[0, 0], [6, 0], [6, 2], [2, 2], [2, 6], [0, 6.0]]) + 5.0
    corner = box(Kind.WALL, 0, 0, 1, 1)
    solid = type(corner)(Kind.WALL, (loop,))
    simulation = Simulation([world(agents([10.0, 10.0], [1, 1]), [solid])])
    _, _, edges = sense(simulation, everybody(simulation), ALL)
    found = {tuple(edges.start[0, 0, k]): k for k in range(edges.count[0, 0])}
    k = found[11.0, 7.0]  # runs from (11, 7) to the reflex corner (7, 7)
    np.testing.assert_allclose(edges.end[0, 0, k], [7.0, 7.0])
    assert edges.start_convex[0, 0, k]
    assert not edges.end_convex[0, 0, k]
    np.testing.assert_allclose(edges.before[0, 0, k], [0.0, 1.0])
    np.testing.assert_allclose(edges.after[0, 0, k], [0.0, 1.0])


def test_a_disc_is_seen_as_its_octagon():
    simulation = Simulation([world(agents([5, 5], [1, 1]), [disc(Kind.STATIC, 8, 5, 1.0)])])
    _, _, edges = sense(simulation, everybody(simulation), ALL)
    assert 1 <= edges.count[0, 0] <= 4
    d = edges.end[0, 0, 0] - edges.start[0, 0, 0]
    np.testing.assert_allclose(d, [0.0, -2 * math.tan(math.pi / 8)], atol=1e-12)
    assert edges.start[0, 0, 0, 0] == pytest.approx(7.0)


def test_a_replaced_static_obstacle_has_edges_and_a_mover_has_none():
    shelf = Body(box(Kind.STATIC, 0, 0, 1, 1), still([8.0, 5.0]))
    mover = Body(box(Kind.DYNAMIC, 0, 0, 1, 1), still([5.0, 8.0]))
    simulation = Simulation([world(agents([5, 5], [1, 1]), bodies=[shelf, mover])])
    _, seen, edges = sense(simulation, everybody(simulation), ALL)
    assert edges.count[0, 0] == 1
    assert edges.start[0, 0, 0, 0] == pytest.approx(7.0)
    assert seen.count[0, 0] == 1


def test_sensing_is_the_same_in_any_batch_and_for_any_choice():
    worlds = [random_world(seed) for seed in range(6)]
    together = Simulation(worlds)
    chosen = everybody(together)
    chosen[:, 1] = -1
    batch = sense(together, chosen, ALL)
    for b, drawn in enumerate(worlds):
        alone = Simulation([drawn])
        single = sense(alone, everybody(alone), ALL)
        for whole, part in zip(batch, single, strict=True):
            for name in whole.__dataclass_fields__:
                if name != "angle":
                    mine, its = getattr(whole, name)[b], getattr(part, name)[0]
                    for i in (0, 2, 3):
                        assert mine[i].tobytes() == its[i].tobytes()
    assert (batch[1].count[:, 1] == 0).all()


def test_large_worlds_use_the_grid_and_agree():
    """More than 64 capsules: rays and lines of sight walk the grid."""
    rng = np.random.default_rng(0)
    posts = [disc(Kind.STATIC, *p, 0.2) for p in rng.uniform(1, 19, (120, 2))]
    start = np.array(
        [
            p
            for p in rng.uniform(1, 19, (60, 2))
            if all(np.hypot(*(p - post.center)) > 0.8 for post in posts)
        ][:4]
    )
    sensor = RaySensor(9, 2.0 * math.pi, 8.0, thick=True)
    sensing = Sensing(sensor, NeighbourSensor(5, 12.0), EdgeSensor(12, 6.0))
    crew = agents(start, start + 1.0)
    simulation = Simulation([world(crew, [walls(20.0), *posts], sensing=sensing)])
    rays, seen, edges = sense(simulation, everybody(simulation), ALL)
    for i in range(len(start)):
        for r, angle in enumerate(rays.angle):
            distance, kind = slow_ray(simulation, i, angle, sensor)
            assert rays.distance[0, i, r] == pytest.approx(distance, abs=2e-3)
            assert rays.kind[0, i, r] == kind
        assert seen.count[0, i] == len(slow_neighbours(simulation, i, 5, 12.0))
    few = [posts[k] for k in np.argsort([np.hypot(*(start[0] - p.center)) for p in posts])[:60]]
    some = Simulation([world(crew, [walls(20.0), *few], sensing=sensing)])  # 64 capsules: no grid
    _, _, slow = sense(some, everybody(some), ALL)
    assert slow.count[0, 0] > 3
    np.testing.assert_allclose(edges.start[0, 0, :4], slow.start[0, 0, :4])


def test_ray_angles():
    np.testing.assert_allclose(ray_angles(RaySensor(3, 2.0, 1.0, True)), [-1.0, 0.0, 1.0])
    np.testing.assert_allclose(ray_angles(RaySensor(1, 2.0, 1.0, True)), [0.0])
    whole = ray_angles(RaySensor(4, 2 * math.pi, 1.0, True))
    np.testing.assert_allclose(np.diff(whole), math.pi / 2)


def test_lanes_are_sorted_as_by_numpy():
    """Each lane of the chain gives its smallest numbers in order; nearly equal ones are noticed."""
    rng = np.random.default_rng(6)
    for n in (0, 1, 9, 11, 40, SLOTS):
        distance = rng.random((LANES, n))
        if n > 9:
            distance[3, 1] = distance[3, 0]
        given = np.full(SLOTS * LANES, math.inf)
        smallest = np.empty((CHAIN + 1) * LANES)
        place, ranked = 7 * np.arange(SLOTS), np.empty(CHAIN, np.int64)
        for lane in range(LANES):
            put_into_lane(n, lane, distance[lane].view(np.int64), given.view(np.int64))
        sort_lanes(n, given, smallest)
        for lane in range(LANES):
            order = np.argsort(distance[lane])
            distinct = take_from_lane(n, 10, lane, smallest.view(np.int64), place, ranked)
            near_ends = n > 9 and lane == 3 and min(np.flatnonzero(order < 2)) < 10
            assert distinct != near_ends
            if distinct:
                assert ranked[: min(n, 10)].tolist() == (7 * order[:10]).tolist()


def test_rows_of_agents_and_readings_of_padding():
    """Agents that are not chosen have row -1; padding and absent agents read nothing."""
    rng = np.random.default_rng(7)
    start = rng.uniform(1, 19, (60, 2))
    simulation = Simulation([world(agents(start, start), [])] * 2)
    simulation.present[0, 5] = False
    chosen = np.array([[3, -1, 5, 40], [59, 5, -1, 0]])
    seen = sense(simulation, chosen, ALL)[1]
    everyone = sense(simulation, everybody(simulation), ALL)[1]
    for b, k in np.ndindex(chosen.shape):
        i = chosen[b, k]
        if i < 0 or not simulation.present[b, i]:
            assert seen.count[b, k] == 0
            assert not seen.position[b, k].any()
            assert not seen.radius[b, k].any()
        else:
            assert seen.count[b, k] == everyone.count[b, i]
            assert seen.position[b, k].tolist() == everyone.position[b, i].tolist()
