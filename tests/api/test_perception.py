"""Exact and noisy perception in Python and on the command line."""

from pathlib import Path

import pytest

import benchnav
from benchnav.cli.main import status
from benchnav.errors import UsageError
from benchnav.store.runs.reading import read_results

OLD_RUN = Path(__file__).parents[1] / "store" / "run-of-0.1.0.bnrun"


@pytest.fixture(scope="session")
def both(suite, tmp_path_factory):
    return benchnav.run(
        suite, perception=["exact", "noisy"], out=tmp_path_factory.mktemp("both") / "run",
        workers=0, quiet=True,
    )  # fmt: skip


def test_a_run_tells_its_perceptions(both, run):
    assert both.perceptions == ("exact", "noisy")
    assert run.perceptions == ("exact",)
    product = "1 scenario × 2 tracks × 2 perceptions × 2 navigators × 2 seeds"
    assert repr(both).endswith(f"tiny@1, {product})")
    assert "exact, noisy" in both._repr_html_()
    assert "perception" not in run._repr_html_()


def test_episodes_are_chosen_by_perception(both):
    noisy = both.episodes("orca", track="known", perception="noisy")
    assert [(e.perception, e.seed) for e in noisy] == [("noisy", 0), ("noisy", 1)]
    assert len(both.episodes()) == 2 * len(both.episodes(perception="exact")) == 16
    assert "perception='noisy'" in repr(noisy[0])
    assert "perception" not in repr(both.episodes(perception="exact")[0])
    frame = both.episodes("orca").to_pandas()
    assert list(frame.columns[:5]) == ["navigator", "scenario", "track", "perception", "seed"]
    assert set(frame.perception) == {"exact", "noisy"}
    with pytest.raises(UsageError, match=r"perception must be one that was run.*mean 'noisy'"):
        both.episodes(perception="noise")
    assert len(both.episodes(perception="noisy", failed=True, worst="success")) <= 8


def test_tables_keep_them_apart(both):
    text = both.leaderboard().to_markdown()
    assert "## Track known, noisy perception" in text
    assert "## Price of noise" in text
    frame = both.leaderboard(metrics="success").to_pandas()
    assert set(frame.perception) == {"exact", "noisy", "exact - noisy"}
    assert "noisy perception" in both.compare("orca", "straight-line").to_markdown()
    assert set(both.curve("horizon").to_pandas().perception) == {"exact", "noisy"}


def test_simulating_is_what_a_run_does(both, scenario_file, world):
    salt = both.folder.manifest.salt
    episode = benchnav.simulate(world, "orca", track="unknown", perception="noisy", salt=salt)
    (stored,) = both.episodes("orca", track="unknown", perception="noisy", seed=1)
    assert episode.record.digest == stored.record.digest
    exact = benchnav.simulate(world, "orca", track="unknown", salt=salt)
    assert exact.perception == "exact"
    assert exact.record.digest != episode.record.digest


def test_a_wrong_perception_is_refused_with_the_nearest(suite, world, tmp_path):
    text = "A perception must be one of exact, noisy. Got 'nosy' instead. Did you mean 'noisy'?"
    with pytest.raises(UsageError) as caught:
        benchnav.run(suite, perception="nosy", out=tmp_path / "run", quiet=True)
    assert str(caught.value) == text
    with pytest.raises(UsageError) as caught:
        benchnav.simulate(world, "orca", perception="nosy")
    assert str(caught.value) == text
    assert not (tmp_path / "run").exists()


def test_an_old_run_was_of_exact_perception(both):
    with benchnav.open_run(OLD_RUN) as old:
        assert old.perceptions == ("exact",)
        assert set(read_results(old.folder.path)["perception"].to_pylist()) == {"exact"}
        assert {e.perception for e in old.episodes()[:2]} == {"exact"}
        assert "noisy perception" not in old.leaderboard().to_markdown()


def command(capsys, *arguments):
    found = status([str(argument) for argument in arguments])
    return found, *capsys.readouterr()


def test_the_command_line_chooses_the_perception(scenario_file, tmp_path, capsys):
    run = tmp_path / "run"
    common = ("run", scenario_file, "--navigator", "orca", "--seeds", 1, "--workers", 0)
    found, out, err = command(
        capsys, *common, "--perception", "exact", "--perception", "noisy", "--out", run
    )
    assert (found, out) == (0, f"{run}\n")
    assert "1 scenario × 1 track × 2 perceptions × 1 navigator × 1 seed" in err
    found, out, _ = command(capsys, "replay", run, "--perception", "noisy", "--list")
    assert found == 0
    assert out.splitlines()[1].startswith("orca/tiny/open@1/known/noisy/0 ")
    assert len(out.splitlines()) == 2
    page = tmp_path / "page.html"
    for name in ("orca/tiny/open@1/known/noisy/0", "orca/tiny/open/known/noisy/0"):
        assert command(capsys, "replay", run, name, "--out", page)[0] == 0
        assert '"perception":"noisy"' in page.read_text().replace(": ", ":")
    found, _, err = command(capsys, "replay", run, "orca/tiny/open@1/known/nosy/0")
    assert (found, "Did you mean 'orca/tiny/open@1/known/noisy/0'" in err) == (2, True)
    for arguments in (common[:-2], ("watch", scenario_file, "orca")):
        found, _, err = command(capsys, *arguments, "--perception", "noise")
        assert (found, "Did you mean 'noisy'?" in err) == (2, True)


def test_watching_shows_the_perception(scenario_file, tmp_path, capsys):
    found, _, err = command(
        capsys, "watch", scenario_file, "orca", "--perception", "noisy", "--no-open",
        "--out", tmp_path / "page.html",
    )  # fmt: skip
    assert found == 0
    assert "perception='noisy'" in err


def test_a_suite_is_shown_with_its_perceptions(scenario_file, tmp_path, capsys):
    assert "perception  exact" in command(capsys, "show", "quick")[1]
    assert '"perception"' in command(capsys, "schema", "suite")[1]
    suite = tmp_path / "suite.yaml"
    lines = f"name: small\nscenarios: [{scenario_file}]\nnavigators: [orca]\n"
    suite.write_text(f"{lines}perception: [exact, noisy]\n")
    assert "2 cells, 0 of them n/a" in command(capsys, "validate", suite)[1]
    suite.write_text(f"{lines}perception: [noise]\n")
    found, out, err = command(capsys, "validate", suite)
    assert found == 2
    assert "suite.yaml:4: perception[0]" in out + err
    assert "Did you mean 'noisy'?" in out + err
