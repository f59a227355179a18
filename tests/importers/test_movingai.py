import math

import numpy as np
import pytest

from benchnav.errors import MapError
from benchnav.geometry.geodesic import FreeSpace
from benchnav.scenario.files.occupancy import trace
from benchnav.scenario.importers import movingai
from tests.importers.data import published
from tests.reference import octile

TINY = "type octile\nheight 4\nwidth 5\nmap\n.....\n.@T..\nG.OW.\n@...S\n"
SCEN = (
    "version 1\n"
    "0\tmaps/tiny.map\t5\t4\t0\t0\t4\t3\t6.41421356\n"
    "0\ttiny.map\t5\t4\t0\t2\t1\t2\t1\n"
)  # (column, row from the top)

MAPS = {
    "arena": "arena.map.scen",
    "random-32-32-10": "random-32-32-10-even-1.scen",
    "maze-32-32-2": "maze-32-32-2-even-1.scen",
    "room-32-32-4": "room-32-32-4-even-1.scen",
    "den312d": "den312d-even-1.scen",
    "warehouse-10-20-10-2-1": "warehouse-10-20-10-2-1-even-1.scen",
    "Berlin_1_256": "Berlin_1_256-even-1.scen",
}


@pytest.fixture
def tiny(tmp_path):
    path = tmp_path / "tiny.map"
    path.write_bytes(TINY.encode())
    return path


def write(tmp_path, text, name="tiny.map"):
    path = tmp_path / name
    path.write_bytes(text if isinstance(text, bytes) else text.encode("latin-1"))
    return path


def lengths(queries, occupancy, limit=200):
    """(octile by A*, geodesic of an agent of radius 0.05, published) of the first queries."""
    table = octile.neighbours(occupancy.blocked)
    space = FreeSpace(np.vstack([s.capsules for s in trace(occupancy)]), 0.05)
    for row in range(min(limit, len(queries.length))):
        start, goal = tuple(queries.start[row].tolist()), tuple(queries.goal[row].tolist())
        ends = occupancy.centres(*np.array([start, goal]).T)
        yield octile.length(table, start, goal), space.length(*ends), queries.length[row]


def test_rows_are_turned_upwards(tiny):
    occupancy = movingai.read_map(tiny)
    expected = np.array([[1, 0, 0, 0, 0], [0, 0, 1, 1, 0], [0, 1, 1, 0, 0], [0, 0, 0, 0, 0]], bool)
    assert np.array_equal(occupancy.blocked, expected)
    assert not occupancy.unknown.any()
    assert occupancy.bounds == (0.0, 0.0, 5.0, 4.0)
    assert occupancy.centres(0, 0).tolist() == [0.5, 0.5]
    assert movingai.read_map(tiny, cell=2.0).bounds == (0.0, 0.0, 10.0, 8.0)


def test_line_ends_do_not_matter(tmp_path, tiny):
    crlf = write(tmp_path, TINY.replace("\n", "\r\n"), "crlf.map")
    bare = write(tmp_path, TINY.rstrip("\n") + "\n\n", "blank.map")
    for path in (crlf, bare):
        assert np.array_equal(movingai.read_map(path).blocked, movingai.read_map(tiny).blocked)


def test_queries_are_turned_with_the_map(tmp_path, tiny):
    occupancy = movingai.read_map(tiny)
    queries = movingai.read_scen(write(tmp_path, SCEN, "tiny.scen"), tiny, occupancy)
    assert queries.start.tolist() == [[0, 3], [0, 1]]
    assert queries.goal.tolist() == [[4, 0], [1, 1]]
    for grid, geodesic, length in lengths(queries, occupancy):
        assert grid == pytest.approx(length)
        assert geodesic <= length + 1e-9


@pytest.mark.parametrize(
    ("text", "line", "says"),
    [
        ("", 1, "type octile"),
        (b"\x89PNG\r\n\x1a\n\x00\x00", 1, "type octile"),
        ("type tile\nheight 1\nwidth 1\nmap\n.\n", 1, "'type tile'"),
        ("type octile\nheight 1\nmap\n.\n", 3, "height or width; got 'map'"),
        ("type octile\nheight 1\nheight 1\nmap\n.\n", 3, "height or width"),
        ("type octile\nheight -1\nwidth 1\nmap\n.\n", 2, "height or width"),
        ("type octile\nheight 1", 3, "the end of the file"),
        ("type octile\nheight 0\nwidth 5\nmap\n", 2, "≥ 1; got 5 × 0"),
        ("type octile\nheight 99999\nwidth 99999\nmap\n.\n", 2, "at most 16000000 cells"),
        ("type octile\nheight 999999999999\nwidth 1\nmap\n.\n", 2, "height or width"),
        ("type octile\nheight 1\nwidth 1\n.\n", 4, "must be `map`"),
        ("type octile\nheight 3\nwidth 2\nmap\n..\n..\n", 7, "3 rows that line"),
        ("type octile\nheight 1\nwidth 2\nmap\n..\n..\n", 6, "1 rows"),
        ("type octile\nheight 2\nwidth 2\nmap\n..\n...\n", 6, "2 cells; got 3"),
        ("type octile\nheight 2\nwidth 2\nmap\n..\n.x\n", 6, "column 2 must be one of . G S"),
        ("type octile\nheight 1\nwidth 2\nmap\n.é\n", 5, "column 2"),
    ],
)
def test_a_broken_map_is_refused_with_its_line(tmp_path, text, line, says):
    path = write(tmp_path, text)
    with pytest.raises(MapError) as error:
        movingai.read_map(path)
    assert str(error.value).startswith(f"{path}:{line}: ")
    assert says in str(error.value)


def test_a_missing_map_and_a_folder_are_refused(tmp_path):
    for path in (tmp_path / "no.map", tmp_path):
        with pytest.raises(MapError, match="cannot be read"):
            movingai.read_map(path)


def query(*changes):
    fields = ["0", "tiny.map", "5", "4", "0", "0", "4", "3", "7"]
    for index, value in changes:
        fields[index] = value
    return "version 1\n" + "\t".join(fields) + "\n"


@pytest.mark.parametrize(
    ("text", "line", "says"),
    [
        ("version 2\n", 1, "version 1"),
        ("", 1, "version 1"),
        ("version 1\n\n", 2, "at least one query"),
        ("version one\n", 1, "version 1"),
        ("version 1\n1 2 3\n", 2, "9 fields between tabs or spaces; got 3"),
        ("1 2 3\n", 1, "9 fields between tabs or spaces; got 3"),
        ("\x89PNG\r\n", 1, "9 fields"),
        (query((1, "other.map")), 2, "about tiny.map; got 'other.map'"),
        (query((2, "6")), 2, "those of the map, 5 and 4; got 6 and 4"),
        (query((4, "-1")), 2, "whole numbers"),
        (query((4, "5")), 2, "start must be a free cell"),
        (query((7, "4")), 2, "goal must be a free cell"),
        (query((4, "1"), (5, "1")), 2, "start must be a free cell"),
        (query((8, "nan")), 2, "optimal length"),
        (query((8, "far")), 2, "optimal length"),
    ],
)
def test_a_broken_scen_is_refused_with_its_line(tmp_path, tiny, text, line, says):
    path = write(tmp_path, text, "tiny.scen")
    with pytest.raises(MapError) as error:
        movingai.read_scen(path, tiny, movingai.read_map(tiny))
    assert str(error.value).startswith(f"{path}:{line}: ")
    assert says in str(error.value)


ROWS = "0 maps/tiny.map 5 4 0 0 4 3 6.41421356\n0 tiny.map 5 4 0 2 1 2 1\n"


@pytest.mark.parametrize(
    "text",
    [
        "version 1.0\n" + ROWS,
        "version 1\n" + ROWS.replace(" ", "\t"),
        "version 1.0\n" + ROWS.replace(" ", "   "),
        "version 1\n" + ROWS.replace(" 5 4 ", "\t5 4\t"),
        "\n  version   1.0  \r\n\r\n" + ROWS.replace("\n", "  \r\n\r\n"),
        "version 1\n" + ROWS.rstrip("\n"),
        "version 1\r" + ROWS.replace("\n", "\r"),
        "\xef\xbb\xbfversion 1\n" + ROWS,
        "version 1\n" + ROWS.replace("6.41421356", "6.41421356e+00").replace(" 1\n", " 1.00\n"),
        "version 1\n" + ROWS.replace("maps/tiny.map", "C:\\maps\\Tiny.map"),
        "version 1\n" + ROWS.replace("maps/tiny.map", "my maps/tiny.map"),
        ROWS,
        ROWS.replace(" 5 4 ", " "),
        "version 0\n" + ROWS.replace(" 5 4 ", "\t"),
    ],
)
def test_published_ways_to_write_the_same_queries(tmp_path, tiny, text):
    path = write(tmp_path, text, "tiny.scen")
    queries = movingai.read_scen(path, tiny, movingai.read_map(tiny))
    assert queries.start.tolist() == [[0, 3], [0, 1]]
    assert queries.goal.tolist() == [[4, 0], [1, 1]]
    assert queries.length.tolist() == pytest.approx([6.41421356, 1.0])
    assert queries.left_out == ()


def test_a_map_name_with_spaces(tmp_path):
    path = write(tmp_path, TINY, "Tiny Map (2).map")
    for between in ("\t", " "):
        row = between.join(["0", "Tiny Map (2).map", "5", "4", "0", "0", "4", "3", "7"])
        scen = write(tmp_path, f"version 1\n{row}\n", "tiny.scen")
        assert len(movingai.read_scen(scen, path, movingai.read_map(path)).length) == 1


def test_rows_that_cannot_be_used_refuse_no_file(tmp_path, tiny):
    broken = "3 tiny.map 5 4\n4 other.map 9 9 0 0 1 1 1\n5 tiny.map 5 4 1 1 0 0 1\n"
    text = "version 1\n" + broken + ROWS + "6 tiny.map 5 4 0 0 nowhere\n"
    path = write(tmp_path, text, "tiny.scen")
    queries = movingai.read_scen(path, tiny, movingai.read_map(tiny))
    assert len(queries.length) == 2
    assert [text.split(":")[1] for text in queries.left_out] == ["2", "3", "4", "7"]


def test_small_letters_blank_lines_and_spaces_do_not_matter(tmp_path, tiny):
    rows = "type octile\n\nwidth 5\nheight 4\n map \n\n.....\n\n.@t..  \ng.oW.\n@...s"
    other = movingai.read_map(write(tmp_path, rows, "other.map"))
    assert np.array_equal(other.blocked, movingai.read_map(tiny).blocked)


@pytest.mark.slow
@pytest.mark.parametrize("name", MAPS)
def test_published_lengths_are_those_of_the_imported_map(name):
    path = published(f"movingai/{name}.map")
    occupancy = movingai.read_map(path)
    queries = movingai.read_scen(published(f"movingai/{MAPS[name]}"), path, occupancy)
    checked = 0
    for grid, geodesic, length in lengths(queries, occupancy):
        slack = max(0.011, 1e-5 * length)
        assert grid == pytest.approx(length, abs=slack)
        assert geodesic <= grid + 1e-9
        assert not math.isnan(geodesic)
        checked += 1
    assert checked == min(200, len(queries.length))


def test_the_published_map_with_other_line_ends_is_the_same():
    one = movingai.read_map(published("movingai/Berlin_1_256.map"))
    two = movingai.read_map(published("movingai/Berlin_1_256.crlf.map"))
    assert np.array_equal(one.blocked, two.blocked)
