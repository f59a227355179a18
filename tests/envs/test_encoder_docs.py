"""docs/environments.md lists every number of every encoder."""

import re
from pathlib import Path

import pytest

from benchnav.envs.encoders.catalogue import ENCODERS, encoder

PAGE = (Path(__file__).parents[2] / "docs" / "environments.md").read_text("utf-8")
REPEATED = re.compile(r"^(ray|scan|other|pan|window)(\d+)\.")
HEAD = ("number", "unit", "range", "what it is")


def rows(numbers):
    """What repeats for each k stands once."""
    for n in numbers:
        found = REPEATED.match(n.name)
        if found and found[2] != "0":
            continue
        name = REPEATED.sub(r"\1{k}.", n.name)
        yield (
            f"`{name}`",
            n.unit,
            f"{n.low:g} … {n.high:g}",
            n.meaning.replace("0° to", "k · 15° to").replace("command 0", "command k"),
        )


def table(numbers):
    """Markdown, its columns as wide as they must be."""
    body = [HEAD, *rows(numbers)]
    widths = [max(map(len, column)) for column in zip(*body, strict=True)]
    body.insert(1, tuple("-" * width for width in widths))
    lines = (" | ".join(x.ljust(w) for x, w in zip(row, widths, strict=True)) for row in body)
    return "\n".join(f"| {line} |" for line in lines)


def part(numbers, first, last):
    return [n for n in numbers if first <= numbers.index(n) < last]


@pytest.mark.parametrize(
    ("name", "first", "last"),
    [
        ("ego", 0, 42),
        ("ego", 42, 48),
        ("paper", 42, 48),
        ("ego", 48, 62),
        ("near", 4, 6),
        ("near", 42, 48),
        ("near", 48, 62),
        ("surround", 0, 80),
        ("panorama", 64, 160),
        ("dynamic-window", 160, 295),
    ],
)
def test_every_number_is_listed(name, first, last):
    expected = table(part(encoder(name).numbers, first, last))
    assert expected in PAGE, f"the page must hold, for {name}:\n{expected}"


@pytest.mark.parametrize("name", ENCODERS)
def test_sizes_are_true(name):
    assert f"| `{name}` | {encoder(name).size} |" in re.sub(" +", " ", PAGE)


def test_paper_and_ego_differ_in_six_numbers():
    paper, ego = encoder("paper").numbers, encoder("ego").numbers
    assert [k for k in range(62) if paper[k] != ego[k]] == list(range(42, 48))


@pytest.mark.parametrize("name", ["ego", "near", "surround", "panorama", "dynamic-window"])
def test_what_repeats_is_alike(name):
    kept = {}
    for n in encoder(name).numbers:
        found = REPEATED.match(n.name)
        if found:
            key = (found[1], n.name[found.end() :])
            says = re.sub(r"[\d.]+°|command \d+", "°", n.meaning)
            kept.setdefault(key, set()).add((n.unit, n.low, n.high, says))
    assert all(len(kinds) == 1 for kinds in kept.values())
