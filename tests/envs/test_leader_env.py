import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from stable_baselines3.common.env_checker import check_env as check_env_sb3

from benchnav.envs.gym.leader_env import LeaderEnv
from benchnav.envs.gym.registration import LEADER, register_envs
from benchnav.envs.reward import RewardWeights
from benchnav.errors import BenchnavError, NavigatorError
from benchnav.generation.build import build
from benchnav.navigation.navigator import Navigator
from benchnav.runner.rollouts.rollout import Assignment, rollout
from benchnav.scenario.catalogue import find


@pytest.fixture(scope="module")
def env():
    return LeaderEnv("leaders/static", "ego", worlds=4, others="orca")


def attempt(env, action=None, **reset):
    """Everything that one attempt tells, with drawn actions or always the same."""
    rng = np.random.default_rng(5)
    told = [env.reset(**reset)]
    while len(told) == 1 or not (told[-1][2] or told[-1][3]):
        drawn = np.array([0.0, 0.4]) + rng.uniform(-0.3, 0.3, 2)
        told.append(env.step(np.float32(drawn if action is None else action)))
    return told


def same(one, other):
    return len(one) == len(other) and all(
        np.array_equal(a[0], b[0]) and a[1:] == b[1:] for a, b in zip(one, other, strict=True)
    )


def test_gymnasium_s_own_check():
    env = gymnasium.make(LEADER, worlds=2, encoder="surround", others="orca").unwrapped
    check_env(env, skip_render_check=True)  # it would open a window


def test_the_check_of_stable_baselines3(env):
    check_env_sb3(env)


def test_it_can_be_made_by_importing_on_the_way():
    register_envs()  # once more does nothing
    made = gymnasium.make(
        f"benchnav.envs.gym.registration:{LEADER}", worlds=1, reward={"goal": 7}, others="orca"
    )
    assert made.unwrapped.batch.weights == RewardWeights(goal=7)


def test_a_seed_decides_everything(env):
    first = attempt(env, seed=11)
    assert same(first, attempt(env, seed=11))
    assert same(
        first, attempt(LeaderEnv("leaders/static", "ego", worlds=4, others="orca"), seed=11)
    )
    assert not same(first, attempt(env, seed=12))


def test_worlds_and_agents_are_drawn_or_told(env):
    env.reset(seed=0)
    met = {(info["world"], info["agent"]) for _, info in (env.reset() for _ in range(200))}
    assert met == {(w, a) for w in range(4) for a in range(4)}
    assert env.reset(options={"world": 2, "agent": 3})[1] == {"world": 2, "agent": 3}
    with pytest.raises(BenchnavError, match=r"'world' must be from 0 to 3\. Got 4 instead"):
        env.reset(options={"world": 4})


def test_an_attempt_ends_once(env):
    *going, last = attempt(env, seed=1)
    assert all(not step[2] and not step[3] for step in going[1:])
    assert last[2] != last[3]
    assert np.isfinite(last[1])
    with pytest.raises(BenchnavError, match="call reset"):
        env.step(np.zeros(2, np.float32))


def test_standing_still_is_cut_short_by_time_and_still_sees(env):
    told = attempt(env, (-1, 0), options={"world": 0, "agent": 0})
    seen, _, terminated, truncated, info = told[-1]
    assert (terminated, truncated, info["is_success"]) == (False, True, False)
    assert len(told) - 1 == env.batch.simulation.pool[0].clock.steps
    assert seen.any()


def test_success_is_to_arrive_untouched(env):
    ended = [attempt(env, (1, 0), options={"world": w, "agent": a})[-1]
             for w in range(4) for a in range(4)]  # fmt: skip
    assert {step[4]["is_success"] for step in ended} == {True, False}
    for seen, reward, terminated, _, info in ended:
        terms = info["terms"]
        hits = sum(terms[kind] for kind in ("static", "dynamic", "walls", "agents"))
        assert info["is_success"] == (terms["goal"] > 0)
        assert not (info["is_success"] and hits)
        assert not terminated or info["is_success"] or hits <= -20
        assert reward == pytest.approx(0.01 * sum(terms.values()))
        assert not (terminated and seen.any())


def test_the_others_drive_as_their_navigator_does(env):
    """An agent that learns to stand leaves the others to what ORCA does around one who stands."""
    scenario = find("leaders/static")
    env.reset(seed=0, options={"world": 0, "agent": 0})
    start = env.batch.simulation.position[0].copy()
    for _ in range(30):
        env.step(np.float32([-1, 0]))
    moved = np.linalg.norm(env.batch.simulation.position[0] - start, axis=1)
    assert moved[0] == 0
    assert (moved[1:] > 1).all()
    who = Assignment(scenario.identity, scenario.hash, "train", "known", "orca", "orca")
    ((episode,),) = rollout(who, [(0, build(scenario, "train", 0))])
    alone = np.linalg.norm(episode.position[30] - start, axis=1)
    assert np.abs(moved - alone)[1:].min() < 0.5


def test_in_a_scenario_with_drivers_only_evaluated_agents_learn():
    env = LeaderEnv("crowd/circle-crossing", worlds=2, others="orca")
    for seed in range(3):
        _, info = env.reset(seed=seed)
        assert info["agent"] == 0
    start = env.batch.simulation.position.copy()
    env.step(np.float32([-1, 0]))
    moved = np.linalg.norm(env.batch.simulation.position - start, axis=-1)
    assert moved[0, 0] == 0
    assert (moved[0, 1:] > 0).all()


class Garbage(Navigator):
    def act(self, observation):
        return np.full((*observation.active.shape, 2), np.nan)


def test_others_that_answer_garbage_are_named():
    env = LeaderEnv(worlds=1, others="orca")
    env._others._navigator = Garbage()
    env.reset()
    with pytest.raises(NavigatorError, match="others='orca': act must return finite numbers"):
        env.step(np.zeros(2, np.float32))


@pytest.mark.parametrize(
    ("wrong", "says"),
    [
        ({"scenario": "leaders/statik"}, "Did you mean 'leaders/static'"),
        ({"encoder": "eggo"}, "Did you mean 'ego'"),
        ({"split": "test"}, "train or validation: .* Got 'test' instead"),
        ({"worlds": 0}, "at least 1 world. Got 0 instead"),
        ({"reward": {"gaol": 1}}, "no weight 'gaol'. Did you mean 'goal'"),
        ({"reward": {"goal": -1}}, "'goal' of the reward must be ≥ 0. Got -1 instead"),
        ({"others": "orka", "worlds": 1}, "Did you mean 'orca'"),
        ({"others": None}, "others must name the navigator of the other agents"),
        ({"render_mode": "ansi"}, "must be None or 'rgb_array' or 'human'. Got 'ansi' instead"),
    ],
)
def test_mistakes_are_explained(wrong, says):
    with pytest.raises(BenchnavError, match=says):
        LeaderEnv(**{"others": "orca", **wrong})
