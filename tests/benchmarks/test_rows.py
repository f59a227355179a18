"""`make bench` keeps a table only of rows that were all measured."""

import sys

import pytest

from benchmarks import __main__ as bench
from benchmarks import orca_peers

OWN = {"name": "benchnav", "version": "1", "agent_steps_per_second": 9e5}
PEER = {"name": "pyrvo", "version": "2", "agent_steps_per_second": 3e5, "ratio": 3, "wanted": 4}
LIMIT = {"name": "start", "value": 0.2, "unit": "s", "wanted": 0.4, "ratio": 2.0}


@pytest.fixture
def measured(monkeypatch, tmp_path):
    """Run the command with these rows of the crowd; return the file of its table."""

    def run(*crowd):
        out = tmp_path / "table.md"
        monkeypatch.setattr(sys, "argv", ["benchmarks", "--peers", "python", "--out", str(out)])
        monkeypatch.setattr(orca_peers, "measure", lambda peers: list(crowd))
        for part in (bench.leader_arena, bench.isolation):
            monkeypatch.setattr(part, "measure", list)
        monkeypatch.setattr(bench.end_to_end, "measure", lambda: [LIMIT])
        out.unlink(missing_ok=True)
        try:
            bench.main()
        finally:
            run.kept = out.exists()
        return out.read_text()

    return run


def test_what_was_measured_is_kept(measured):
    text = measured(OWN, PEER)
    assert (
        "| ORCA crowd of 1,000 against pyrvo 2 | 0.90 M agent-steps/s | 0.30 M: 3.0 × | 4 × | no |"
    ) in text
    assert "| start | 0.2 s | – | 0.4 s | yes |" in text


@pytest.mark.parametrize(
    ("crowd", "cause"),
    [
        ((OWN, {"name": "pyrvo", "skipped": "pyrvo is not installed"}), "pyrvo is not installed"),
        (({"name": "benchnav", "skipped": "benchnav failed"}, PEER), "benchnav failed"),
    ],
)
def test_a_row_that_was_not_measured_fails(measured, crowd, cause):
    crowd = [{key: row[key] for key in row if key not in ("ratio", "wanted")} for row in crowd]
    with pytest.raises(SystemExit) as failed:
        measured(*crowd)
    assert not measured.kept
    assert failed.value.code.startswith("Not measured, so no table was kept:\n")
    assert "ORCA crowd of 1,000 against pyrvo" in failed.value.code
    assert failed.value.code.endswith(f": {cause}")


def test_the_peers_must_be_given(monkeypatch, capsys):
    monkeypatch.setattr(sys, "argv", ["benchmarks"])
    with pytest.raises(SystemExit) as failed:
        bench.main()
    assert failed.value.code == 2
    assert "--peers" in capsys.readouterr().err


def test_a_peer_that_is_not_installed_says_so(monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    assert "is not installed" in orca_peers.ask(sys.executable, "pyrvo")["skipped"]


@pytest.mark.slow
def test_parts_do_not_find_our_files_in_place_of_packages(monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    assert orca_peers.ask(sys.executable, "benchnav")["seconds"] > 0
