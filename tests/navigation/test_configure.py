from typing import ClassVar, Literal

import pytest
from pydantic import Field

from benchnav.errors import BrokenPluginError, ConfigError, MissingExtraError, UnknownPluginError
from benchnav.navigation.navigator import PluginConfig
from benchnav.navigation.plugin.configure import configure, make, split
from benchnav.plugins import Registry


class Every(PluginConfig):
    every: float = Field(gt=0)


class Deep(PluginConfig):
    radius: float = 1.0


class Mild:
    class Config(PluginConfig):
        time_horizon: float = Field(5.0, gt=0, description="[s]")
        name: str = "x"
        when: Literal["never", "always"] | Every = "never"
        deep: Deep = Deep()

    def __init__(self, config=None):
        self.config = config if config is not None else self.Config()


class Strict:
    class Config(PluginConfig):
        must: int


class Empty:
    Config: ClassVar = PluginConfig

    def __init__(self, config=None):
        self.config = config


class Failing(Empty):
    def __init__(self, config=None):
        raise RuntimeError("no luck")


class WithoutExtra(Empty):
    def __init__(self, config=None):
        raise MissingExtraError("It", "plan")


@pytest.fixture
def registry():
    kinds = Registry("benchnav.test_things", "thing")
    for thing in (Mild, Strict, Empty, Failing, WithoutExtra):
        kinds.register(thing.__name__.lower())(thing)
    kinds.register("function")(len)
    return kinds


def test_a_name_is_made_with_its_defaults(registry):
    thing = make(registry, "mild")
    assert isinstance(thing, Mild)
    assert thing.config == Mild.Config()


def test_a_mapping_gives_parameters(registry):
    assert make(registry, {"type": "mild", "time_horizon": 2}).config.time_horizon == 2.0


def test_split_leaves_the_spec_alone(registry):
    spec = {"type": "mild", "name": "y"}
    assert split(registry, spec) == ("mild", {"name": "y"})
    assert spec == {"type": "mild", "name": "y"}


def test_configure_constructs_nothing(registry):
    plugin, config = configure(registry, "failing")
    assert plugin is Failing
    assert config == PluginConfig()


@pytest.mark.parametrize(
    ("spec", "message"),
    [
        (
            {"type": "mild", "time_horizn": 2},
            "The thing 'mild' has no parameter 'time_horizn'. Did you mean 'time_horizon'?",
        ),
        (
            {"type": "mild", "zz": 2},
            "The thing 'mild' has no parameter 'zz'."
            " There is 'time_horizon', 'name', 'when', 'deep'.",
        ),
        ({"type": "empty", "zz": 2}, "The thing 'empty' has no parameter 'zz'. It has none."),
        (
            {"type": "mild", "time_horizon": -3},
            "The parameter 'time_horizon' of the thing 'mild' must be > 0. Got -3 instead.",
        ),
        (
            {"type": "mild", "time_horizon": float("nan")},
            "The parameter 'time_horizon' of the thing 'mild' must be finite. Got nan instead.",
        ),
        (
            "strict",
            "The thing 'strict' must be given the parameter 'must'. Got nothing instead.",
        ),
        (
            {"type": "mild", "deep": {"radus": 1}},
            "The thing 'mild' has no parameter 'deep.radus'. Did you mean 'radius'?",
        ),
        (
            {"type": "mild", "when": 7},
            "The parameter 'when' of the thing 'mild' must be 'never' or 'always', or a mapping."
            " Got 7 instead.",
        ),
        (
            {"type": "mild", "when": {"evry": 1}},
            "The parameter 'when' of the thing 'mild' must be 'never' or 'always', or a mapping"
            " with 'every', or a mapping without 'evry'. Got {'evry': 1} instead.",
        ),
        (7, "A thing must be a name or {type: name, …parameters}. Got 7 instead."),
        (
            {"tpye": "mild"},
            "A thing must be a name or {type: name, …parameters}. Got no 'type' among 'tpye'"
            " instead. Should 'type' be written for 'tpye'?",
        ),
        (
            {1: "mild"},
            "A thing must be a name or {type: name, …parameters}. Got the key 1, which is not"
            " text, instead.",
        ),
        (
            {"type": ["mild"]},
            "A thing must be a name or {type: name, …parameters}. Got the type ['mild'] instead.",
        ),
    ],
)
def test_what_is_refused_and_how(registry, spec, message):
    with pytest.raises(ConfigError) as caught:
        make(registry, spec)
    assert str(caught.value) == message


def test_every_mistake_is_named_and_the_place_once(registry):
    with pytest.raises(ConfigError) as caught:
        make(
            registry,
            {"type": "mild", "time_horizon": 0, "nam": ""},
            where="s.yaml:3: navigators[0]",
        )
    place, _, rest = str(caught.value).partition("The ")
    assert place == "s.yaml:3: navigators[0]: "
    assert "'time_horizon'" in rest
    assert "Did you mean 'name'?" in rest


def test_a_huge_value_is_cut_short(registry):
    with pytest.raises(ConfigError) as caught:
        make(registry, {"type": "mild", "time_horizon": "9" * 500 + "x"})
    assert len(str(caught.value)) < 250


def test_an_unknown_name_stays_an_unknown_name(registry):
    with pytest.raises(UnknownPluginError, match="Did you mean 'mild'"):
        make(registry, "midl")


def test_a_constructor_that_raises_is_a_broken_plugin(registry):
    with pytest.raises(BrokenPluginError, match="'failing' cannot be made: RuntimeError: no luck"):
        make(registry, "failing")


def test_what_is_raised_on_purpose_passes_unchanged(registry):
    with pytest.raises(MissingExtraError, match="plan"):
        make(registry, "withoutextra")


def test_what_is_no_plugin_class_is_broken(registry):
    with pytest.raises(BrokenPluginError, match="must be a class with a pydantic Config"):
        make(registry, "function")
