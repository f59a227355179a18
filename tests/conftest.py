"""What all tests share."""

import pytest
from hypothesis import HealthCheck, settings

from benchnav.plugins import CONTROLLERS, METRICS, NAVIGATORS, PLANNERS, SCENARIOS, TRAINERS

# the first example of a test may compile a kernel
settings.register_profile(
    "benchnav", deadline=None, suppress_health_check=[HealthCheck.too_slow], print_blob=True
)
settings.load_profile("benchnav")


def pytest_collection_modifyitems(config, items):
    """Each worker of pytest-xdist begins with its share of the long tests: none begins last."""
    workers = getattr(config, "workerinput", {"workercount": 1})["workercount"]
    long = [item for item in items if item.get_closest_marker("long")]
    other = [item for item in items if not item.get_closest_marker("long")]
    items[:] = [
        item
        for worker in range(workers)
        for part in (long, other)
        for item in part[worker * len(part) // workers : (worker + 1) * len(part) // workers]
    ]


@pytest.fixture(scope="session", autouse=True)
def receipts(tmp_path_factory):
    """Verifying in a test leaves its receipt to the test."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("XDG_STATE_HOME", str(tmp_path_factory.mktemp("state")))
        yield


@pytest.fixture(autouse=True)
def forgotten(monkeypatch):
    """What a test registers is forgotten after it."""
    for registry in (NAVIGATORS, PLANNERS, CONTROLLERS, METRICS, SCENARIOS, TRAINERS):
        monkeypatch.setattr(registry, "_local", dict(registry._local))
        monkeypatch.setattr(registry, "_found", registry._found)
