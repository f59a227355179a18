"""The generated pages of docs/ are those of the code."""

import importlib.util
import re

import pytest

from benchnav.scenario.catalogue import names
from tests.docs.blocks import ROOT


def program(name):
    """A program of docs/ as a module."""
    spec = importlib.util.spec_from_file_location(name, ROOT / f"docs/{name}.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


MAKER = program("make_reference")


@pytest.mark.parametrize("file", MAKER.PAGES)
def test_a_page_is_up_to_date(file):
    kept = (ROOT / "docs" / file).read_text(encoding="utf-8")
    assert kept == MAKER.PAGES[file](), "Write it again: python docs/make_reference.py"


def test_the_keys_of_motion_laws_are_listed():
    text = MAKER.scenario_keys()
    law = text.partition("## BackAndForth")[2].partition("\n## ")[0]
    assert "| `direction` | number or distribution | `{uniform: [0.0, 2π]}` | rad |" in law


def test_fields_have_shape_unit_and_meaning():
    text = MAKER.observations()
    assert (
        "| `distance` | (B, A, R) [m] until the ray (thick: its disc) hits; else the range |"
        in text
    )
    assert "| `row` | number of the world from `reset` to the end of its episode |" in text


def test_every_type_of_the_keys_is_in_a_group_and_pictures_are_small():
    assert "## Other types" not in MAKER.scenario_keys()
    for picture, text, _ in MAKER.GROUPS.values():
        file = ROOT / "docs/images/keys" / f"{picture}.png"
        assert not picture or (text and file.stat().st_size <= 40_000)


def test_the_gallery_shows_every_scenario_and_episode():
    maker = program("make_gallery")
    text = (ROOT / "docs/gallery.md").read_text(encoding="utf-8")
    assert text == maker.page(), "Write it again: python docs/make_gallery.py"
    files = re.findall(r'(?:src="|\]\()((?:_static|images)/[^")]+)', text)
    assert len(files) == len(maker.EPISODES) + len(names())
    assert all((ROOT / "docs" / file).is_file() for file in files)
