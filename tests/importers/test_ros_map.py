import json
import struct
import zlib

import numpy as np
import pytest
from PIL import Image

from benchnav.errors import MapError
from benchnav.scenario.importers.ros_map import read_map
from tests.importers.data import published

HEADER = {
    "image": "tiny.pgm",
    "resolution": 0.5,
    "origin": [1.0, -2.0, 0.0],
    "negate": 0,
    "occupied_thresh": 0.65,
    "free_thresh": 0.196,
}
SHADES = np.array([[254, 205, 0], [100, 255, 90]], np.uint8)  # image order: row 0 on top
BLOCKED = np.array([[False, False, False], [False, False, True]])
# 255 → 0, 254 → 0.004 are free; 0 → 1 is blocked; 205 → 0.1961 is just above free_thresh;
# 100 → 0.608 is unknown, 90 → 0.647 too
UNKNOWN = np.array([[True, False, True], [False, True, False]])


def put(tmp_path, picture=None, name="tiny.pgm", **changes):
    """The YAML's path; ``picture`` is bytes, an array, None for the tiny one, False for none."""
    header = {**HEADER, "image": name, **changes}
    lines = [f"{k}: {json.dumps(v)}" for k, v in header.items() if v is not None]
    path = tmp_path / "tiny.yaml"
    path.write_text("\n".join(lines) + "\n")
    if isinstance(picture, bytes):
        (tmp_path / name).write_bytes(picture)
    elif picture is not False:
        Image.fromarray(SHADES if picture is None else picture).save(tmp_path / name)
    return path


def pgm(text, shades=SHADES):
    return text.encode() + shades.tobytes()


def check(occupancy, blocked=BLOCKED, unknown=UNKNOWN):
    assert np.array_equal(occupancy.blocked, blocked)
    assert np.array_equal(occupancy.unknown, unknown)


def test_thresholds_rows_and_place(tmp_path):
    occupancy = read_map(put(tmp_path))
    check(occupancy)
    assert (occupancy.cell, occupancy.origin) == (0.5, (1.0, -2.0, 0.0))
    assert occupancy.bounds == (1.0, -2.0, 2.5, -1.0)
    assert occupancy.centres(2, 1).tolist() == [2.25, -1.25]  # the blocked pixel, top right
    assert read_map(put(tmp_path), cell=2.0).bounds == (1.0, -2.0, 7.0, 2.0)


def test_yaw_turns_about_the_lower_left_corner(tmp_path):
    occupancy = read_map(put(tmp_path, origin=[1.0, -2.0, np.pi / 2]))
    assert occupancy.centres(2, 1) == pytest.approx([1.0 - 0.75, -2.0 + 1.25])
    assert occupancy.bounds == pytest.approx((0.0, -2.0, 1.0, -0.5))


def test_negate(tmp_path):
    check(read_map(put(tmp_path, 255 - SHADES, negate=1)))
    check(read_map(put(tmp_path, 255 - SHADES, negate=True)))


@pytest.mark.parametrize(
    "content",
    [
        pgm("P5\n3 2\n255\n"),
        pgm("P5 # made by hand\n# and by a tool 0.050 m/pix\n3 # wide\n2\n255\n"),
        b"P2\n# plain\n3 2\n255\n254 205 0\n100 255 90\n",
    ],
)
def test_every_kind_of_pgm(tmp_path, content):
    check(read_map(put(tmp_path, content)))


def test_fewer_shades_are_scaled(tmp_path):
    check(
        read_map(put(tmp_path, b"P2\n3 2\n10\n10 8 0\n4 10 4\n")),
        unknown=np.array([[True, False, True], [False, True, False]]),
    )


@pytest.mark.parametrize("name", ["tiny.png", "tiny.bmp", "tiny.PNG"])
@pytest.mark.parametrize("mode", ["L", "RGB", "P"])
def test_every_kind_of_image(tmp_path, name, mode):
    path = put(tmp_path, False, name)
    Image.fromarray(SHADES).convert(mode).save(tmp_path / name)
    check(read_map(path))


def test_sixteen_bits(tmp_path):
    check(read_map(put(tmp_path, SHADES.astype(np.uint16) * 257, "tiny.png")))


def test_one_bit(tmp_path):
    path = put(tmp_path, False, "tiny.png")
    Image.fromarray(SHADES > 128).save(tmp_path / "tiny.png")
    blocked = np.array([[True, False, True], [False, False, True]])
    check(read_map(path), blocked, np.zeros((2, 3), bool))


CLEAR = {  # black, black and white, of which only the first is opaque
    "LA": [[[0, 255], [0, 0], [255, 254]]],
    "RGBA": [[[0, 0, 0, 255], [0, 0, 0, 0], [255, 255, 255, 254]]],
}


@pytest.mark.parametrize("mode", CLEAR)
@pytest.mark.parametrize("map_mode", ["trinary", "scale"])
def test_a_pixel_that_is_not_opaque_is_unknown(tmp_path, mode, map_mode):
    path = put(tmp_path, False, "tiny.png", mode=map_mode)
    Image.fromarray(np.array(CLEAR[mode], np.uint8)).save(tmp_path / "tiny.png")
    check(read_map(path), np.array([[1, 0, 0]], bool), np.array([[0, 1, 1]], bool))


@pytest.mark.parametrize("mode", ["1", "L", "LA", "RGB", "RGBA", "P", "I;16"])
def test_opaque_pictures_of_every_mode_are_the_same_map(tmp_path, mode):
    path = put(tmp_path, False, "tiny.png")
    black_or_white = np.array([[255, 0, 0], [0, 255, 0]], np.uint8)
    if mode == "I;16":
        image = Image.fromarray(black_or_white.astype(np.uint16) * 257)
    else:
        image = Image.fromarray(black_or_white).convert(mode)
    assert image.mode == mode
    image.save(tmp_path / "tiny.png")
    check(read_map(path), np.array([[1, 0, 1], [0, 1, 1]], bool), np.zeros((2, 3), bool))


@pytest.mark.parametrize(("mode", "clear"), [("1", 0), ("L", 0), ("RGB", (0, 0, 0)), ("I;16", 0)])
def test_a_colour_that_a_png_declares_clear_is_unknown(tmp_path, mode, clear):
    path = put(tmp_path, False, "tiny.png")
    shades = np.array([[255, 0]], np.uint16 if mode == "I;16" else np.uint8)
    image = Image.fromarray(shades * (257 if mode == "I;16" else 1))
    image = image if mode == "I;16" else image.convert(mode)
    image.save(tmp_path / "tiny.png", transparency=clear)
    check(read_map(path), np.array([[0, 0]], bool), np.array([[0, 1]], bool))


@pytest.mark.parametrize("name", ["tiny.jpg", "tiny.JPEG", "tiny.gif", "tiny.tif", "tiny.ppm"])
def test_other_formats_of_images(tmp_path, name):
    path = put(tmp_path, False, name)
    shades = np.full((16, 16), 254, np.uint8)
    shades[:, :8] = 0
    Image.fromarray(shades).convert("RGB" if name == "tiny.ppm" else "L").save(tmp_path / name)
    check(read_map(path), shades == 0, np.zeros((16, 16), bool))


def test_colours_count_by_their_luma(tmp_path):
    """Green, 0.587, is unknown and yellow, 0.886, free; their means, ⅓ and ⅔, are neither."""
    path = put(tmp_path, False, "tiny.png")
    colours = np.array([[[0, 255, 0], [255, 255, 0], [255, 0, 0], [0, 0, 255]]], np.uint8)
    Image.fromarray(colours).save(tmp_path / "tiny.png")
    check(read_map(path), np.array([[0, 0, 1, 1]], bool), np.array([[1, 0, 0, 0]], bool))


def test_scale_keeps_colour_and_opacity_apart(tmp_path):
    path = put(tmp_path, False, "tiny.png", mode="scale")
    image = Image.fromarray(np.array([[255, 0, 0, 128]], np.uint8)).convert("RGBA")
    image.putalpha(Image.fromarray(np.array([[255, 255, 254, 255]], np.uint8)))
    image.save(tmp_path / "tiny.png")
    blocked, unknown = np.array([[0, 1, 0, 0]], bool), np.array([[0, 0, 1, 1]], bool)
    check(read_map(path), blocked, unknown)


def test_raw_is_per_cent(tmp_path):
    image = np.array([[0, 19, 20, 64, 65, 100, 101, 255]], np.uint8)
    occupancy = read_map(put(tmp_path, image, mode="raw"))
    check(
        occupancy,
        np.array([[0, 0, 0, 0, 1, 1, 0, 0]], bool),
        np.array([[0, 0, 1, 1, 0, 0, 1, 1]], bool),
    )


def test_raw_takes_no_notice_of_negate_or_opacity(tmp_path):
    path = put(tmp_path, False, "tiny.png", mode="raw", negate=1)
    Image.fromarray(np.array([[[0, 0], [100, 255]]], np.uint8)).save(tmp_path / "tiny.png")
    check(read_map(path), np.array([[0, 1]], bool), np.zeros((1, 2), bool))


def test_scale_grades_what_is_between_and_rounds(tmp_path):
    """nav2's grades of these pixels are 0, 0, 1, 50, 99, 100 and 100."""
    shades = np.array([[255, 254, 252, 127, 3, 1, 0]], np.uint8)
    path = put(tmp_path, shades, mode="scale", occupied_thresh=1.0, free_thresh=0.0)
    blocked = np.array([[0, 0, 0, 0, 0, 1, 1]], bool)
    check(read_map(path), blocked, np.array([[0, 0, 1, 1, 1, 0, 0]], bool))


def test_free_cells_with_the_grey_of_unknown_ones_are_counted(tmp_path):
    assert read_map(put(tmp_path)).doubtful == 0  # 0.1961 > free_thresh
    assert read_map(put(tmp_path, free_thresh=0.25)).doubtful == 1
    assert read_map(put(tmp_path, free_thresh=0.25, mode="scale")).doubtful == 0


VALUES = [
    'resolution: "0.50000"', "resolution: '  5e-1 '", "resolution: .5", "resolution: 00.5",
    "negate: no", "negate: No", "negate: OFF", "negate: n", "negate: false", 'negate: "0"',
    "negate: 'False'", "mode: Trinary", "mode: TRINARY", 'mode: "trinary"',
    'origin: ["1.0", -2, "0"]', "origin:\n- 1\n- '-2.'\n- 0", 'occupied_thresh: "0.65"',
    "free_thresh: '0.196'", "image: ./tiny.pgm", "image: 'tiny.pgm'  # the picture",
]  # fmt: skip


@pytest.mark.parametrize("line", VALUES)
def test_values_are_read_as_yaml_cpp_reads_them(tmp_path, line):
    path = put(tmp_path)
    key = line.split(":")[0]
    kept = [kept for kept in path.read_text().splitlines() if not kept.startswith(f"{key}:")]
    path.write_text("\n".join([*kept, line, ""]))
    occupancy = read_map(path)
    check(occupancy)
    assert (occupancy.cell, occupancy.origin) == (0.5, (1.0, -2.0, 0.0))


@pytest.mark.parametrize("value", ["yes", "Y", "ON", "true", '"1"', "1", "'Yes'"])
def test_negate_may_be_said_in_words(tmp_path, value):
    path = put(tmp_path, 255 - SHADES)
    path.write_text(path.read_text().replace("negate: 0", f"negate: {value}"))
    check(read_map(path))


def test_an_absolute_path_and_another_folder(tmp_path):
    (tmp_path / "pictures").mkdir()
    Image.fromarray(SHADES).save(tmp_path / "pictures" / "a b.pgm")
    for name in ("pictures/a b.pgm", str(tmp_path / "pictures" / "a b.pgm")):
        check(read_map(put(tmp_path, False, name)))


def test_a_palette_with_a_clear_colour(tmp_path):
    path = put(tmp_path, False, "tiny.png", mode="scale")
    image = Image.new("P", (2, 1))
    image.putpalette([255, 255, 255, 0, 0, 0])
    image.putpixel((1, 0), 1)
    image.save(tmp_path / "tiny.png", transparency=0)
    check(read_map(path), np.array([[False, True]]), np.array([[True, False]]))


@pytest.mark.parametrize(
    ("changes", "line", "says"),
    [
        ({"resolution": 0}, 2, "resolution must be > 0"),
        ({"resolution": "fine"}, 2, "resolution must be a number; got 'fine'"),
        ({"resolution": None}, 1, "resolution must be given"),
        ({"image": None}, 1, "image must be given"),
        ({"image": ""}, 1, "image"),
        ({"image": "../nowhere/no.png"}, 1, "must name an existing image file"),
        ({"image": "tiny.pgn"}, 1, "Did you mean 'tiny.pgm'?"),
        ({"image": "a\x00b"}, 1, "image"),
        ({"origin": [0, 0]}, 3, "origin"),
        ({"origin": [0, 0, "north"]}, 3, "origin[2] must be a number"),
        ({"origin": ["1", "2", "east"]}, 3, "origin[2] must be a number; got 'east'"),
        ({"origin": 7}, 3, "origin must be"),
        ({"resolution": "0.05m"}, 2, "resolution must be a number; got '0.05m'"),
        ({"resolution": "-1"}, 2, "resolution must be > 0"),
        ({"negate": 2}, 4, "negate must be 0 or 1, or yes or no; got 2"),
        ({"negate": "maybe"}, 4, "negate must be 0 or 1, or yes or no; got 'maybe'"),
        ({"negate": [0]}, 4, "negate must be 0 or 1, or yes or no; got"),
        ({"negate": None}, 1, "negate must be given"),
        ({"occupied_thresh": "65%"}, 5, "occupied_thresh must be a number; got '65%'"),
        ({"occupied_thresh": 1.5}, 5, "occupied_thresh must be ≤ 1"),
        ({"free_thresh": 0.7}, 6, "free_thresh must be < occupied_thresh"),
        ({"mode": "trinery"}, 7, "Did you mean 'trinary'?"),
    ],
)
def test_a_broken_header_is_refused_with_line_and_key(tmp_path, changes, line, says):
    path = put(tmp_path)
    put(tmp_path, False, **changes)
    with pytest.raises(MapError) as error:
        read_map(path)
    assert str(error.value).startswith(f"{path}:{line}: ")
    assert says in str(error.value)
    assert "\n" not in str(error.value)  # one complaint for one mistake


@pytest.mark.parametrize(
    "text",
    [
        "", "- image\n", "image: [", "a: &a [1]\nb: *a\n", "image: !!python/name:os.system\n",
        "[" * 5000, "image: x\nimage: y\n", "{}: {}\n", "\x00", "x" * (1 << 21),
    ],
)  # fmt: skip
def test_hostile_yaml_is_refused(tmp_path, text):
    path = tmp_path / "map.yaml"
    path.write_text(text)
    with pytest.raises(MapError) as error:
        read_map(path)
    assert str(path) in str(error.value)


def huge_png(wide, high):
    def chunk(kind, data):
        return (
            struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
        )

    head = chunk(b"IHDR", struct.pack(">IIBBBBB", wide, high, 8, 0, 0, 0, 0))
    return (
        b"\x89PNG\r\n\x1a\n"
        + head
        + chunk(b"IDAT", zlib.compress(b"\0" * 10))
        + chunk(b"IEND", b"")
    )


@pytest.mark.parametrize(
    ("content", "says"),
    [
        (b"", "PNG, PGM or BMP"),
        (b"type octile\nheight 1\nwidth 1\nmap\n.\n", "PNG, PGM or BMP"),
        (b"GIF89a" + b"\0" * 40, "PNG, PGM or BMP"),
        (pgm("P5\n3 2\n255\n")[:-2], "PNG, PGM or BMP"),
        (pgm("P5\n3 2\n"), "PNG, PGM or BMP"),
        (pgm("P5\n4001 4001\n255\n"), "at most 16000000 cells; got 4001 × 4001"),
        (huge_png(60000, 60000), "16000000 cells|PNG, PGM or BMP"),
        (huge_png(10, 10), "PNG, PGM or BMP"),
    ],
)
def test_a_broken_image_is_refused_by_name(tmp_path, content, says):
    path = put(tmp_path, content)
    with pytest.raises(MapError, match=says) as error:
        read_map(path)
    assert str(tmp_path / "tiny.pgm") in str(error.value)


@pytest.mark.parametrize("kind", ["pgm", "png", "bmp"])
def test_the_published_test_map_cell_for_cell(tmp_path, kind):
    expected = json.loads(published("ros_maps/testmap_expected.json").read_text())
    header = published("ros_maps/testmap.yaml").read_text()
    (tmp_path / "map.yaml").write_text(header.replace("testmap.png", f"testmap.{kind}"))
    image = published(f"ros_maps/testmap.{kind}")
    (tmp_path / image.name).write_bytes(image.read_bytes())
    occupancy = read_map(tmp_path / "map.yaml")
    data = np.where(occupancy.unknown, -1, occupancy.blocked * 100)
    assert data.ravel().tolist() == expected["data_row_major_lower_left_first"]
    assert data.shape == (expected["height"], expected["width"])
    assert occupancy.cell == expected["resolution"]
    assert list(occupancy.origin) == expected["origin"]


def test_the_published_map_without_an_image_is_refused_by_name():
    path = published("ros_maps/invalid_image.yaml")
    with pytest.raises(MapError, match=r"invalid_image\.yaml:1: image must name .*'invalid\.png'"):
        read_map(path)


@pytest.mark.parametrize(
    ("name", "shape"),
    [("depot", (307, 604)), ("tb3_sandbox", (384, 384)), ("turtlebot3/map", (384, 384))],
)
def test_published_maps_have_walls_and_room(name, shape):
    occupancy = read_map(published(f"ros_maps/{name}.yaml"))
    assert occupancy.blocked.shape == shape
    free = ~(occupancy.blocked | occupancy.unknown)
    assert 0 < occupancy.blocked.sum() < free.sum()
