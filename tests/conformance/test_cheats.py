"""What a navigator can learn beyond what it is told, in the runner's process and in its own.

Through objects, closures and modules it learns nothing in either. Frames, the garbage
collector and process memory give the world away within one process (this is said, not
hidden), and nothing in a process of its own.
"""

import hashlib
import multiprocessing
import os
import struct
import sys

import pytest
import yaml

from benchnav.generation.build import build
from benchnav.runner.plan.suite import Selection, load_suite
from benchnav.runner.run import run_suite
from benchnav.scenario.load import load_scenario
from benchnav.store.runs.reading import read_episodes
from tests.conformance import cheats

SCENARIO = """
name: tiny/pillar
title: One disc that wants to the other side, and a pillar
bounds: [-4, -4, 4, 4]
static:
  - shape: {type: disc, radius: 0.4}
    count: 1
    region: {type: anywhere, margin: 1}
teams:
  - name: us
    count: 1
    radius: 0.3
    max_speed: 1
    start: {type: region, region: {type: anywhere}, separation: 0.3}
    goal: {type: region, region: {type: anywhere}, min_distance: 3}
clock: {dt: 0.2, substeps: 2, horizon: 1}
"""

NEVER = [
    "Objects", "Bases", "Closures", "Modules", "Threads", "Contexts", "Generators", "Scribbles",
    "Builder", "Patches", "PatchesModules", "PatchesCode",
]  # fmt: skip
APART = [
    "Frames", "Tracebacks", "OtherFrames", "Profiler", "Collector", "Referrers", "Memory",
    "Pointers", "Surroundings", "Descriptors",
]  # fmt: skip
ONLY_APART = ["Tracer"]  # elsewhere it would trace strangers

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="the means are those of Linux")
PATCHED = {
    "Patches": "benchnav.world.simulation.Simulation.step",
    "PatchesModules": "benchnav.navigation.observe.sense",
    "PatchesCode": "benchnav.world.simulation.Simulation.step",
}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("cheats")
    (folder / "pillar.yaml").write_text(SCENARIO)
    world = build(load_scenario(folder / "pillar.yaml"), "test", 0)
    x, y = world.solids[-1].center
    clue = {"x": x.hex(), "proof": hashlib.sha256(struct.pack("<d", y)).hexdigest()}
    suite = {
        "name": "cheats", "scenarios": ["pillar.yaml"], "tracks": ["unknown"], "seeds": 1,
        "navigators": [
            {"type": f"tests.conformance.cheats:{name}", "label": name}
            | (clue if name in ("Memory", "Tracer") else {})
            for name in [*NEVER, *APART, *ONLY_APART, "Cheat"]
        ],
    }  # fmt: skip
    (folder / "cheats.yaml").write_text(yaml.safe_dump(suite))
    return folder


def run(folder, out, isolate):
    """In a process of its own, so that nothing of the tests is what a cheat finds."""
    os.environ[cheats.CLUE] = "1"
    names = () if isolate else (*NEVER, *APART, "Cheat")
    selection = Selection(salt="0a", isolate=isolate, navigators=names)
    run_suite(load_suite(str(folder / "cheats.yaml"), selection), out, workers=0)


@pytest.fixture(scope="module", params=["in-process", "isolated"])
def played(request, folder):
    """The mode, and the episodes by label."""
    out = folder / request.param
    context = multiprocessing.get_context("spawn")
    process = context.Process(target=run, args=(folder, out, request.param == "isolated"))
    process.start()
    process.join()
    assert process.exitcode == 0
    return request.param, {e.identity.navigator: e for e in read_episodes(out)}


def answer(episode):
    return "{!r} {!r}".format(*episode.world.solids[-1].center)


@pytest.mark.parametrize("name", NEVER)
def test_objects_closures_and_modules_tell_nothing(played, name):
    mode, episodes = played
    episode, honest = episodes[name], episodes["Cheat"]
    assert episode.remarks == ()
    assert answer(episode) == answer(honest)
    if mode == "in-process" and name in PATCHED:
        assert f"it replaced {PATCHED[name]}, which is no part of it" in episode.failure
    else:
        assert episode.failure == ""
        assert episode.position.tobytes() == honest.position.tobytes()


@pytest.mark.parametrize("name", APART)
def test_frames_collector_and_memory_tell_all_within_one_process_and_nothing_apart(played, name):
    mode, episodes = played
    episode = episodes[name]
    assert episode.failure == ""
    if mode == "isolated":
        assert episode.remarks == ()
    elif name in ("Surroundings", "Descriptors"):
        assert episode.remarks == (name.lower(),)
    else:
        assert episode.remarks == (answer(episode),)


@pytest.mark.parametrize("name", ONLY_APART)
def test_nobody_can_trace_the_runner(played, name):
    mode, episodes = played
    if mode == "isolated":
        assert (episodes[name].failure, episodes[name].remarks) == ("", ())
