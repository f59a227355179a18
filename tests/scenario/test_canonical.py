"""Hashes of scenarios outlive new and renamed keys."""

import json
from pathlib import Path

import pytest
from pydantic import Field

from benchnav.scenario.base import Spec
from benchnav.scenario.canonical import added_field, canonical, renamed_field
from benchnav.scenario.catalogue import find

HASHES = json.loads((Path(__file__).parent / "hashes_0_1.json").read_text())


class Old(Spec):
    """A part as it was."""

    radius: float = 0.3
    names: tuple[str, ...] = ()


class New(Spec):
    """The same part today."""

    size: float = renamed_field("radius", 0.3, gt=0)
    names: tuple[str, ...] = ()
    colour: str = added_field("red", "0.2.0")
    limits: dict[str, float] = added_field({}, "0.2.0")


class Whole(Spec):
    """Holds parts."""

    one: Old | New
    many: tuple[Old | New, ...] = ()
    named: dict[str, Old | New] = Field({})
    none: Old | New | None = None


def test_added_and_renamed_keys_change_nothing_while_they_have_their_defaults():
    old, new = Old(radius=0.5, names=("a",)), New(size=0.5, names=("a",))
    assert canonical(new) == canonical(old) == {"radius": 0.5, "names": ["a"]}
    before = Whole(one=old, many=(old, old), named={"x": old})
    after = Whole(one=new, many=(new, new), named={"x": new})
    assert json.dumps(canonical(after)) == json.dumps(canonical(before))


def test_a_key_that_was_added_counts_once_it_is_set():
    assert canonical(New(colour="blue"))["colour"] == "blue"
    assert canonical(New(limits={"speed": 1.0}))["limits"] == {"speed": 1.0}


def test_old_keys_count_also_at_their_default_and_excluded_keys_do_not():
    assert canonical(Whole(one=Old()), exclude={"named"}) == {
        "one": {"radius": 0.3, "names": []}, "many": [], "none": None,
    }  # fmt: skip


@pytest.mark.parametrize("name", sorted(HASHES))
def test_hashes_of_version_0_1_0(name):
    assert find(name).hash == HASHES[name]
