import numpy as np
import pytest
from pettingzoo.test import parallel_api_test, parallel_seed_test

from benchnav.envs.factory import make_batch
from benchnav.envs.parallel_env import LeadersEnv
from benchnav.errors import BenchnavError


@pytest.fixture(scope="module")
def env():
    return LeadersEnv("leaders/static", "ego", worlds=3)


def test_pettingzoo_s_own_checks(env):
    parallel_api_test(env, num_cycles=260)
    parallel_seed_test(lambda: LeadersEnv(worlds=2), num_cycles=30)


def test_it_agrees_with_the_batch_bit_for_bit_and_who_is_done_leaves(env):
    batch = make_batch("leaders/static", "ego", "train", 3, None)
    seen, info = env.reset(options={"world": 1})
    first = batch.reset(np.array([1]))
    assert all(np.array_equal(seen[f"leader_{a}"], first[0, a]) for a in range(4))
    assert all(info[agent] == {"world": 1} for agent in env.agents)
    rng, left = np.random.default_rng(0), 0
    while env.agents:
        agents = list(env.agents)
        action = rng.uniform(-1, 1, (1, 4, 2)).astype(np.float32)
        seen, reward, terminated, truncated, info = env.step(
            {agent: action[0, int(agent[-1])] for agent in agents}
        )
        step = batch.step(action)
        for agent in agents:
            at = (0, int(agent[-1]))
            assert step.acted[at]
            assert reward[agent] == step.reward[at]
            assert truncated[agent] == step.timed_out[at]
            assert info[agent]["is_success"] == step.arrived[at]
            assert terminated[agent] == (step.arrived | step.touched)[at]
            over = terminated[agent] or truncated[agent]
            assert over == (agent not in env.agents)
            left += over
            if not over:
                assert np.array_equal(seen[agent], step.observation[at])
        assert set(seen) == set(agents)
    assert left == 4


def test_mistakes_are_explained(env):
    with pytest.raises(BenchnavError, match=r"'world' must be from 0 to 2\. Got 3 instead"):
        env.reset(options={"world": 3})
    env.reset()
    with pytest.raises(BenchnavError, match="leader_0 got none"):
        env.step({})
    with pytest.raises(BenchnavError, match="must be None"):
        LeadersEnv(render_mode="ansi")
