"""The sentence about the best navigators, and commands for more worlds."""

from types import SimpleNamespace

import pytest

from benchnav.report.analysis.best import best_of, more_seeds


def ranked(name, low, high):
    return SimpleNamespace(
        navigator=name, metric="success", rank_low=low, rank_high=high, episodes=20
    )


@pytest.mark.parametrize(
    ("places", "text", "is_tied"),
    [
        ({"a": (1, 1), "b": (2, 3), "c": (2, 3)},
         "a is significantly better in success than each of the others.", False),
        ({"a": (1, 2), "b": (1, 2), "c": (3, 3)},
         "a and b share the first place in success; these 20 worlds do not separate them.", True),
        ({"a": (1, 3), "b": (1, 3), "c": (1, 3)},
         "no navigator is separated from the others in success by these 20 worlds.", True),
        ({"a": (1, 2), "b": (2, 3), "c": (2, 3)},
         "a has the first place in success; these 20 worlds do not separate it from each of the"
         " others.", True),
    ],
)  # fmt: skip
def test_a_sentence_names_the_best(places, text, is_tied):
    best = best_of([ranked(name, *place) for name, place in places.items()])
    assert (best.text, best.is_tied) == (text, is_tied)


def test_one_ranked_navigator_is_not_compared():
    assert best_of([ranked("a", 1, 1), ranked("b", None, None)]) is None


def test_many_names_are_cut():
    best = best_of([*(ranked(f"n{k}", 1, 9) for k in range(9)), ranked("last", 10, 10)])
    assert "n5 and 3 others share" in best.text


@pytest.mark.parametrize(
    ("command", "seeds", "expected"),
    [
        ("benchnav run quick --out runs/a", [0, 5], "benchnav run quick --out runs/a --seeds 20"),
        ("benchnav run quick", [3, 5], "benchnav run quick --out 'my run' --seeds 3:11"),
        ("make.py", [0, 2], "benchnav run mine --out 'my run' --seeds 8"),
    ],
)
def test_a_command_continues_the_run(command, seeds, expected):
    manifest = SimpleNamespace(
        suite={"name": "mine", "seeds": seeds}, provenance={"command": command}
    )
    assert list(more_seeds([SimpleNamespace(manifest=manifest, shown="my run")])) == [expected]
