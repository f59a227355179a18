"""`benchnav.train`, with a trainer that this process registers."""

from pathlib import Path

import pytest
from pydantic import BaseModel, ConfigDict

import benchnav
from benchnav.envs.trainer import Trainer, TrainingReport
from benchnav.errors import ScenarioError, UsageError
from benchnav.plugins import TRAINERS


class CountRecipe(BaseModel):
    model_config = ConfigDict(extra="forbid")

    trainer: str
    name: str = "count"
    decisions: int


class Count(Trainer[CountRecipe]):
    """Writes its arguments as weights."""

    Recipe = CountRecipe
    recipes = Path(__file__).parent / "no recipes"

    def train(self, recipe, seed, out, *, resume, device, report):
        if recipe.decisions < 0:
            raise KeyboardInterrupt
        report(TrainingReport(recipe.decisions, recipe.decisions, 0.5))
        out.mkdir(parents=True)
        (out / "weights.safetensors").write_text(f"{seed} {resume} {device}")


RECIPE = {"trainer": "count", "decisions": 10}


@pytest.fixture(autouse=True)
def trainer(monkeypatch):
    monkeypatch.setitem(TRAINERS._local, "count", (Count, "test:Count"))


def test_it_returns_the_folder_and_the_weights(tmp_path, capfd):
    done = benchnav.train(RECIPE, seed=3, out=tmp_path / "out")
    assert done.path == tmp_path / "out"
    assert done.weights.read_text() == "3 False cpu"
    assert repr(done) == f"Training('count', seed=3: '{done.weights}')"
    assert "<table>" in done._repr_html_()
    assert capfd.readouterr() == (
        "",
        f"count, seed 3, into {done.path}\n10 of 10 decisions, validation success 50.0 %\n",
    )


def test_a_file_is_a_recipe_and_quiet_prints_nothing(tmp_path, capfd, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("r.yaml").write_text("trainer: count\ndecisions: 1\n")
    done = benchnav.train(Path("r.yaml"), device="cuda", resume=True, quiet=True)
    assert done.weights.read_text() == "0 True cuda"
    assert done.path.parent == Path("runs")
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize(
    ("recipe", "text"),
    [
        ({"decisions": 1}, "recipe:1: the key 'trainer' is missing: .* Add the line 'trainer: NAME'"
         " with one of these names: .*count"),
        ({**RECIPE, "trainer": "cuont"}, "recipe:1: trainer must be one of .*Did you mean 'count'"),
        ({**RECIPE, "decisions": "x"}, "recipe:2: decisions must be a whole number; got 'x'"),
        ({**RECIPE, "decisions": 1j}, "recipe: every value must be"),
    ],
)  # fmt: skip
def test_a_wrong_recipe_is_named_with_the_cure(recipe, text, tmp_path):
    with pytest.raises(ScenarioError, match=text):
        benchnav.train(recipe, out=tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_an_unknown_name_or_seed_is_refused():
    with pytest.raises(UsageError, match="no recipe 'dynamik'"):
        benchnav.train("dynamik")
    with pytest.raises(UsageError, match="must be a whole number from 0"):
        benchnav.train(RECIPE, seed=-1)


def test_an_interruption_says_how_to_continue(tmp_path):
    with pytest.raises(KeyboardInterrupt) as stopped:
        benchnav.train({**RECIPE, "decisions": -1}, out=tmp_path / "out", quiet=True)
    (note,) = stopped.value.__notes__
    assert str(tmp_path / "out") in note
    assert "resume" in note
