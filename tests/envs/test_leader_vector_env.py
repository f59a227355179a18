from itertools import pairwise

import gymnasium
import numpy as np
import pytest
from gymnasium.vector import AutoresetMode
from gymnasium.wrappers.vector import RecordEpisodeStatistics

from benchnav.envs.factory import make_batch
from benchnav.envs.gym.leader_vector_env import LeaderVectorEnv
from benchnav.envs.gym.registration import LEADER
from benchnav.errors import BenchnavError, UsageError

STEPS = 260  # longer than an episode of the scenario


@pytest.fixture(scope="module")
def env():
    return LeaderVectorEnv(8, "leaders/static", "ego", worlds=3)


def actions(steps=STEPS, slots=8):
    rng = np.random.default_rng(1)
    drawn = rng.uniform(-1, 1, (steps, slots, 2)).astype(np.float32)
    drawn[:, ::2] = -1, 0  # every other agent stands until time runs out
    return drawn


@pytest.fixture(scope="module")
def steps(env):
    """(observation, reward, terminated, truncated, info) of every step, the first from reset."""
    none = np.zeros(env.num_envs)
    first, info = env.reset(seed=0)
    return [(first, none, none > 0, none > 0, info), *(env.step(a) for a in actions())]


def test_it_is_what_gymnasium_expects(env, steps):
    assert env.metadata["autoreset_mode"] is AutoresetMode.SAME_STEP
    made = gymnasium.make_vec(LEADER, num_envs=4, worlds=1)
    assert isinstance(made, LeaderVectorEnv)
    for seen, reward, terminated, truncated, info in steps:
        assert env.observation_space.contains(seen)
        assert [part.shape for part in (reward, terminated, truncated)] == [(8,)] * 3
        assert terminated.dtype == truncated.dtype == bool
        assert not (terminated & truncated).any()
        done = terminated | truncated
        assert done.any() == ("final_obs" in info)
        if done.any():
            assert np.array_equal(info["_final_obs"], done)
            assert all(env.single_observation_space.contains(x) for x in info["final_obs"][done])


def test_it_agrees_with_the_batch_bit_for_bit(env):
    batch = make_batch("leaders/static", "ego", "train", 3, None, 8)
    env.reset(seed=4)
    batch.reseed(np.random.Generator(np.random.PCG64(np.random.SeedSequence(4))).spawn(1)[0])
    assert np.array_equal(env.reset(seed=4)[0].reshape(2, 4, -1), batch.reset())
    for action in actions():
        seen, reward, terminated, truncated, info = env.step(action)
        step = batch.step(action.reshape(2, 4, 2))
        assert np.array_equal(seen, step.observation.reshape(8, -1))
        assert np.array_equal(reward, step.reward.reshape(-1))
        assert np.array_equal(info["acted"], step.acted.reshape(-1))
        assert np.array_equal(truncated, step.timed_out.reshape(-1))
        assert np.array_equal(terminated & info["acted"], (step.arrived | step.touched).reshape(-1))


def test_who_idles_sees_and_gets_nothing_until_the_row_restarts(steps):
    idled = 0
    for before, (seen, reward, terminated, truncated, info) in pairwise(steps):
        assert np.array_equal(info["acted"], ~before[4]["idle"])
        assert not seen[info["idle"]].any()
        assert not reward[~info["acted"]].any()
        woke = before[4]["idle"] & ~info["idle"]
        assert np.array_equal(woke, ~info["acted"] & ~info["idle"])
        assert not ((terminated | truncated) & ~info["acted"]).any()
        idled += int(info["idle"].sum())
        rows = woke.reshape(2, 4).any(1)
        assert not info["idle"].reshape(2, 4)[rows].any()
    assert idled > 0


def test_time_leaves_something_to_value_and_an_end_does_not(steps):
    cut = ended = 0
    for _, _, terminated, truncated, info in steps:
        for slot in np.flatnonzero(truncated):
            assert info["final_obs"][slot].any()
            cut += 1
        for slot in np.flatnonzero(terminated):
            assert not info["final_obs"][slot].any()
            ended += 1
    assert cut > 0
    assert ended > 0


def test_a_seed_decides_the_worlds(env):
    first = env.reset(seed=2)[0]
    assert any(not np.array_equal(env.reset(seed=other)[0], first) for other in range(3, 9))
    assert np.array_equal(env.reset(seed=2)[0], first)
    assert not np.array_equal(env.reset()[0], first)  # goes on in the order that 2 gave


def test_seeds_of_numpy_and_lists_of_seeds_are_taken(env):
    first = env.reset(seed=2)[0]
    assert np.array_equal(env.reset(seed=np.int64(2))[0], first)
    listed = env.reset(seed=list(range(8)))[0]
    env.reset(seed=5)
    assert np.array_equal(env.reset(seed=np.arange(8))[0], listed)
    lists = [env.reset(seed=[*range(7), last])[0] for last in range(8, 14)]
    assert any(not np.array_equal(other, listed) for other in lists)
    env.reset(seed=2)
    after = env.reset()[0]
    env.reset(seed=2)
    assert np.array_equal(env.reset(seed=[None] * 8)[0], after)
    for wrong, match in [
        ([1, 2], "must have 8, one for each. Got 2"),
        ([None, *range(7)], "all None or all numbers: .* 7 numbers and 1 times None"),
        ([-1, *range(7)], "0 or more. Got -1"),
    ]:
        with pytest.raises(BenchnavError, match=match):
            env.reset(seed=wrong)


def test_it_closes_twice_and_must_be_reset():
    env = LeaderVectorEnv(4, worlds=1)
    with pytest.raises(BenchnavError, match=r"call reset\(\)"):
        env.step(actions(1, 4)[0])
    env.close()
    env.close()


def test_gymnasium_s_statistics_wrap_it():
    wrapped = RecordEpisodeStatistics(LeaderVectorEnv(4, worlds=1))
    wrapped.reset(seed=0)
    lengths = []
    for action in actions(260, 4):
        info = wrapped.step(action)[4]
        if "episode" in info:
            lengths += info["episode"]["l"][info["_episode"]].tolist()
    assert 250 in lengths


@pytest.mark.parametrize(
    ("wrong", "says"),
    [
        ({"num_envs": 1}, "at least 4, the agents of a world of leaders/static. Got 1 instead"),
        ({"num_envs": 6}, "multiple of 4, .* Got 6 instead; the nearest below is 4"),
        ({"others": "orca"}, "Every agent learns here"),
    ],
)
def test_mistakes_are_explained(wrong, says):
    with pytest.raises(BenchnavError, match=says):
        LeaderVectorEnv(**{"worlds": 1, **wrong})


def test_a_row_starts_again_in_the_next_step_if_that_is_asked_for():
    """The step shows the end; the one after it ignores actions and shows another world."""
    same, late = (
        LeaderVectorEnv(8, "leaders/static", worlds=3, autoreset_mode=mode)
        for mode in ("SameStep", AutoresetMode.NEXT_STEP)
    )
    assert late.metadata["autoreset_mode"] is AutoresetMode.NEXT_STEP
    assert same.metadata["autoreset_mode"] is AutoresetMode.SAME_STEP
    first, _ = same.reset(seed=0)
    assert np.array_equal(late.reset(seed=0)[0], first)
    action = np.tile(np.float32([-1.0, 0.0]), (8, 1))  # stands until time runs out
    worlds = late.batch.simulation.worlds
    done = np.zeros(8, np.bool_)
    while not done.any():
        seen, reward, _, done, info = late.step(action)
        next_seen, other_reward, _, same_done, final = same.step(action)
        assert np.array_equal(reward, other_reward)
    assert done.all()
    assert same_done.all()
    assert np.array_equal(seen, np.stack(list(final["final_obs"])))
    assert "final_obs" not in info
    assert np.array_equal(info["is_success"], final["final_info"]["is_success"])
    assert late.batch.simulation.worlds == worlds
    fresh, reward, terminated, truncated, info = late.step(action)
    assert np.array_equal(fresh, next_seen)
    assert not (reward.any() | terminated.any() | truncated.any() | info["acted"].any())
    assert not info["idle"].any()


def test_a_mode_without_restarts_is_refused():
    with pytest.raises(UsageError, match="must be 'SameStep' or 'NextStep'"):
        LeaderVectorEnv(8, "leaders/static", worlds=3, autoreset_mode="Disabled")
