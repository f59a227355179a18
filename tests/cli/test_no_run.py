"""A folder or file that is no run is wrong usage; a damaged run is failed work."""

import pytest

VERBS = [
    ("leaderboard", "RUN"), ("leaderboard", "RUN", "--curve", "horizon"), ("verify", "RUN"),
    ("compare", "RUN", "a", "b"), ("pack", "RUN"), ("merge", "RUN", "--out", "merged"),
]  # fmt: skip


@pytest.fixture
def places(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "empty").mkdir()
    (tmp_path / "table.csv").write_text("a,b\n")
    (tmp_path / "cut.bnrun").touch()


@pytest.mark.parametrize("verb", VERBS)
@pytest.mark.parametrize("place", ["gone", "empty", "table.csv", "cut.bnrun", "gone/below"])
def test_what_is_no_run_is_asked_wrongly(call, places, verb, place):
    code, stdout, stderr = call(*(place if word == "RUN" else word for word in verb))
    assert (code, stdout) == (2, "")
    assert f"{place} must be a run folder" in stderr


@pytest.mark.parametrize("verb", VERBS)
def test_a_damaged_run_is_work_that_failed(call, places, tmp_path, verb):
    (tmp_path / "empty" / "manifest.json").write_text("{")
    code, _, stderr = call(*("empty" if word == "RUN" else word for word in verb))
    assert code == 1
    assert "is damaged" in stderr
