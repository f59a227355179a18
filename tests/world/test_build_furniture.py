"""Meshes and occupancy maps that stand about as furniture."""

import numpy as np
import pytest
import shapely
import yaml

from benchnav.arena.body import LawKind
from benchnav.arena.solid import Kind
from benchnav.errors import MapError, MeshError, ScenarioError
from benchnav.generation.build import build
from benchnav.navigation.tracks import granted_map
from benchnav.scenario.load import scenario_from_text
from benchnav.world.simulation import Simulation
from tests.importers.data import published
from tests.reference import clearance as slow

REST = {
    "name": "tests/furniture",
    "bounds": [-8, -8, 8, 8],
    "clock": {"dt": 0.2, "horizon": 20},
    "teams": [
        {
            "name": "walkers", "count": 2, "radius": 0.2, "max_speed": 1.5,
            "start": {"type": "region", "region": {"type": "anywhere"}},
            "goal": {"type": "region", "region": {"type": "anywhere"}, "min_distance": 4},
        }
    ],
}  # fmt: skip
CRATE = {"type": "mesh", "file": "crate.ply", "band": [0.1, 1.5]}
PIECES = {"type": "occupancy", "file": "pieces.map", "format": "movingai", "cell": 0.5}
SAMPLED = {
    "count": 2,
    "region": {"type": "anywhere", "margin": 1},
    "gap": 0.5,
    "heading": {"uniform": [0, 6]},
}
AREA = {"mesh": 2.0, "occupancy": 1.25}  # of one obstacle [m²]


@pytest.fixture
def folder(tmp_path):
    """With a crate of 2 × 1 × 1 m, and a map of a 3-cell angle and a 2-cell bar apart from it."""
    trimesh = pytest.importorskip("trimesh")
    trimesh.creation.box((2.0, 1.0, 1.0)).apply_translation((0, 0, 0.5)).export(
        tmp_path / "crate.ply"
    )
    (tmp_path / "pieces.map").write_text(
        "type octile\nheight 4\nwidth 4\nmap\n@@..\n@...\n....\n..@@\n"
    )
    return tmp_path


def scenario(folder, shape, **place):
    text = yaml.safe_dump({**REST, "static": [{"shape": shape, **place}]})
    return scenario_from_text(text, "s.yaml", folder)


def area(solid):
    return slow.solid_area(solid).area


def statics(world):
    return [solid for solid in world.solids if solid.kind == Kind.STATIC]


@pytest.mark.parametrize("shape", [CRATE, PIECES], ids=["mesh", "occupancy"])
def test_fixed_ones_stand_where_they_must(folder, shape):
    first, second = statics(build(scenario(folder, shape, at=[[0, 0], [-4, 3]]), "test", 0))
    assert area(first) == pytest.approx(AREA[shape["type"]], abs=1e-6)
    assert second.capsules[:, :2] == pytest.approx(first.capsules[:, :2] + [-4, 3], abs=1e-12)


def test_a_map_is_what_it_blocks_and_no_border(folder):
    (one,) = statics(build(scenario(folder, PIECES, at=[[1, 1]]), "test", 0))
    angle, bar = sorted(one.loops, key=len, reverse=True)
    assert {tuple(p) for p in bar} == {(2, 1), (3, 1), (3, 1.5), (2, 1.5)}
    assert {tuple(p) for p in angle} == {(1, 2), (1.5, 2), (1.5, 2.5), (2, 2.5), (2, 3), (1, 3)}
    inside = shapely.points([(1.25, 2.25), (2.5, 1.25), (2.5, 2.5), (0.5, 0.5)])
    assert shapely.contains(slow.solid_area(one), inside).tolist() == [True, True, False, False]


@pytest.mark.parametrize("shape", [CRATE, PIECES], ids=["mesh", "occupancy"])
def test_sampled_ones_keep_their_gap_and_turn(folder, shape):
    drawn = scenario(folder, shape, **SAMPLED)
    for seed in range(10):
        world = build(drawn, "test", seed)
        one, other = statics(world)
        assert area(one) == pytest.approx(AREA[shape["type"]], abs=1e-6)
        walls = [solid for solid in world.solids if solid.kind == Kind.WALL]
        assert slow.gap(one.capsules, [*walls, other]) > 0.5
        assert slow.gap(other.capsules, walls) > 0.5
        assert np.all(slow.clearances(world.agents.start, world.solids) > 0.2)
        assert np.all(slow.clearances(world.agents.goal, world.solids) > 0.2)
        edge = one.loops[0][1] - one.loops[0][0]
        assert np.abs(edge).min() > 1e-6  # aligned with no axis


@pytest.mark.parametrize("shape", [CRATE, PIECES], ids=["mesh", "occupancy"])
def test_moved_ones_are_stale_and_not_on_a_partial_map(folder, shape):
    drawn = scenario(folder, shape, moved=True, **SAMPLED)
    assert "stale" in drawn.granted_tracks
    world = build(drawn, "test", 1)
    known, stale, partial = (granted_map(world, t) for t in ("known", "stale", "partial"))
    assert [s.kind for s in partial.solids] == [Kind.WALL]
    assert not partial.meshes
    now, before = (
        [solid for solid in map.solids if solid.kind == Kind.STATIC] for map in (known, stale)
    )
    for one, other in zip(now, before, strict=True):
        assert area(one) == pytest.approx(area(other))
        way = one.capsules[:, :2] - other.capsules[:, :2]
        assert np.abs(way).max() > 0.1
        assert way == pytest.approx(np.broadcast_to(way[0], way.shape), abs=1e-9)


@pytest.mark.parametrize("shape", [CRATE, PIECES], ids=["mesh", "occupancy"])
def test_relocated_ones_jump_once_as_one(folder, shape):
    world = build(scenario(folder, shape, relocate_at=2, **SAMPLED), "test", 3)
    assert [body.law.kind for body in world.bodies] == [LawKind.RELOCATE] * 2
    simulation = Simulation([world])
    command = np.zeros((1, 2, 2))
    places = []
    for _ in range(20):
        simulation.step(command, np.zeros((1, 2), bool))
        places.append(simulation.body_position[0].copy())
    for m, body in enumerate(world.bodies):
        seen = np.unique([tuple(place[m]) for place in places], axis=0)
        assert len(seen) == 2
        assert {tuple(p) for p in seen} == {tuple(p) for p in body.law.points}
    assert simulation.revision[0] == 2


def test_an_obstacle_in_parts_stops_a_body_at_each(folder):
    """An agent that walks straight through both parts touches both."""
    spec = {**REST, "static": [{"shape": PIECES, "at": [[-1, -1]]}]}
    spec["teams"] = [
        {
            "name": "walkers", "count": 2, "radius": 0.2, "max_speed": 1.0,
            "start": {"type": "points", "points": [[-0.75, 3], [0.5, -3]]},
            "goal": {"type": "points", "points": [[-0.75, -3], [0.5, 3]]},
        }
    ]  # fmt: skip
    world = build(scenario_from_text(yaml.safe_dump(spec), "s.yaml", folder), "test", 0)
    simulation = Simulation([world])
    command = np.array([[[0.0, -1.0], [0.0, 1.0]]])
    for _ in range(30):
        simulation.step(command, np.zeros((1, 2), bool))
    assert simulation.position[0, :, 1] == pytest.approx([1.2, -1.2], abs=1e-6)


def test_files_count_and_wrong_ones_are_refused(folder):
    mesh, map = (scenario(folder, shape, at=[[0, 0]]) for shape in (CRATE, PIECES))
    before = mesh.hash, map.hash
    (folder / "pieces.map").write_text("type octile\nheight 1\nwidth 2\nmap\n..\n")
    (folder / "crate.ply").write_text("no mesh")
    assert mesh.placed_in(folder).hash != before[0]
    assert map.placed_in(folder).hash != before[1]
    with pytest.raises(MapError, match=r"pieces\.map:1: an obstacle's map must have a blocked"):
        build(map.placed_in(folder / "." / ".." / folder.name), "test", 0)
    with pytest.raises(MeshError, match=r"crate\.ply:1: the file must be a mesh"):
        build(mesh.placed_in(folder / ".." / folder.name), "test", 0)
    with pytest.raises(ScenarioError, match=r"static\[0\]\.shape\.file must name a file"):
        scenario(folder / "nowhere", CRATE, at=[[0, 0]])


def test_the_published_shelf_as_furniture():
    hull = published("meshes/aws/ShelfD_01/aws_robomaker_warehouse_ShelfD_01_collision.DAE")
    pytest.importorskip("collada")
    shape = {"type": "mesh", "file": hull.name, "band": [0.05, 0.5]}
    world = build(scenario(hull.parent, shape, moved=True, **SAMPLED), "test", 0)
    first, second = statics(world)
    assert len(first.loops) == len(second.loops) == 3  # its uprights stand apart, and move as one
    assert slow.gap(first.capsules, [second]) > 0.5
    assert len(granted_map(world, "partial").solids) == 1
    assert all(a is not b for a, b in zip(world.solids[1:], world.stale_solids[1:], strict=True))
