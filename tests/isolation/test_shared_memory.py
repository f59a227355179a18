"""The runner alone writes the shared memory; a navigator acts the same with and without it."""

import mmap
import os
import sys

import numpy as np
import pytest

from benchnav.isolation import shared_memory
from benchnav.isolation.frame import encode, encode_head, encode_parts, write_parts
from benchnav.isolation.navigator_process import Process
from benchnav.isolation.request_reader import RequestReader
from benchnav.isolation.shared_memory import SharedMemory, open_offered
from benchnav.runner.rollouts.rollout import Assignment, rollout
from tests.worlds import agents, world

HOSTED = [sys.executable, "-m", "benchnav.isolation.host", "straight-line"]
HELLO = {"text": '{"protocol": 2, "config": {}}'}


@pytest.fixture
def shared():
    memory = SharedMemory.create()
    if memory is None:
        pytest.skip("this system has no memory that can be sealed")
    return memory


def digest():
    some = [(0, world(agents([[5.0, 5.0]], [[15.0, 5.0]]), steps=10))]
    spec = {"type": "process", "command": HOSTED}
    assignment = Assignment("s", "h", "test", "known", "x", spec, salt="00")
    (episode,) = next(rollout(assignment, some))
    assert episode.failure == ""
    return episode.digest


def test_only_the_mapping_of_the_runner_writes(shared):
    shared.memory[:5] = b"truth"
    descriptor = shared.descriptor
    again = os.open(f"/proc/self/fd/{descriptor}", os.O_RDWR)  # a new description of the file
    for other in (descriptor, again):
        with pytest.raises(PermissionError):
            os.pwrite(other, b"false", 0)
        with pytest.raises(PermissionError):
            os.ftruncate(other, 0)
        with pytest.raises(PermissionError):
            os.ftruncate(other, 2 * shared_memory.SIZE)
        with pytest.raises(PermissionError):
            mmap.mmap(other, shared_memory.SIZE)
    os.close(again)
    seen = open_offered(descriptor, shared_memory.SIZE)
    assert seen.readonly
    shared.memory[:5] = b"newer"
    assert bytes(seen[:5]) == b"newer"


def test_a_descriptor_of_another_file_is_left_alone(tmp_path):
    file = os.open(tmp_path / "other", os.O_RDWR | os.O_CREAT)
    os.ftruncate(file, shared_memory.SIZE)
    assert open_offered(file, shared_memory.SIZE) is None
    os.close(file)  # still open
    assert open_offered(file, shared_memory.SIZE) is None  # closed now


def test_a_request_does_not_change_with_the_next(shared):
    requests, sent = os.pipe()
    reader = RequestReader(requests)
    os.write(sent, encode("hello", {**HELLO, "memory": shared.offer}))
    assert reader.agree(reader.read()[1])
    got = []
    for number in (1.0, 2.0):
        parts, size = encode_parts({"position": np.full((3, 2), number), "flags": np.ones(3, bool)})
        write_parts(parts, shared.memory, 0)
        os.write(sent, encode_head("act", 2, size))
        got.append(reader.read()[1])
    assert (got[0]["position"] == 1.0).all()
    assert (got[1]["position"] == 2.0).all()
    os.write(sent, encode("hello", HELLO))  # no offer: all is in the pipe again
    assert not reader.agree(reader.read()[1])
    os.write(sent, encode("act", {"time": 0.5}))
    assert reader.read() == ("act", {"time": 0.5})
    os.close(sent)
    assert reader.read() is None
    os.close(requests)


@pytest.mark.parametrize("size", [0, 64, 512])
def test_commands_are_the_same_without_it_and_if_it_is_small(size, monkeypatch):
    here = digest()
    if size == 0:
        monkeypatch.delattr(os, "memfd_create", raising=False)
        assert SharedMemory.create() is None
    monkeypatch.setattr(shared_memory, "SIZE", size)
    assert digest() == here


def test_both_sides_agree_in_the_greeting(shared):
    process = Process(HOSTED)
    assert process.request("hello", HELLO, 60.0)[0] == "ready"
    assert process._shares
    refused = {"text": '{"protocol": 2, "config": {"radus": 1}}'}
    assert process.request("hello", refused, 60.0)[0] == "failed"
    assert not process._shares
    assert process.request("hello", HELLO, 60.0)[0] == "ready"
    assert process._shares
    process.stop()
