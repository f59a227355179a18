"""Navigators can be told apart in figures, with and without colours."""

from itertools import pairwise

import pytest

from benchnav.drawing.palette import NAVIGATORS, rgb
from benchnav.report.line_style import line_styles

DARK = "#14181d"


def luminance(color):
    linear = [x / 12.92 if x <= 0.04045 else ((x + 0.055) / 1.055) ** 2.4 for x in rgb(color)]
    return sum(w * x for w, x in zip((0.2126, 0.7152, 0.0722), linear, strict=True))


@pytest.mark.parametrize("color", NAVIGATORS)
def test_colours_are_seen_on_white_and_on_dark_pages(color):
    assert 1.05 / (luminance(color) + 0.05) >= 3
    assert (luminance(color) + 0.05) / (luminance(DARK) + 0.05) >= 3


def test_no_two_navigators_look_the_same():
    styles = list(line_styles([f"n{k}" for k in range(48)]).values())
    assert len({(style.color, style.dash) for style in styles}) == 48
    assert all(a.dash != b.dash and a.symbol != b.symbol for a, b in pairwise(styles[:12]))
