"""What a process behind the fence can reach, of what its user could reach without."""

import json
import os
import subprocess
import sys

import pytest

from benchnav.errors import UsageError
from benchnav.isolation import sandbox

LOOK = """
import ctypes, json, os, socket
def opens(path):
    try:
        os.close(os.open(path, os.O_WRONLY))  # nothing is written
        return True
    except OSError:
        return False
def raw():
    try:
        socket.socket(socket.AF_INET, socket.SOCK_RAW, 1).close()
        return True
    except OSError:
        return False
status = dict(line.split(":", 1) for line in open("/proc/self/status"))
print(json.dumps({
    "capabilities": [int(status[f"Cap{kind}"], 16) for kind in ("Inh", "Prm", "Eff", "Bnd", "Amb")],
    "no_new_privileges": int(status["NoNewPrivs"]),
    "user": os.getuid(),
    "opened": [path for path in PATHS if opens(path)],
    "devices": sorted(os.listdir("/dev")),
    "interfaces": [
        line.split(":")[0].strip() for line in open("/proc/net/dev").readlines()[2:]],
    "processes": len([name for name in os.listdir("/proc") if name.isdigit()]),
    "raw": raw(),
    "namespaces": {name: os.readlink(f"/proc/self/ns/{name}") for name in NAMESPACES},
    "null": open("/dev/null", "w").write("x"),
    "shm": open("/dev/shm/x", "w").write("x"),
}))
"""
PATHS = [
    "/proc/sys/kernel/hostname", "/proc/sys/kernel/core_pattern", "/proc/sys/vm/swappiness",
    "/proc/sysrq-trigger", "/proc/self/oom_score_adj", "/proc/1/oom_score_adj", "/dev/kmsg",
    "/dev/mem", "/dev/vda", "/dev/sda", "/dev/loop-control", "/dev/tty", "/sys/power/state",
    "/sys/kernel/mm/transparent_hugepage/enabled",
]  # fmt: skip
NAMESPACES = ["user", "pid", "net", "ipc", "uts", "mnt", "cgroup"]

enclosed = pytest.mark.skipif(
    "--keep-caps" not in sandbox.prefix(), reason="the system lets nobody make such namespaces"
)


@pytest.fixture(scope="module")
def seen():
    code = f"PATHS, NAMESPACES = {PATHS!r}, {NAMESPACES!r}\n{LOOK}"
    command = [*sandbox.prefix(), sys.executable, "-I", "-S", "-c", code]
    return json.loads(subprocess.run(command, capture_output=True, text=True, check=True).stdout)


@enclosed
def test_it_has_no_capability_and_can_get_none(seen):
    assert seen["capabilities"] == [0] * 5
    assert seen["no_new_privileges"] == 1
    assert seen["user"] != 0
    assert not seen["raw"]


@enclosed
def test_it_cannot_write_what_belongs_to_the_machine(seen):
    assert seen["opened"] == []


@enclosed
def test_it_has_namespaces_of_its_own(seen):
    for name, there in seen["namespaces"].items():
        assert there != os.readlink(f"/proc/self/ns/{name}"), name  # noqa: PTH115
    assert seen["processes"] <= 3
    assert seen["interfaces"] in ([], ["lo"])


@enclosed
def test_its_devices_do_no_harm(seen):
    usual = {"null", "zero", "full", "random", "urandom", "fd", "stdin", "stdout", "stderr", "shm"}
    assert {name for name in seen["devices"] if not name.startswith(("nvidia", "dri"))} <= usual
    assert (seen["null"], seen["shm"]) == (1, 1)


@enclosed
def test_a_program_that_cannot_be_started_ends_with_its_cause():
    done = subprocess.run(
        [*sandbox.prefix(), "/nothing"], capture_output=True, text=True, check=False
    )
    assert done.returncode != 0
    assert "No such file or directory" in done.stderr


@pytest.mark.skipif(
    not sys.platform.startswith("linux") or os.geteuid() != 0, reason="only root may do everything"
)
def test_root_without_a_fence_is_refused(monkeypatch):
    monkeypatch.setattr(sandbox, "prefix", lambda: ())
    with pytest.raises(UsageError, match=r"Here they could .*Run as an ordinary user"):
        sandbox.require_sandbox.__wrapped__()
    monkeypatch.setattr(sandbox, "prefix", lambda: sandbox._NAMESPACES)
    with pytest.raises(UsageError, match=r"Here they could write settings of the machine"):
        sandbox.require_sandbox.__wrapped__()
