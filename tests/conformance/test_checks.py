"""Each check is failed by something that deserves it, and says why."""

import random
from dataclasses import replace

import numpy as np
import pytest
from pydantic import BaseModel

from benchnav.arena.sensing import RaySensor
from benchnav.navigation.controller import Controller
from benchnav.navigation.navigator import AgentNavigator, Navigator, Need, PluginConfig
from benchnav.navigation.planner import UNSOLVED, Plan, Planner
from benchnav.testing.check_controller import check_controller
from benchnav.testing.check_navigator import check_navigator
from benchnav.testing.check_planner import START, check_planner
from benchnav.testing.scenes import USUAL


class Good(Navigator):
    def act(self, observation):
        return observation.goal - observation.position


class GoodAgent(AgentNavigator):
    def act_agent(self, view, briefing):
        push = sum((view.position - p for p, _, _ in view.neighbours), np.zeros(2))
        return view.goal - view.position + push * float(briefing.radius[view.agent])

    needs = frozenset({Need.NEIGHBOURS})


class Shapeless(Good):
    def act(self, observation):
        return super().act(observation)[:1]


class Infinite(Good):
    def act(self, observation):
        return super().act(observation) / 0.0


class Silent(Good):
    def act(self, observation):
        return None


class Greedy(Good):
    def act(self, observation):
        return observation.neighbours.position[:, :, 0]


class Mapless(Good):
    def reset(self, briefings, rows):
        self.walls = [briefing.map.capsules for briefing in briefings]


class Vandal(Good):
    def act(self, observation):
        observation.position[...] = 0.0
        return super().act(observation)


class Scribbler(Good):
    def reset(self, briefings, rows):
        briefings[0].goal[:] += 1.0


class Gambler(Good):
    def act(self, observation):
        return super().act(observation) * np.random.rand()  # noqa: NPY002


class Tosser(Good):
    def act(self, observation):
        random.random()
        return super().act(observation)


class Forgetful(Good):
    steps = 0

    def act(self, observation):
        self.steps += 1
        return super().act(observation) / self.steps


class Impatient(Good):
    made = 0

    def __init__(self, config=None):
        super().__init__(config)
        Impatient.made += 1
        self.pace = Impatient.made

    def act(self, observation):
        return super().act(observation) * self.pace


class Sociable(Good):
    def act(self, observation):
        return super().act(observation) * len(observation)


class DiscsOnly(Good):
    needs = frozenset({Need.NEIGHBOURS})

    def act(self, observation):
        is_disc = observation.neighbours.rounding[:, :, :1] == 0.0
        return np.where(is_disc, super().act(observation), np.nan)


class Trusting(AgentNavigator):
    def act_agent(self, view, briefing):
        before = view.state.get("position", view.position)
        view.state["position"] = view.position.copy()
        if (
            np.hypot(*(view.position - before))
            > briefing.max_speed[view.agent] * briefing.dt + 1e-9
        ):
            raise LookupError("it jumped")
        return view.goal - view.position


class Padded(Good):
    def act(self, observation):
        return super().act(observation) * observation.active.shape[1]


class Positional(Good):
    def act(self, observation):
        order = np.argsort(np.argsort(observation.rows))
        return super().act(observation) * (1.0 + order[:, None, None])


class Ranked(Good):
    def act(self, observation):
        rank = np.arange(observation.active.shape[1])
        return super().act(observation) * rank[:, None]


class Leaky(Good):
    """A row that starts over makes all rows start over."""

    def reset(self, briefings, rows):
        self.steps = dict.fromkeys([*getattr(self, "steps", ()), *rows.tolist()], 0)

    def act(self, observation):
        pace = []
        for row in observation.rows.tolist():
            self.steps[row] += 1
            pace.append(1.0 / self.steps[row])
        return super().act(observation) * np.array(pace)[:, None, None]


class Wordless(Good):
    class Config(PluginConfig):
        pace: float = 1.0


class Lax(Good):
    class Config(BaseModel):
        pass


class Needy(Good):
    needs = frozenset({"sonar"})


class Sideways(Good):
    command = "sideways"


class Rider(Good):
    drives = frozenset({"bike"})


class Sly(Good):
    """Says that it uses no map, and does."""

    uses_map = False

    def reset(self, briefings, rows):
        self.mapped = any(briefing.map is not None for briefing in briefings)

    def act(self, observation):
        return super().act(observation) * (0.5 if self.mapped else 1.0)


@pytest.mark.parametrize("good", [Good, GoodAgent, lambda: Good()])
def test_a_sound_navigator_passes(good):
    check_navigator(good)


@pytest.mark.parametrize(
    ("bad", "sentence"),
    [
        (Shapeless, "Shapeless.act must return shape (3, 5, 2). Got (1, 5, 2)."),
        (Silent, "Silent.act must return an array of real numbers. Got None instead."),
        (Greedy, "Greedy.act must work with what it needs (nothing) and nothing more."),
        (Mapless, "Mapless.reset must work with what it needs (nothing) and nothing more."),
        (Vandal, "Vandal must not write into its observation."),
        (Scribbler, "Scribbler must not write into its briefing."),
        (Gambler, "Gambler must draw from its briefing's generator only. It used numpy.random's"),
        (Tosser, "Tosser must draw from its briefing's generator only. It used random's"),
        (Forgetful, "Forgetful must answer the same after a second reset with the same"),
        (Impatient, "Impatient must answer the same in another instance."),
        (Sociable, "Sociable must answer the same for a world alone as in a batch."),
        (
            DiscsOnly,
            "DiscsOnly.act must return finite commands for all active agents for every body that"
            " it drives.",
        ),
        (Trusting, "Trusting.act with noisy senses must work with what it needs (nothing)"),
        (Padded, "Padded must answer the same for a world alone as in a batch."),
        (Positional, "Positional must answer the same for a world alone as in a batch."),
        (Ranked, "Ranked must answer the same whatever the order of agents."),
        (Leaky, "Leaky must answer the same whatever happens in other rows."),
        (Sly, "Sly must answer the same with a map as without: its uses_map is False."),
        (Wordless, "Wordless.Config.pace must have a description with its unit."),
        (Lax, "Lax.Config must be frozen and forbid unknown keys: derive it from PluginConfig."),
        (Needy, "Needy must need a frozenset of ['rays', 'neighbours', 'edges', 'map']."),
        (Rider, "Rider.drives must be a frozenset of ['ackermann', 'differential-drive', "),
        (Sideways, "Sideways.command must be 'velocity' or 'twist'. Got 'sideways' instead."),
    ],
)
def test_an_unsound_navigator_is_told_why(bad, sentence):
    with pytest.raises(AssertionError) as complaint:
        check_navigator(bad)
    assert str(complaint.value).startswith(sentence)


@pytest.mark.filterwarnings("ignore:divide by zero|invalid value:RuntimeWarning")
def test_a_navigator_that_answers_infinities_is_told_why():
    with pytest.raises(AssertionError, match=r"Infinite.act must return finite commands"):
        check_navigator(Infinite)


class Straight(Controller):
    def steer(self, observation, guide):
        return guide.target - observation.position


class Counting(Straight):
    steps = 0

    def steer(self, observation, guide):
        self.steps += 1
        return super().steer(observation, guide) * self.steps


def test_controllers_are_held_to_the_same():
    check_controller(Straight)
    with pytest.raises(
        AssertionError, match=r"^Counting must answer the same after a second reset"
    ):
        check_controller(Counting)
    with pytest.raises(AssertionError, match=r"^Good must derive from Controller"):
        check_controller(Good)


class Tracer(Planner):
    """Around the furniture, by heart."""

    corners = (START, (0.5, 6.0), (0.5, 9.5), (3.0, 9.4), (5.0, 9.5), (9.0, 9.5), (9.0, 9.0))

    def plan(self, map, start, goal, radius, tolerance, rng):
        if len(map.solids) == 2 or (5.0, 5.0) in (tuple(start), tuple(goal)):
            return Plan(UNSOLVED, False, 0, "told so")
        corners = np.array(self.corners)
        return Plan(corners if tuple(start) == tuple(START) else corners[::-1], True)


class Hopeful(Tracer):
    def plan(self, map, start, goal, radius, tolerance, rng):
        return Plan(np.array([start, goal]), True)


class Optimist(Tracer):
    def plan(self, map, start, goal, radius, tolerance, rng):
        return Plan(np.array(self.corners), True)


class Thrower(Tracer):
    def plan(self, *args):
        if (plan := super().plan(*args)).solved:
            return plan
        raise RuntimeError("no way")


class Short(Tracer):
    corners = Tracer.corners[:-2]


class Elsewhere(Tracer):
    corners = Tracer.corners[1:]


class Nan(Tracer):
    corners = (*Tracer.corners[:3], (np.nan, 9.0), *Tracer.corners[3:])


class Desperate(Tracer):
    def plan(self, *args):
        return Plan(UNSOLVED, False, 0, "too hard")


class Moody(Tracer):
    asked = 0

    def plan(self, *args):
        self.asked += 1
        plan = super().plan(*args)
        return (
            Plan(np.vstack([plan.path[:1]] * self.asked + [plan.path]), True)
            if plan.solved
            else plan
        )


class Loose(Tracer):
    def plan(self, *args):
        return super().plan(*args).path


def test_a_sound_planner_passes():
    check_planner(Tracer)


@pytest.mark.parametrize(
    ("bad", "sentence"),
    [
        (Hopeful, "Hopeful's path must be free for a disc of 0.3 m. From (1, 1) to (9, 9) it is"),
        (Optimist, "Optimist must answer Plan(UNSOLVED, False, reason=…) to a goal that is walled"),
        (Thrower, "Thrower.plan must answer with a Plan. It raised RuntimeError: no way."),
        (Short, "Short's path must end within 0.25 m of the goal. It ends 4.03113 m off."),
        (Elsewhere, "Elsewhere's path must begin at the start"),
        (Nan, "Nan's path must be a finite array (W, 2)."),
        (Desperate, "Desperate must find a path in a plain map. It says: 'too hard'."),
        (Moody, "Moody must plan the same path for the same generator a second time."),
        (Loose, "Loose.plan must return a Plan."),
        (Good, "Good must derive from Planner."),
    ],
)
def test_an_unsound_planner_is_told_why(bad, sentence):
    with pytest.raises(AssertionError) as complaint:
        check_planner(bad)
    assert str(complaint.value).startswith(sentence)


class ByPlace(Good):
    """Keeps worlds by their place in the call."""

    def reset(self, briefings, rows):
        self.told = dict(enumerate(briefings))

    def act(self, observation):
        return np.stack(
            [self._of(w, int(r)) for w, r in enumerate(observation.rows)]
        ) * super().act(observation)

    def _of(self, place, row):
        return np.full((1, 1), self.told[row].dt)


class ByCount(ByPlace):
    def reset(self, briefings, rows):
        self.told = list(briefings)


class ByOrder(ByPlace):
    def reset(self, briefings, rows):
        self.told = dict(zip(rows.tolist(), briefings, strict=True))

    def _of(self, place, row):
        return super()._of(place, place)


@pytest.mark.parametrize("navigator", [ByPlace, ByCount, ByOrder])
def test_a_wrong_row_is_answered_with_a_sentence(navigator):
    rule = (
        rf"{navigator.__name__}.act must work for .* row.*: what is kept of a world belongs under"
    )
    with pytest.raises(AssertionError, match=rule) as wrong:
        check_navigator(navigator)
    assert "test_checks.py:" in str(wrong.value)


class Choosy(Good):
    """Needs certain rays."""

    needs = frozenset({Need.RAYS})
    count, thick, fan = 9, True, np.pi

    def unfit(self, sensing):
        rays = sensing.rays
        fits = (rays.count, rays.thick, rays.fan) == (self.count, self.thick, self.fan)
        return "" if fits else f"needs {self.count} rays"

    def act(self, observation):
        assert observation.rays.distance.shape[-1] == self.count
        return super().act(observation)


class AllRound(Choosy):
    count, thick, fan = 72, False, 2.0 * np.pi


class Unheard(Choosy):
    count, fan = 77, 1.234


@pytest.mark.parametrize("navigator", [Choosy, AllRound])
def test_scenes_have_the_sensors_that_a_navigator_accepts(navigator):
    check_navigator(navigator)


def test_sensors_that_nobody_guesses_may_be_given():
    with pytest.raises(AssertionError, match=r"accepts none; .*needs 77 rays. .*sensing=Sensing"):
        check_navigator(Unheard)
    check_navigator(Unheard, sensing=replace(USUAL, rays=RaySensor(77, 1.234, 8.0, True)))
    with pytest.raises(AssertionError, match="It says: needs 77 rays"):
        check_navigator(Unheard, sensing=USUAL)
