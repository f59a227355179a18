"""`benchnav.make_env`."""

import pytest

import benchnav
from benchnav.errors import UsageError


@pytest.mark.parametrize("kind", ["vector", "sb3", "gymnasium", "pettingzoo"])
def test_every_kind_of_environment_is_made(kind, scenario_file):
    scenario = benchnav.load_scenario(scenario_file)
    sizes = {"num_worlds": 3} if kind in ("vector", "sb3") else {}
    others = {"others": "orca"} if kind == "gymnasium" else {}
    env = benchnav.make_env(scenario, kind=kind, worlds=2, **sizes, **others)
    env.reset()
    if sizes:
        assert env.num_envs == 3 * 2
    else:
        assert env.batch.width == 2


def test_the_default_is_a_vector_of_four_worlds(scenario_file):
    assert benchnav.make_env(str(scenario_file), worlds=2).num_envs == 4 * 2


@pytest.mark.parametrize(
    ("options", "text"),
    [
        ({"kind": "sb4"}, "Did you mean 'sb3'"),
        ({"kind": "gymnasium", "num_worlds": 2}, "num_worlds is for the kinds vector and sb3"),
        ({"kind": "gymnasium"}, "needs others=NAME"),
        ({"others": "orca"}, "others is for the kind gymnasium"),
        ({"num_worlds": 0}, "at least 1 world at once"),
        ({"split": "test"}, "train or validation"),
    ],
)
def test_mistakes_are_explained(scenario_file, options, text):
    with pytest.raises(UsageError, match=text):
        benchnav.make_env(str(scenario_file), worlds=2, **options)
