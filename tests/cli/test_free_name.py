"""Names for a new package that nothing else has."""

import pytest

from benchnav.api.authoring.free_name import name_taken

TAKEN = (
    "json", "random", "numpy", "torch", "benchnav", "benchnav-baselines", "benchnav-scenarios",
    "class", "import", "none", "true", "match", "print", "list", "orca", "ompl-orca", "pip",
    "pyyaml", "yaml", "stable-baselines3", "python-fcl", "winreg", "pytest", "ray", "matplotlib",
)  # fmt: skip


@pytest.mark.parametrize("name", TAKEN)
def test_a_name_that_is_taken_is_refused_with_one_that_is_free(call, tmp_path, name):
    code, stdout, stderr = call("new", "navigator", name, "--out", tmp_path / "out")
    assert (code, stdout) == (2, "")
    assert "The name must be free. " in stderr
    assert f"'my-{name}' is free." in stderr
    assert not (tmp_path / "out").exists()
    assert call("new", "navigator", f"my-{name}", "--out", tmp_path / "out")[0] == 0


def test_the_suggestion_is_free_too(call, tmp_path, monkeypatch):
    (tmp_path / "my_json.py").touch()
    (tmp_path / "my_json_2.py").touch()
    monkeypatch.syspath_prepend(tmp_path)
    assert "'my-json-3' is free." in call("new", "navigator", "json")[2]


@pytest.mark.parametrize("name", ["keep-away", "my-idea", "walker2"])
def test_other_names_are_free(name):
    assert name_taken(name) == ""
