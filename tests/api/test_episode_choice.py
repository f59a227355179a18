"""Which stored episodes count as failed, and which as the worst."""

import pyarrow as pa
import pytest

from benchnav.api.records import episode_choice
from benchnav.api.records.episode_choice import failed_episodes, worst_episodes
from benchnav.api.records.episodes import Place
from benchnav.errors import UsageError

ROWS = (  # seed, role, metric, value
    (0, "leader", "success", 1.0), (0, "follower", "success", 1.0),
    (1, "leader", "success", 1.0), (1, "follower", "success", 0.5),
    (2, "leader", "success", 0.0), (2, "follower", "success", 1.0),
    (0, "leader", "collided", 0.2), (0, "follower", "collided", 0.3),
    (1, "leader", "collided", 0.0), (1, "follower", "collided", 0.9),
    (2, "leader", "collided", 0.4), (2, "follower", "collided", 0.4),
    (0, "leader", "time_to_goal", 9.0), (1, "leader", "time_to_goal", float("nan")),
    (2, "leader", "time_to_goal", 12.0),
    (0, "leader", "collisions_wall", 1.0),
    (0, "leader", "stuck", 0.0), (1, "leader", "stuck", float("nan")), (2, "leader", "stuck", 0.5),
)  # fmt: skip
PLACES = [Place(None, "orca", "x@1", "known", seed, None) for seed in range(3)]


@pytest.fixture(autouse=True)
def results(monkeypatch):
    columns = dict(zip(("seed", "role", "metric", "value"), zip(*ROWS, strict=True), strict=True))
    same = {"navigator": "orca", "scenario": "x@1", "track": "known", "perception": "exact"}
    table = pa.table({**columns, **{name: [text] * len(ROWS) for name, text in same.items()}})
    monkeypatch.setattr(episode_choice, "results_of", lambda folder: table)


def seeds(episodes):
    return [place.seed for place in episodes.places]


def test_an_episode_failed_if_an_agent_of_any_role_did_not_succeed():
    assert seeds(failed_episodes(None, PLACES)) == [1, 2]


def test_the_worst_role_of_an_episode_counts():
    assert seeds(worst_episodes(None, PLACES, "success")) == [2, 1, 0]
    assert seeds(worst_episodes(None, PLACES, "collided")) == [1, 2, 0]


def test_episodes_without_a_value_are_left_out():
    assert seeds(worst_episodes(None, PLACES, "time_to_goal")) == [2, 0]


def test_a_metric_must_be_held_and_have_a_better_side():
    with pytest.raises(UsageError, match=r"collided, success.*Did you mean 'collided'"):
        worst_episodes(None, PLACES, "colided")
    with pytest.raises(UsageError, match="'collisions_wall' has none"):
        worst_episodes(None, PLACES, "collisions_wall")


def test_failures_are_chosen_by_their_cause():
    assert seeds(failed_episodes(None, PLACES, cause="stuck")) == [2]
    assert seeds(failed_episodes(None, PLACES, cause="collided")) == [1, 2]  # 0 succeeded
    with pytest.raises(UsageError, match="one of collided, timeout, stuck, failed"):
        failed_episodes(None, PLACES, cause="crash")
