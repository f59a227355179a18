"""`benchnav.available`, `show` and `doctor`."""

import pytest

import benchnav
from benchnav.errors import UsageError
from tests.installed import install


def test_names_are_known_without_an_import(monkeypatch, tmp_path):
    install(monkeypatch, tmp_path / "site", "", navigators={"gone": "no_such_module:Thing"})
    found = benchnav.available("navigators")
    assert {"orca", "gone"} <= set(found)
    assert "orca" in found
    assert "orac" not in found
    assert list(found) == sorted(found)
    assert repr(found).startswith("Catalogue(navigators: gone, guided-crowd, ")
    assert "entries" not in vars(found)


def test_descriptions_are_those_of_the_command(monkeypatch, tmp_path, capfd):
    install(monkeypatch, tmp_path / "site", "", navigators={"gone": "no_such_module:Thing"})
    found = benchnav.available("navigators")
    assert found["orca"].startswith("Optimal reciprocal")
    assert "No module named 'no_such_module'" in found["gone"]
    assert list(found.broken) == ["gone"]
    with pytest.raises(KeyError, match="orac"):
        _ = found["orac"]
    assert str(found).splitlines()[0].startswith("gone  ")
    assert "<td>orca</td>" in found._repr_html_()


def test_all_kinds_are_a_dict():
    found = benchnav.available()
    assert list(found) == [
        "navigators", "planners", "controllers", "scenarios", "robots", "suites", "metrics",
        "trainers", "recipes",
    ]  # fmt: skip
    assert found["scenarios"]["trap/u"] == "A dead end between start and goal"
    assert "quick" in found["suites"]
    assert found["recipes"]["dynamic"]
    assert len(found["metrics"]) == len(list(found["metrics"]))


def test_another_kind_is_refused_with_the_nearest():
    with pytest.raises(UsageError, match="Did you mean 'navigators'"):
        benchnav.available("navigator")


@pytest.mark.parametrize(
    ("name", "part"),
    [("orca", "a navigator: Optimal"), ("trap/u", "a scenario: "), ("quick", "a suite"),
     ("dynamic", "a recipe of the trainer"), ("spl", "Anderson"), ("grid.astar+orca", "planner")],
)  # fmt: skip
def test_a_page_shows_itself(name, part):
    page = benchnav.show(name)
    assert page.name == name
    assert part in page.text
    assert repr(page) == page.text
    assert page._repr_html_().startswith("<pre>")


def test_an_unknown_component_is_refused_with_the_nearest():
    with pytest.raises(UsageError, match=r"no component 'orac'\. Did you mean 'orca'\?"):
        benchnav.show("orac")


def test_a_diagnosis_is_true_if_nothing_is_wrong(monkeypatch, tmp_path):
    found = benchnav.doctor()
    assert found
    assert {"python", "cores", "navigators"} <= {check.subject for check in found.checks}
    assert repr(found) == found.text()
    assert "<td>python</td>" in found._repr_html_()
    install(monkeypatch, tmp_path / "site", "", navigators={"gone": "no_such_module:Thing"})
    found = benchnav.doctor()
    assert not found.healthy
    (wrong,) = (check for check in found.checks if check.verdict == "WRONG")
    assert "'gone'" in wrong.detail
