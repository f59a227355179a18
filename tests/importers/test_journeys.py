import numpy as np
import pytest

from benchnav.scenario.importers import import_movingai, movingai
from benchnav.scenario.importers.journeys import choose, summary
from benchnav.scenario.importers.movingai import Queries
from tests.importers.data import published


def queries(buckets, start=None, goal=None):
    """One query for each bucket, all of them between cells of their own."""
    count = np.arange(len(buckets))
    own = np.stack([count, count], axis=1)
    return Queries(
        np.array(buckets),
        own if start is None else np.array(start),
        own + 1000 if goal is None else np.array(goal),
        4.0 * np.array(buckets),
    )


def buckets(asked, count, bucket=None):
    return asked.bucket[choose(asked, count, bucket)].tolist()


def test_agents_are_spread_over_the_buckets():
    sorted_by_length = queries(np.repeat(np.arange(100), 10))
    assert buckets(sorted_by_length, 4) == [12, 37, 62, 87]
    assert buckets(sorted_by_length, 200) == np.repeat(np.arange(100), 2).tolist()
    assert buckets(queries([0] * 50 + [5]), 2) == [0, 5]
    assert buckets(queries([7, 3, 5, 3]), 3) == [3, 5, 7]


def test_one_bucket_gives_its_first_rows():
    assert choose(queries([1, 0, 1, 1, 1]), 3, 1) == [0, 2, 3]
    assert choose(queries([1, 0]), 3, 2) == []


def test_no_two_agents_share_a_start_or_a_goal_and_none_stays():
    start = [(0, 0), (0, 0), (1, 1), (2, 2), (3, 3)]
    goal = [(9, 9), (8, 8), (9, 9), (2, 2), (7, 7)]
    assert choose(queries([0, 1, 2, 3, 4], start, goal), 5, None) == [0, 4]


def test_a_bucket_that_is_used_up_is_replaced_by_the_nearest():
    assert buckets(queries([0, 1, 1, 1, 9]), 5) == [0, 1, 1, 9, 1]


def test_the_summary_is_in_metres():
    assert summary(np.array([3.0])) == "1 journey of 3.0 m."
    text = "3 journeys: shortest 1.0 m, median 2.5 m, longest 9.0 m."
    assert summary(np.array([9.0, 1.0, 2.5])) == text


def test_without_a_number_there_are_as_many_agents_as_queries(tmp_path):
    (tmp_path / "hall.map").write_text("type octile\nheight 1\nwidth 9\nmap\n.........\n")
    rows = [f"{i} hall.map 9 1 {i} 0 8 0 {8 - i}" for i in range(3)]
    rows[1] = "1 hall.map 9 1 7 0 2 0 5"
    scen = tmp_path / "hall.scen"
    scen.write_text("\n".join(["version 1.0", *rows, "9 elsewhere.map 1 1 0 0 0 0 0"]))
    remarks = []
    mapping = import_movingai(tmp_path / "hall.map", scen, remark=remarks.append)
    assert mapping["teams"][0]["count"] == 2
    assert remarks[1] == (
        f"1 row is left out. The first:\n{scen}:5: the query must be about hall.map;"
        " got 'elsewhere.map'. A map's file must have its published name."
    )


@pytest.mark.parametrize(
    ("name", "scen"),
    [("arena", "arena.map.scen"), ("den312d", "den312d-even-1.scen")],
)
def test_published_journeys_are_not_the_shortest(name, scen):
    path, scen = published(f"movingai/{name}.map"), published(f"movingai/{scen}")
    every = movingai.read_scen(scen, path, movingai.read_map(path))
    assert every.left_out == ()
    lengths = every.length[choose(every, 8, None)]
    assert len(lengths) == 8
    assert lengths.max() > 0.8 * every.length.max()
    assert np.median(lengths) == pytest.approx(np.median(every.length), rel=0.35)
