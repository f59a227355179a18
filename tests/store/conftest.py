"""Worlds and episodes with all that a store must keep, drawn at random."""

import dataclasses
from pathlib import Path

import numpy as np
import pyarrow as pa
import pytest

from benchnav.arena.agents import Agents
from benchnav.arena.body import Body, Law, LawKind
from benchnav.arena.mesh import Mesh
from benchnav.arena.sensing import EdgeSensor, NeighbourSensor, RaySensor, Sensing
from benchnav.arena.solid import Kind, Solid
from benchnav.arena.world import Afterwards, Charge, Clock, ContactRule, Rules, World
from benchnav.episode.episode import Contacts, Episode, Identity, Timings
from benchnav.store.parts.digest import digest
from benchnav.store.parts.results import RESULTS
from benchnav.store.runs.manifest import Manifest
from benchnav.store.runs.navigator_hash import hash_of_entry

ORCA = {"label": "orca", "config": {"type": "orca"}, "source": "benchnav"}
HASH = hash_of_entry(ORCA)


def make_world(rng, agents=3, bodies=2):
    def f8(*shape):
        return rng.normal(size=shape) * 10.0 ** rng.integers(-9, 9)

    def i1(high):
        return rng.integers(0, high, agents).astype(np.int8)

    wall = Solid(Kind.WALL, (f8(4, 2), f8(3, 2)))
    disc = Solid(Kind.STATIC, (), (float(f8()), -0.0), 0.1)
    laws = [
        Law(LawKind.TRACK, np.arange(3.0), f8(3, 2), True, 0.3),
        Law(LawKind.RELOCATE, f8(2), f8(2, 2)),
    ]
    return World(
        bounds=(-1.0, -2.0, 1 / 3, np.float64(5.0)),
        solids=(wall, disc),
        bodies=tuple(Body(disc, laws[m % 2]) for m in range(bodies)),
        agents=Agents(
            f8(agents, 2), f8(agents), f8(agents, 2), f8(agents), f8(agents), f8(agents),
            np.full(agents, np.inf), i1(2), i1(2), rng.integers(0, 2, agents),
            rng.integers(0, 2, agents),
        ),
        teams=("red", "blau"),
        sees=np.array([[True, False], [True, True]]),
        clock=Clock(0.1, 4, 100, 0.05 if agents % 2 else None),
        rules=Rules(0.3, ContactRule.STOP, Afterwards.STAY, Afterwards.VANISH, Charge.BOTH),
        sensing=Sensing(
            RaySensor(7, 1.1, 3.0, True), NeighbourSensor(4, 2.0), EdgeSensor(3, 2.0), False
        ),
        stale_solids=(wall,) if agents % 2 else None,
        measurement_area=(0.0, 0.0, 1.0, 1.0) if agents % 2 else None,
        meshes=(Mesh(f8(4, 3), np.array([[0, 1, 2]]), (0.0, 1.5)),),
        redraws=2,
    )  # fmt: skip


def make_episode(rng, seed=0, steps=5, agents=3, bodies=2, events=2, failure=""):
    world = make_world(rng, agents, bodies)
    contacts = Contacts(
        rng.integers(0, max(agents, 1), events), rng.integers(1, 4, events).astype(np.int8),
        rng.integers(-3, 3, events), rng.random(events), rng.random(events), rng.random(events),
        rng.random(events), rng.random(events) < 0.5,
    )  # fmt: skip
    arrival = rng.random(agents)
    arrival[:1] = np.nan
    episode = Episode(
        identity=Identity("a/b@1", "f" * 64, "test", seed, "known", "orca", HASH),
        world=world,
        position=rng.normal(size=(steps + 1, agents, 2)),
        heading=rng.normal(size=(steps + 1, agents)),
        status=rng.integers(0, 4, (steps + 1, agents)).astype(np.int8),
        requested=rng.normal(size=(steps, agents, 2)),
        executed=rng.normal(size=(steps, agents, 2)),
        body_position=rng.normal(size=(steps + 1, bodies, 2)),
        arrival=arrival,
        contacts=contacts,
        timings=Timings(
            rng.random(steps), 0.25, 7, rng.random(3) if seed % 2 else None, seed * 999 or None
        ),
        failure=failure,
        reproducible=bool(seed % 2),
    )
    return dataclasses.replace(episode, digest=digest(episode))


def make_results(episodes):
    rows = [
        {
            "navigator": e.identity.navigator, "scenario": e.identity.scenario,
            "scenario_hash": e.identity.scenario_hash, "track": e.identity.track,
            "split": e.identity.split, "seed": e.identity.seed, "role": "leader",
            "metric": "success", "value": 0.5, "agents": 2, "defined": 2, "failure": e.failure,
            "horizon": 10.0, "dt": 0.1, "navigator_hash": e.identity.navigator_hash,
            "rehearsal": e.rehearsals, "rehearsal_decisions": e.rehearsal_decisions,
            "rehearsal_seconds": e.timings.rehearsal, "missing": "",
            "remarks": list(e.remarks),
        }
        for e in episodes
    ]  # fmt: skip
    return pa.Table.from_pylist(rows, schema=RESULTS)


def make_manifest(rehearsal=0, **changes):
    suite = {
        "name": "tiny", "version": 1, "seeds": [0, 20], "split": "test", "tracks": ["known"],
        "scenarios": [{"scenario": "a/b@1", "hash": "f" * 64, "config": {}, "files": {}}],
        "navigators": [{**ORCA, "rehearsal": rehearsal}, {**ORCA, "label": "grid"}], **changes,
    }  # fmt: skip
    of = {"scenario": "a/b@1", "track": "known"}
    cells = (
        {"key": "cell", **of, "navigator": "orca", "reason": ""},
        {"key": "na", **of, "navigator": "grid", "reason": "needs a map"},
    )
    return Manifest(suite, cells)


def assert_same(left, right, path=""):
    """Equal in type and, for floats, in every bit."""
    assert type(left) is type(right) or isinstance(left, float), path
    if isinstance(left, np.ndarray):
        assert left.dtype == right.dtype, path
        assert left.shape == right.shape, path
        assert left.tobytes() == right.tobytes(), path
    elif dataclasses.is_dataclass(left):
        for f in dataclasses.fields(left):
            assert_same(getattr(left, f.name), getattr(right, f.name), f"{path}.{f.name}")
    elif isinstance(left, tuple):
        assert len(left) == len(right), path
        for i, pair in enumerate(zip(left, right, strict=True)):
            assert_same(*pair, f"{path}[{i}]")
    elif isinstance(left, float):
        assert np.float64(left).tobytes() == np.float64(right).tobytes(), path
    else:
        assert left == right, path


@pytest.fixture
def tools():
    class Tools:
        world = staticmethod(make_world)
        episode = staticmethod(make_episode)
        results = staticmethod(make_results)
        same = staticmethod(assert_same)

        manifest = staticmethod(make_manifest)

    return Tools


@pytest.fixture
def run(tmp_path: Path) -> Path:
    return tmp_path / "run"
