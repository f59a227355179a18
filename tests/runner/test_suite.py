"""A suite is a lazy product, and says beforehand which of its cells cannot be."""

from hashlib import sha256
from pathlib import Path

import pytest

from benchnav.errors import ConfigError, ScenarioError, UnknownPluginError, UsageError
from benchnav.runner.plan.suite import Selection, load_suite
from benchnav.runner.plan.suite_file import suite_names
from benchnav.scenario.catalogue import names

STANDARD_WORLDS = "2924b1be7b8dcdae"
SHIPPED = Path(__file__).parents[2] / "scenarios"


@pytest.fixture
def write(tmp_path, scenario_file, troubled):
    def write(**lines):
        said = {
            "name": "small", "scenarios": f"[{scenario_file}]",
            "navigators": "[straight-line, orca]", "tracks": "[known, unknown]", "seeds": "3",
            **lines,
        }  # fmt: skip
        path = tmp_path / "suite.yaml"
        path.write_text("".join(f"{key}: {value}\n" for key, value in said.items()))
        return str(path)

    return write


MAPPERS = "[mapping+visibility+orca, mapping+navmesh+orca]"
ONE, TWO = "mapping+visibility+orca", "mapping+navmesh+orca"


def test_cells_are_every_scenario_track_and_navigator(write):
    jobs = list(load_suite(write(navigators=MAPPERS)).jobs())
    assert [(c.track, c.contestant.label) for c in jobs] == [
        ("known", ONE), ("known", TWO), ("unknown", ONE), ("unknown", TWO),
    ]  # fmt: skip
    assert len({job.key for job in jobs}) == 4
    assert all(job.reason == "" for job in jobs)


def test_a_cell_that_cannot_work_says_why(write, troubled):
    (troubled / "needy.py").write_text(
        "from benchnav.navigation.navigator import Navigator, Need\n"
        "class Maps(Navigator):\n"
        "    needs = frozenset({Need.MAP})\n"
        "    def act(self, observation): return observation.velocity\n"
    )
    suite = load_suite(write(navigators="['needy:Maps']", tracks="[known, stale, unknown]"))
    reasons = {job.track: job.reason for job in suite.jobs()}
    assert reasons == {
        "known": "",
        "stale": "the scenario has no track 'stale'",
        "unknown": "needs a map",
    }


def test_a_sensor_that_nobody_has_makes_a_cell_n_a(write, scenario_file, tmp_path):
    blind = tmp_path / "blind.yaml"
    blind.write_text(scenario_file.read_text() + "sensing: {neighbours: null}\n")
    suite = load_suite(write(scenarios=f"[{blind}]", tracks="[known]"))
    reasons = {job.contestant.label: job.reason for job in suite.jobs()}
    assert reasons == {
        "straight-line": "", "orca": "needs neighbours, which no sensor gives there"
    }  # fmt: skip


def test_the_same_navigator_with_other_parameters_is_another_entry(write):
    suite = load_suite(
        write(navigators="[orca, {type: orca, label: far-sighted, time_horizon: 9.0}]")
    )
    near, far = suite.contestants
    assert (near.label, far.label) == ("orca", "far-sighted")
    assert near.spec["type"] == far.spec["type"] == "orca"
    assert near.spec != far.spec
    keys = [job.key for job in suite.jobs()]
    assert len(set(keys)) == len(keys)


def test_what_is_selected_replaces_what_the_file_says(write):
    path = write()
    suite = load_suite(path, Selection((), ("partial",), ("orca", "random-walk"), "7:9"))
    assert suite.tracks == ("partial",)
    assert [contestant.label for contestant in suite.contestants] == ["orca", "random-walk"]
    assert suite.seeds == range(7, 9)


def test_what_has_no_say_in_the_results_is_not_in_the_resolved_suite(write, tmp_path):
    one = load_suite(write()).resolved()
    other = load_suite(write(description="something else")).resolved()
    assert one == other
    assert load_suite(write(seeds="4")).resolved() != one


@pytest.mark.parametrize(
    ("lines", "kind", "complaint"),
    [
        ({"navigators": "[orca, orca]"}, UsageError, "'orca' more than once"),
        ({"tracks": "[known, known]"}, UsageError, "'known' more than once"),
        ({"navigators": "[orac]"}, UnknownPluginError, "Did you mean 'orca'"),
        ({"navigators": "[{type: orca, time_horizn: 3.0}]"}, ConfigError, "suite.yaml:3: "),
        ({"navigators": "[{type: orca, label: ''}]"}, ScenarioError, "label must have 1 to 80"),
        ({"scenarios": "[no/such]"}, UnknownPluginError, "No scenario is called 'no/such'"),
        ({"scenarios": "[gone.yaml]"}, ScenarioError, "gone.yaml:1: cannot be read"),
    ],
)
def test_mistakes_are_named(write, lines, kind, complaint):
    with pytest.raises(kind) as refused:
        load_suite(write(**lines))
    assert complaint in str(refused.value)


def test_a_wrong_selection_is_asked_wrongly(write):
    with pytest.raises(UsageError, match="Did you mean 'known'"):
        load_suite(write(), Selection(tracks=("knwon",)))
    with pytest.raises(UsageError, match="seeds must be N"):
        load_suite(write(), Selection(seeds="x"))
    for wrong in ("x", "abc", "00" * 65):
        with pytest.raises(UsageError, match="The salt must be 1 to 64 bytes"):
            load_suite(write(), Selection(salt=wrong))


@pytest.mark.parametrize(
    ("selection", "complaint"),
    [
        (Selection(navigators=("orca", "orca")), "The navigators must be named once each"),
        (Selection(navigators=("orca", "{type: orca}")), "as 'orca' and as '{type: orca}'"),
        (Selection(tracks=("known", "known")), "The tracks must be named once each"),
        (Selection(scenarios=("trap/u", "trap/u@1")), "The scenarios must be named once each"),
        (
            Selection(scenarios=("trap/u", "trap/u@1")),
            "named more than once, as 'trap/u' and as 'trap/u@1'",
        ),
    ],
)
def test_a_name_that_is_selected_twice_is_not_blamed_on_the_file(write, selection, complaint):
    path = write()
    with pytest.raises(UsageError) as refused:
        load_suite(path, selection)
    assert complaint in str(refused.value)
    assert "suite.yaml" not in str(refused.value)


def test_what_stands_twice_in_the_file_is_blamed_on_its_line(write):
    with pytest.raises(UsageError, match=r"suite\.yaml:\d+: navigators\[2\] .* navigators\[0\]"):
        load_suite(write(navigators="[orca, straight-line, orca]"))


def test_a_navigator_can_be_written_out_where_it_is_selected(write):
    written = "{type: orca, label: far-sighted, time_horizon: 9.0}"
    suite = load_suite(write(), Selection(navigators=("orca", written)))
    assert [contestant.label for contestant in suite.contestants] == ["orca", "far-sighted"]
    assert suite.contestants[1].spec["time_horizon"] == 9.0
    with pytest.raises(ScenarioError, match="navigators:1"):
        load_suite(write(), Selection(navigators=("{type: orca",)))


@pytest.mark.parametrize("name", suite_names())
def test_what_ships_can_be_loaded_and_every_navigator_can_run_somewhere(name):
    suite = load_suite(name)
    assert suite.name == name
    assert suite.split == "test"
    for contestant in suite.contestants:
        assert any(job.reason == "" for job in suite.jobs() if job.contestant is contestant)


def test_quick_is_a_first_look_at_five_navigators():
    suite = load_suite("quick")
    assert len(suite.scenarios) >= 4
    assert len(suite.contestants) >= 5
    assert len(suite.seeds) >= 20


def test_full_has_every_scenario_that_ships():
    shipped = {name for name in names() if (SHIPPED / f"{name}.yaml").is_file()}
    assert shipped
    assert {scenario.name for scenario in load_suite("full").scenarios} == shipped


BLOCKS = f"[{{tracks: [known], navigators: [{TWO}]}}, {{tracks: [unknown]}}]"


def test_blocks_are_the_parts_of_the_product_that_are_run(write):
    suite = load_suite(write(navigators=MAPPERS, blocks=BLOCKS))
    assert [(c.track, c.contestant.label) for c in suite.jobs()] == [
        ("known", TWO), ("unknown", ONE), ("unknown", TWO),
    ]  # fmt: skip
    assert suite.resolved()["blocks"][0]["navigators"] == (TWO,)
    assert "blocks" not in load_suite(write()).resolved()


def test_what_is_selected_from_outside_the_file_is_in_every_block(write):
    chosen = Selection(navigators=(TWO, "ompl-orca"), tracks=("known", "partial"))
    suite = load_suite(write(navigators=MAPPERS, blocks=BLOCKS), chosen)
    jobs = [(c.track, c.contestant.label) for c in suite.jobs()]
    assert jobs == [
        ("known", TWO), ("known", "ompl-orca"), ("partial", TWO), ("partial", "ompl-orca"),
    ]  # fmt: skip


def test_a_block_names_what_the_suite_has(write):
    path = write(blocks="[{navigators: [orka]}]")
    with pytest.raises(ScenarioError, match=r"blocks\[0\]\.navigators must be among.*'orka'.*orca"):
        load_suite(path)


def test_who_uses_no_map_runs_once_for_all_tracks(write):
    suite = load_suite(write(navigators="[orca, ompl-pure]", tracks="[known, stale, unknown]"))
    jobs = [(c.track, c.contestant.label, c.also, bool(c.reason)) for c in suite.jobs()]
    assert jobs == [
        ("known", "ompl-pure", (), False),
        ("stale", "orca", (), True),
        ("stale", "ompl-pure", (), True),
        ("unknown", "orca", ("known",), False),
        ("unknown", "ompl-pure", (), True),
    ]
    assert suite.resolved()["navigators"][0]["uses_map"] is False


def test_the_worlds_of_the_standard_suite_are_those_of_its_version():
    suite = load_suite("standard")
    worlds = [*((s.identity, s.hash) for s in suite.scenarios), suite.tracks, suite.split]
    assert suite.version == 2  # the worlds of version 1, other navigators
    assert sha256(repr(worlds).encode()).hexdigest()[:16] == STANDARD_WORLDS, (
        "the worlds of the suite changed: raise its version, say so in the changelog"
    )
