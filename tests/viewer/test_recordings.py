"""Recordings for 3-D viewers, read back with the libraries of their formats."""

import math

import numpy as np
import pytest
import shapely

import benchnav
from benchnav.arena.solid import Kind
from benchnav.errors import StoreError, UsageError
from benchnav.viewer.recordings.extrusion import HEIGHT, extrude
from benchnav.viewer.replay.scene import interesting
from benchnav.viewer.replay.senses import sensed
from tests.worlds import box, disc, walls

BOUNDS = (0.0, 0.0, 10.0, 10.0)


@pytest.fixture(scope="module")
def episode():
    world = benchnav.load_scenario("leaders/dynamic").world(seed=7)
    return benchnav.simulate(world, "straight-line", track="unknown")


def top_area(mesh):
    """The area of the triangles that look up."""
    corners = mesh.vertices[mesh.triangles]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return 0.5 * normal[:, 2].sum()


def volume(mesh):
    """By the divergence theorem, with the floor at z = 0 left out."""
    a, b, c = np.moveaxis(mesh.vertices[mesh.triangles], 1, 0)
    return float(np.einsum("ij,ij->", a, np.cross(b, c))) / 6.0


@pytest.mark.parametrize(
    ("solid", "area"),
    [
        (box(Kind.STATIC, 3, 4, 1, 0.5, 0.3), 2.0),
        (walls(10), 10.4**2 - 100.0),
        (disc(Kind.STATIC, 2, 2, 0.5), shapely.Point(2, 2).buffer(0.5, quad_segs=6).area),
    ],
)
def test_meshes_are_closed_prisms(solid, area):
    mesh = extrude(solid, BOUNDS)
    height = HEIGHT[solid.kind]
    assert top_area(mesh) == pytest.approx(area)
    assert volume(mesh) == pytest.approx(area * height)
    assert mesh.vertices[:, 2].min() == 0.0


def test_a_thin_wall_is_drawn():
    from benchnav.arena.solid import Solid

    thin = Solid(Kind.WALL, (np.array([[1.0, 1.0], [4.0, 1.0]]),))
    assert top_area(extrude(thin, BOUNDS)) == pytest.approx(3.0 * 0.04)


def test_an_mcap_file_holds_poses_markers_and_scans(episode, tmp_path):
    reader = pytest.importorskip("mcap.reader")
    decoder = pytest.importorskip("mcap_protobuf.decoder")
    record = episode.record
    path = episode.replay().save(tmp_path / "a.mcap")
    topics = {}
    with path.open("rb") as stream:
        opened = reader.make_reader(stream, decoder_factories=[decoder.DecoderFactory()])
        for schema, channel, message, content in opened.iter_decoded_messages():
            topics.setdefault((channel.topic, schema.name), []).append((message.log_time, content))
    poses = topics["/agents", "foxglove.PosesInFrame"]
    assert [time for time, _ in poses] == [round(t * 1e9) for t in record.times]
    for t, (_, content) in enumerate(poses):
        found = [(pose.position.x, pose.position.y) for pose in content.poses]
        assert np.array_equal(found, record.position[t])
        turned = [2 * math.atan2(p.orientation.z, p.orientation.w) for p in content.poses]
        assert np.allclose(np.exp(1j * (turned - record.heading[t])), 1.0)
    assert len(topics["/arena", "foxglove.SceneUpdate"][0][1].entities) == len(record.world.solids)
    agents = interesting(record)
    senses = sensed(record, agents)
    scans = [content for _, content in topics[f"/scan/{agents[0]}", "foxglove.LaserScan"]]
    hit = senses.kind[0, 0] != 0
    assert np.allclose(np.array(scans[0].ranges)[hit], senses.distance[0, 0][hit])
    assert np.isinf(np.array(scans[0].ranges)[~hit]).all()


def test_a_rerun_file_holds_the_scene(episode, tmp_path):
    pytest.importorskip("rerun")
    path = episode.replay().save(tmp_path / "a.rrd")
    data = path.read_bytes()
    assert data[:3] == b"RRF"  # the head of the format
    for name in (b"arena/0", b"agents", b"trails", b"charts/collision_probability"):
        assert name in data, name


@pytest.mark.parametrize("suffix", [".mcap", ".rrd"])
def test_a_recording_holds_one_episode(episode, tmp_path, suffix):
    pytest.importorskip("mcap_protobuf" if suffix == ".mcap" else "rerun")
    from benchnav.api.records.replay import Replay

    with pytest.raises(UsageError, match="one episode"):
        Replay([episode.record] * 2).save(tmp_path / f"a{suffix}")
    (file := tmp_path / "file").touch()
    with pytest.raises(StoreError, match="must be writable"):
        episode.replay().save(file / f"a{suffix}")
