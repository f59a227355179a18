"""SDF worlds, meshes, WKT geometries and pictures become scenarios."""

import numpy as np
import pytest
import shapely
import yaml
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from PIL import Image

import benchnav
from benchnav.cli.main import status
from benchnav.errors import BenchnavError, MeshError, UsageError, WorldFileError
from benchnav.generation.build import build
from benchnav.scenario.importers.plan_view import polygons
from benchnav.scenario.importers.sdf import SdfOptions, read_sdf
from benchnav.scenario.load import load_scenario
from tests.importers.data import published

WORLD = """\
<?xml version="1.0"?>
<sdf version="1.6"><world name="w">
  <include><uri>model://sun</uri></include>
  <model name="ground_plane"><link name="l"><collision name="c"><geometry>
    <plane><normal>0 0 1</normal></plane></geometry></collision></link></model>
  <model name="post"><pose>1 2 0 0 0 0</pose>
    <link name="l"><pose>0.5 0 0.5 0 0 1.5707963267948966</pose>
      <collision name="c"><pose>1 0 0 0 0 0</pose><geometry>
        <cylinder><radius>0.3</radius><length>1</length></cylinder></geometry></collision>
      <collision name="d"><geometry><box><size>2 1 1</size></box></geometry></collision>
      <collision name="roof"><pose>0 0 5 0 0 0</pose><geometry>
        <box><size>9 9 1</size></box></geometry></collision>
      <visual name="v"><geometry><box><size>8 8 8</size></box></geometry></visual>
    </link></model>
  <model name="ball"><pose>-2 0 0.5 0 0 0</pose><link name="l"><collision name="c"><geometry>
    <sphere><radius>0.5</radius></sphere></geometry></collision></link></model>
  <model name="fallen"><pose>-2 -3 0.3 0 1.5707963267948966 0</pose><link name="l">
    <collision name="c"><geometry>
    <cylinder><radius>0.3</radius><length>2</length></cylinder></geometry></collision></link></model>
  <state world_name="w"><model name="post"><pose>9 9 0 0 0 0</pose></model></state>
</world></sdf>
"""
HALL = "POLYGON ((0 0, 12 0, 12 8, 0 8, 0 0), (5 3, 7 3, 7 5, 5 5, 5 3))"
CHEAP = {"suppress_health_check": [HealthCheck.function_scoped_fixture], "deadline": None}


@pytest.fixture
def world(tmp_path):
    path = tmp_path / "yard.world"
    path.write_text(WORLD)
    return path


def sentence(error, place):
    """Assert that an error is one short line with the place."""
    assert str(error).startswith(place)
    assert "\n" not in str(error)
    assert len(str(error)) < 600


def test_poses_are_nested_and_heights_are_cut(world):
    pieces = read_sdf(world, SdfOptions()).pieces
    walls = [piece.wall for piece in pieces]
    assert walls[0] == {"shape": {"type": "disc", "radius": 0.3}, "at": [1.5, 3.0]}
    assert walls[1]["shape"] == {"type": "box", "width": 2.0, "depth": 1.0}
    assert walls[1]["at"] == [1.5, 2.0]
    assert walls[1]["heading"] == pytest.approx(np.pi / 2, abs=1e-6)
    assert walls[2]["shape"] == {"type": "disc", "radius": 0.5}
    fallen = pieces[3].area.bounds  # its plan view is a rectangle, 2 m × 0.6 m
    assert np.allclose(fallen, (-3, -3.3, -1, -2.7), atol=0.01)
    assert len(pieces) == 4
    high = read_sdf(world, SdfOptions(band=(4.6, 6.0))).pieces
    assert [piece.wall["shape"]["width"] for piece in high] == [9.0]


def test_a_world_becomes_a_scenario_that_stands_alone(world, tmp_path, capsys):
    out = tmp_path / "to" / "yard.yaml"
    assert status(["import", "sdf", str(world), "--out", str(out), "--radius", "0.3"]) == 0
    stdout, stderr = capsys.readouterr()
    assert stdout == f"{out}\n"
    assert max(map(len, stderr.splitlines())) <= 80
    world.unlink()
    drawn = build(load_scenario(out), "test", 0)
    assert len(drawn.agents) >= 2
    assert load_scenario(out).name == "sdf/yard"
    one = tmp_path / "one.yaml"
    world.write_text(WORLD)
    places = ["--start=-3,2", "--goal", "4,-3"]
    assert status(["import", "sdf", str(world), "--out", str(one), *places]) == 0
    agents = build(load_scenario(one), "test", 0).agents
    assert agents.start.tolist() == [[-3.0, 2.0]]
    assert agents.goal.tolist() == [[4.0, -3.0]]


@pytest.mark.parametrize(
    ("change", "text"),
    [
        (("<radius>0.3", "<radius>-0.3"), r"yard\.world:9: <radius> must be > 0; got '-0\.3'"),
        (("<size>2 1 1", "<size>2 1"), r"yard\.world:10: <size> must be 3 numbers"),
        (("<sphere>", "<shpere>"), r"must be XML; mismatched tag"),
        (("1 2 0 0 0 0", "1 2 nan 0 0 0"), r":6: <pose> must be 6 numbers up to 100000; got"),
        (("1 2 0 0 0 0", "1e9 2 0 0 0 0"), r":6: <pose> must be 6 numbers"),
        (("<pose>1 2", "<pose relative_to='f'>1 2"), r"relative to its parent; got the frame 'f'"),
        (("model://sun", "model://shelf"), r":3: the file 'model://shelf' must exist.*models"),
        (("model://sun", "file:///../x.dae"), r"must exist; it is not found"),
        (('<?xml version="1.0"?>', "<!DOCTYPE sdf [<!ENTITY a 'b'>]>"), "may not define a docum"),
        (("</world></sdf>", ""), r"must be XML; no element found"),
        (('<sdf version="1.6">', '<sdf version="1.6"><a>&lol;</a>'), "undefined entity"),
    ],
)
def test_a_wrong_world_is_refused_with_line_and_cure(world, change, text):
    world.write_text(world.read_text().replace(*change))
    with pytest.raises(WorldFileError, match=text):
        read_sdf(world, SdfOptions())


def test_an_include_that_includes_itself_ends(tmp_path):
    path = tmp_path / "loop" / "model.sdf"
    path.parent.mkdir()
    path.write_text("<sdf><include><uri>model://loop</uri></include></sdf>")
    with pytest.raises(WorldFileError, match="include others at most 8 deep"):
        read_sdf(path, SdfOptions())
    path.write_text("<sdf>" + "<model>" * 200)
    with pytest.raises(WorldFileError, match="nested at most 100 deep"):
        read_sdf(path, SdfOptions())


@settings(max_examples=200, **CHEAP)
@given(st.data())
def test_a_broken_world_is_refused_in_a_sentence(tmp_path, data):
    content = bytearray(WORLD.encode())
    for _ in range(data.draw(st.integers(1, 4))):
        at = data.draw(st.integers(0, len(content) - 1))
        piece = data.draw(st.sampled_from([b"", b"<", b"nan", b"-", b"1e999", b"\0", b"&x;", b" "]))
        content[at : at + data.draw(st.integers(0, 12))] = piece
    path = tmp_path / "broken.world"
    path.write_bytes(content)
    try:
        read_sdf(path, SdfOptions())
    except BenchnavError as error:
        sentence(error, f"{path}:")


@settings(max_examples=100, **CHEAP)
@given(st.data())
def test_a_broken_geometry_is_refused_in_a_sentence(tmp_path, data):
    content = bytearray(HALL.encode())
    for _ in range(data.draw(st.integers(1, 4))):
        at = data.draw(st.integers(0, len(content) - 1))
        piece = data.draw(st.sampled_from([b"", b"(", b")", b"nan", b"-", b"1e300", b"\xff", b","]))
        content[at : at + data.draw(st.integers(0, 6))] = piece
    path, out = tmp_path / "hall.wkt", tmp_path / "hall.yaml"
    path.write_bytes(content)
    try:
        benchnav.import_world(path, out, force=True, quiet=True)
    except BenchnavError as error:
        sentence(error, str(path.parent))


def test_a_walkable_area_is_free_and_its_outside_is_not(tmp_path):
    path, out = tmp_path / "hall.wkt", tmp_path / "hall.yaml"
    path.write_text(HALL)
    benchnav.import_world(path, out, quiet=True)
    world = benchnav.load_scenario(out).world(0)
    assert world.record.bounds == (0, 0, 12, 8)
    from benchnav.metrics.quantities.density import walkable_area

    free = walkable_area(world.record)
    assert free.symmetric_difference(shapely.from_wkt(HALL)).area < 0.06  # walls are 2 mm thick
    triangle = "POLYGON ((0 0, 1000 0, 500 1000, 0 0))"
    path.write_text(triangle)
    benchnav.import_world(path, out, unit=0.01, force=True, quiet=True)
    free = walkable_area(benchnav.load_scenario(out).world(0).record)
    assert free.area == pytest.approx(50, rel=1e-3)
    path.write_text("POLYGON ((0 0, 4 4, 4 0, 0 4, 0 0))")
    with pytest.raises(WorldFileError, match=r"hall\.wkt:1: polygon 1 must not cross itself; self"):
        benchnav.import_world(path, out, force=True, quiet=True)
    path.write_text("LINESTRING (0 0, 1 1)")
    with pytest.raises(WorldFileError, match="must begin with POLYGON"):
        benchnav.import_world(path, out, force=True, quiet=True)


@settings(max_examples=30, deadline=None)
@given(st.lists(st.tuples(st.floats(0.5, 9), st.floats(0.5, 9), st.floats(0.1, 2)), max_size=5))
def test_polygons_without_holes_cover_the_same_area(holes):
    area = shapely.box(0, 0, 10, 10)
    for x, y, radius in holes:
        area = shapely.difference(area, shapely.Point(x, y).buffer(radius))
    pieces = list(polygons(area))
    assert all(len(piece.area.interiors) == 0 for piece in pieces)
    assert sum(piece.area.area for piece in pieces) == pytest.approx(area.area, abs=1e-4)


def test_a_picture_becomes_a_map(tmp_path):
    grey = np.full((40, 80), 255, np.uint8)
    grey[10:20, 30:40] = 0
    path, out = tmp_path / "plan.png", tmp_path / "to" / "plan.yaml"
    Image.fromarray(grey).save(path)
    with pytest.raises(UsageError, match="Give the resolution: metres per pixel"):
        benchnav.import_world(path, out, quiet=True)
    files = benchnav.import_world(path, out, resolution=0.1, agents=3, quiet=True)
    assert [file.name for file in files] == ["plan.yaml", "plan-map.yaml", "plan.png"]
    world = benchnav.load_scenario(out).world(0).record
    assert world.bounds == (0, 0, 8, 4)
    walls = np.vstack([solid.capsules for solid in world.solids])[:, :2]
    assert {(3.0, 3.0), (4.0, 2.0)} <= set(map(tuple, walls.round(6).tolist()))
    assert yaml.safe_load(out.read_text())["title"] == "3 agents on plan.png"
    with pytest.raises(BenchnavError, match=r"all .* blocked|free"):
        benchnav.import_world(path, out, resolution=0.001, threshold=0.5, negate=True, radius=1,
                              force=True, quiet=True)  # fmt: skip


def test_a_mesh_of_another_unit_says_so(tmp_path):
    trimesh = pytest.importorskip("trimesh")
    path, out = tmp_path / "hall.stl", tmp_path / "hall.yaml"
    trimesh.creation.box((8000, 300, 2500)).export(path)
    likely = (
        r"must have the size of an arena.*8000 × 300 m large\. The unit is a millimetre \(0\.001\)"
    )
    with pytest.raises(WorldFileError, match=likely):
        benchnav.import_world(path, out, quiet=True)
    benchnav.import_world(path, out, unit=0.001, agents=2, quiet=True)
    assert len(benchnav.load_scenario(out).world(0)) == 2
    bounds = {"bounds": (20, 20, 30, 30), "force": True, "quiet": True}
    with pytest.raises(WorldFileError, match=r"must meet the arena, x = 20 to 30 m.*x = -4 to 4 m"):
        benchnav.import_world(path, out, unit=0.001, **bounds)
    with pytest.raises(WorldFileError, match=r"the obstacles fill it.*unit is a millimetre"):
        benchnav.import_world(path, out, unit=1, bounds=(-3, -3, 3, 3), force=True, quiet=True)
    with pytest.raises(MeshError, match=r"must have a part between 5\.0 m and 6\.0 m"):
        benchnav.import_world(path, out, unit=0.001, band=(5, 6), force=True, quiet=True)


def test_options_of_another_format_are_refused(world, tmp_path):
    with pytest.raises(UsageError, match="resolution does not belong to the format sdf"):
        benchnav.import_world(world, tmp_path / "a.yaml", resolution=1.0)
    with pytest.raises(UsageError, match="A start needs a goal"):
        benchnav.import_world(world, tmp_path / "a.yaml", start=(0, 0), quiet=True)
    with pytest.raises(UsageError, match=r"The goal must be free\. Got 1\.5,3, where an obstacle"):
        benchnav.import_world(world, tmp_path / "a.yaml", start=(-3, 2), goal=(1.5, 3), quiet=True)
    with pytest.raises(UsageError, match=r"must be one of sdf, mesh.*Did you mean 'sdf'"):
        benchnav.import_world(world, tmp_path / "a.yaml", format="sdff")


@pytest.mark.parametrize("format", ["sdf", "mesh", "wkt", "image"])
def test_no_folder_no_device_and_nothing_missing(tmp_path, format):
    for file in (tmp_path, tmp_path / "missing.stl", "/dev/zero"):
        with pytest.raises(BenchnavError):
            benchnav.import_world(
                file, tmp_path / "out.yaml", format=format, quiet=True,
                resolution=0.1 if format == "image" else None,
            )  # fmt: skip


@pytest.mark.parametrize("number", [0, 6, 42])
def test_published_barn_worlds_have_each_cylinder_once(number, tmp_path):
    path, out = published(f"barn/worlds/world_{number}.world"), tmp_path / "barn.yaml"
    count = path.read_text().split("<state")[0].count("<cylinder>") // 2  # collision and visual
    pieces = read_sdf(path, SdfOptions()).pieces
    assert len(pieces) == count
    assert {piece.wall["shape"]["radius"] for piece in pieces} == {0.075}
    benchnav.import_world(path, out, start=(-2, 3), goal=(-2, 13), quiet=True)
    assert len(benchnav.load_scenario(out).world(0)) == 1


def test_published_turtlebot3_world_has_its_posts_and_hexagons(tmp_path):
    pytest.importorskip("trimesh")
    pytest.importorskip("collada")
    path = published("meshes/turtlebot3/turtlebot3_world/model.sdf")
    pieces = read_sdf(path, SdfOptions()).pieces
    posts = [p.wall["at"] for p in pieces if p.wall["shape"].get("radius") == 0.15]
    assert sorted(posts) == [[x, y] for x in (-1.1, 0, 1.1) for y in (-1.1, 0, 1.1)]
    assert np.allclose(shapely.union_all([p.area for p in pieces]).bounds,
                       (-3.3, -3.4, 4.67, 3.4), atol=0.05)  # fmt: skip
    out = tmp_path / "tb3.yaml"
    benchnav.import_world(path, out, quiet=True)
    assert len(benchnav.load_scenario(out).world(0)) == 20


@pytest.mark.parametrize("name", ["ShelfD_01", "WallB_01"])
def test_published_meshes_become_scenarios(name, tmp_path):
    pytest.importorskip("collada")
    path = published(f"meshes/aws/{name}/aws_robomaker_warehouse_{name}_collision.DAE")
    files = benchnav.import_world(path, tmp_path / "to" / "hull.yaml", quiet=True)
    assert [file.name for file in files] == ["hull.yaml", path.name]
    assert len(benchnav.load_scenario(files[0]).world(0)) >= 2
