"""The learner: short sequences lose and change nothing, and the actor is the policy's mean."""

from functools import cache

import numpy as np
import pytest
import torch
from benchnav_baselines.learned.recurrent_ppo.actor import Actor
from benchnav_baselines.learned.recurrent_ppo.learning.buffer import LiveBuffer, SequenceBuffer
from benchnav_baselines.learned.recurrent_ppo.learning.courses import make_env, training_pools
from benchnav_baselines.learned.recurrent_ppo.learning.learner import (
    SequencePPO,
    actor_tensors,
    buffer_of,
    enter,
    make_learner,
    reseed,
    set_precision,
)
from benchnav_baselines.learned.recurrent_ppo.learning.learner_group import LearnerGroup
from benchnav_baselines.learned.recurrent_ppo.learning.recipe import Network, Recipe
from gymnasium import spaces
from hypothesis import given, settings
from hypothesis import strategies as st
from sb3_contrib import RecurrentPPO
from sb3_contrib.common.recurrent.buffers import RecurrentRolloutBuffer
from sb3_contrib.common.recurrent.policies import RecurrentActorCriticPolicy
from stable_baselines3.common.callbacks import CallbackList

torch.set_num_threads(1)  # as a training; two wait for each other where other work runs

BOX = spaces.Box(-1.0, 1.0, (3,), np.float32)
ACTION = spaces.Box(-1.0, 1.0, (2,), np.float32)
ARRAYS = ("observations", "actions", "values", "log_probs", "advantages", "returns",
          "episode_starts")  # fmt: skip
STATES = ("hidden_states_pi", "cell_states_pi", "hidden_states_vf", "cell_states_vf")


def recipe_of(sequence=8, **network):
    return Recipe.model_validate(
        {
            "name": "tiny",
            "courses": [{"scenario": "leaders/static-corner", "worlds": 3}],
            "rows": 3,
            "rollout": 64,
            "sequence": sequence,
            "network": network,
            "stages": [{"decisions": 100, "batch": 65, "epochs": 1}],
        }
    )


@cache
def rolled_out(layers=1, size=8, dense=(), rollouts=3, sequence=8, bfloat16=False):
    """A learner that collected rollouts in which slots arrive, collide, idle and start again."""
    recipe = recipe_of(sequence, lstm_layers=layers, lstm_size=size, dense=list(dense), log_std=0.5)
    env = make_env(recipe, training_pools(recipe, recipe.stages[0]))
    env.enter(recipe.stages[0].reward, 0)
    learner = make_learner(recipe, env, 0, "cpu")
    set_precision(learner, "bfloat16" if bfloat16 else "float32")
    reseed(learner, np.random.default_rng(0))
    _, callback = learner._setup_learn(10**9, CallbackList([]))
    enter(learner, recipe.stages[0], 0.0)
    for _ in range(rollouts):
        learner.collect_rollouts(env, callback, learner.rollout_buffer, recipe.rollout)
    return learner


def test_a_stage_that_gives_the_noise_sets_it_and_learns_it_no_more():
    recipe = recipe_of(lstm_layers=1, lstm_size=4)
    env = make_env(recipe, training_pools(recipe, recipe.stages[0]))
    env.enter(recipe.stages[0].reward, 0)
    learner = make_learner(recipe, env, 0, "cpu")
    given = recipe.stages[0].model_copy(update={"log_std": (-0.5, -1.5)})
    for progress, expected in ((0.0, -0.5), (0.5, -1.0), (1.0, -1.5), (1.2, -1.5)):
        enter(learner, given, progress)
        np.testing.assert_allclose(learner.policy.log_std.detach(), expected)
    assert not learner.policy.log_std.requires_grad
    enter(learner, recipe.stages[0], 0.0)
    assert learner.policy.log_std.requires_grad


def stock_of(learner, monkeypatch):
    """The stock policy with the same weights, and the stock buffer with the same transitions."""
    ours, policy = learner.rollout_buffer, learner.policy
    lstm = policy.lstm_actor
    kwargs = {**learner.policy_kwargs}
    stock = RecurrentActorCriticPolicy(
        learner.observation_space, learner.action_space, lambda _: 1e-3, **kwargs
    )
    stock.load_state_dict(policy.state_dict())
    buffer = RecurrentRolloutBuffer(
        ours.buffer_size, learner.observation_space, learner.action_space,
        (ours.buffer_size, lstm.num_layers, ours.n_envs, lstm.hidden_size), "cpu",
        n_envs=ours.n_envs,
    )  # fmt: skip
    for name in ARRAYS:
        setattr(buffer, name, getattr(ours, name).copy())
    step, slot = np.nonzero(ours.begins)
    states = ours.states[step, slot].numpy().reshape(len(step), 4, *ours.states.shape[4:])
    for k, name in enumerate(STATES):
        getattr(buffer, name)[step, :, slot] = states[:, k]
    buffer.full = True
    monkeypatch.setattr(np.random, "randint", lambda *_: 0)  # the stock buffer cuts nowhere
    return stock, buffer


def numbered(buffer):
    """Transitions known by their old value: (T, N) numbers from 1."""
    return np.arange(1, buffer.returns.size + 1, dtype=np.float32).reshape(buffer.returns.shape)


def evaluated(policy, samples, live):
    """Values, log-probabilities, and the PPO loss over the live transitions, in order of number."""
    value, log_prob, entropy = policy.evaluate_actions(
        samples.observations, samples.actions, samples.lstm_states, samples.episode_starts
    )
    number = samples.old_values
    counts = (samples.mask > 0.5) & torch.isin(number, live)
    at = torch.argsort(number[counts])
    assert torch.equal(number[counts][at], live)
    pick = [a.flatten()[counts][at] for a in (value, log_prob)]
    advantage, old, returned = (
        a[counts][at] for a in (samples.advantages, samples.old_log_prob, samples.returns)
    )
    advantage = (advantage - advantage.mean()) / (advantage.std() + 1e-8)
    ratio = torch.exp(pick[1] - old)
    clipped = torch.clamp(ratio, 0.8, 1.2)
    loss = -torch.min(advantage * ratio, advantage * clipped).mean()
    loss = loss + 0.5 * ((returned - pick[0]) ** 2).mean() - 0.01 * entropy.mean()
    gradient = torch.autograd.grad(loss, list(policy.parameters()), allow_unused=True)
    return [*pick, loss], [g for g in gradient if g is not None]


@pytest.mark.parametrize("shape", [(1, 8, ()), (2, 6, (7,))])
@pytest.mark.parametrize("sequence", [8, 64])
def test_short_sequences_learn_what_the_stock_learner_learns(shape, sequence, monkeypatch):
    learner = rolled_out(*shape, sequence=sequence)
    ours = learner.rollout_buffer
    assert 0 < ours.live.sum() < ours.live.size
    assert ours.episode_starts[1:][ours.live[1:]].any()
    monkeypatch.setattr(ours, "values", numbered(ours))
    stock, buffer = stock_of(learner, monkeypatch)
    live = torch.sort(torch.tensor(ours.values[ours.live])).values
    expected, gradient = evaluated(stock, next(buffer.get(None)), live)
    results, slopes = evaluated(learner.policy, next(ours.get(None)), live)
    for ours_, stock_ in zip(results, expected, strict=True):
        torch.testing.assert_close(ours_, stock_, rtol=1e-4, atol=1e-4)
    if sequence == ours.buffer_size:  # the gradient does not flow beyond a cut
        for ours_, stock_ in zip(slopes, gradient, strict=True):
            torch.testing.assert_close(ours_, stock_, rtol=1e-3, atol=1e-5)


@pytest.mark.parametrize("shape", [(1, 8, ()), (2, 128, ())])
def test_bfloat16_learns_what_float32_learns(shape, monkeypatch):
    """Losses agree to 1 %, and gradients point the same way."""
    learner = rolled_out(*shape, sequence=16, rollouts=1)
    ours = learner.rollout_buffer
    monkeypatch.setattr(ours, "values", numbered(ours))
    live = torch.sort(torch.tensor(ours.values[ours.live])).values
    samples = next(ours.get(None))
    (*_, loss), slopes = evaluated(learner.policy, samples, live)
    monkeypatch.setattr(learner.policy, "half_products", True)
    (*_, rough), rough_slopes = evaluated(learner.policy, samples, live)
    assert rough != loss
    torch.testing.assert_close(rough, loss, rtol=0.01, atol=1e-3)
    one, other = (torch.cat([g.flatten() for g in both]) for both in (slopes, rough_slopes))
    assert torch.nn.functional.cosine_similarity(one, other, dim=0) > 0.999
    torch.testing.assert_close(one.norm(), other.norm(), rtol=0.01, atol=0.0)


@pytest.mark.parametrize(("bfloat16", "within"), [(False, 1e-4), (True, 0.05)])
def test_what_was_decided_is_evaluated_the_same(bfloat16, within):
    """Before any update the ratio of old and new probabilities is one, at every cut."""
    learner = rolled_out(2, 6, (7,), bfloat16=bfloat16)
    for samples in learner.rollout_buffer.get(64):
        value, log_prob, _ = learner.policy.evaluate_actions(
            samples.observations, samples.actions, samples.lstm_states, samples.episode_starts
        )
        mask = samples.mask > 0.5
        near = {"atol": within, "rtol": within}
        torch.testing.assert_close(log_prob[mask], samples.old_log_prob[mask], **near)
        torch.testing.assert_close(value.flatten()[mask], samples.old_values[mask], **near)


def test_rollouts_are_those_of_the_stock_collector():
    """Actions are nearly the mean, because the two draw different random numbers."""
    recipe = recipe_of(lstm_layers=2, lstm_size=6, dense=[7], log_std=-5)
    pools = training_pools(recipe, recipe.stages[0])
    learners = []
    for kind in (SequencePPO, RecurrentPPO):
        env = make_env(recipe, pools)
        env.enter(recipe.stages[0].reward, 0)
        learner = make_learner(recipe, env, 0, "cpu")
        if kind is RecurrentPPO:
            ours, keys = learner, {"n_steps": 64, "seed": 0, "device": "cpu"}
            learner = RecurrentPPO(
                "MlpLstmPolicy", env, policy_kwargs=ours.policy_kwargs, gamma=0.99, **keys
            )
            learner.policy.load_state_dict(ours.policy.state_dict())
        with torch.no_grad():
            learner.policy.log_std.fill_(-18.0)
            learner.policy.action_net.weight.mul_(100.0)
        _, callback = learner._setup_learn(10**9, CallbackList([]))
        for batch in env.batches:  # so that attempts end at the horizon
            batch.simulation.records["steps"] = 20
        for _ in range(2):
            learner.collect_rollouts(env, callback, learner.rollout_buffer, 64)
        learners.append((learner.rollout_buffer, env.tally.counts))
    (ours, counts), (stock, others) = learners
    assert counts == others
    assert counts["timed_out"]
    assert counts["touched"] or counts["arrived"]
    live = ours.live
    for name in ("observations", "actions", "rewards", "episode_starts", "values", "advantages",
                 "returns"):  # fmt: skip
        one, other = getattr(ours, name)[live], getattr(stock, name)[live]
        np.testing.assert_allclose(one, other, atol=1e-3, err_msg=name)


def test_idle_slots_earn_nothing_and_are_known():
    buffer = rolled_out().rollout_buffer
    assert (buffer.rewards[~buffer.live] == 0).all()
    assert (buffer.observations[~buffer.live] == 0).all()
    assert not buffer.begins[~buffer.live].any()
    fresh = buffer.live[1:] & ~buffer.live[:-1]
    assert fresh.any()
    assert (buffer.episode_starts[1:][fresh] == 1).all()


def slow_sequences(starts, live, length):
    """(slot, first, decisions) step by step."""
    found = []
    for slot in range(live.shape[1]):
        going = False
        for t in range(live.shape[0]):
            if not live[t, slot]:
                going = False
                continue
            if not going or starts[t, slot] or found[-1][2] == length:
                found.append([slot, t, 0])
            found[-1][2] += 1
            going = True
    return found


def filled(kind, starts, live, length=4):
    """A buffer of random numbers whose returns number the transitions."""
    T, N = live.shape
    rng = np.random.default_rng(0)
    extra = {"state": (2, 2, 2, 3), "length": length} if kind is SequenceBuffer else {}
    buffer = kind(T, BOX, ACTION, "cpu", n_envs=N, **extra)
    buffer.reset()
    for name in ARRAYS[:6]:
        array = getattr(buffer, name)
        setattr(buffer, name, rng.normal(size=array.shape).astype(np.float32))
    if kind is SequenceBuffer:
        states = torch.tensor(rng.normal(size=(T, N, 2, 2, 2, 3)), dtype=torch.float32)
        starts = starts.astype(bool) | np.pad(live[1:] & ~live[:-1], ((1, 0), (0, 0)))
        for t in range(T):
            slots = np.flatnonzero(live[t])
            buffer.begin(t, slots, starts[t, slots], states[t, slots])
    buffer.returns = numbered(buffer)
    buffer.live, buffer.rng, buffer.full = live, rng, True
    return buffer


masks = st.tuples(
    st.integers(1, 12), st.integers(1, 5), st.integers(0, 2**32), st.floats(0, 1), st.floats(0, 1)
)


def drawn(case):
    T, N, seed, share, often = case
    rng = np.random.default_rng(seed)
    live = rng.random((T, N)) < share
    live[rng.integers(T), rng.integers(N)] = True
    return rng.random((T, N)) < often, live


@given(masks, st.integers(1, 6))
@settings(max_examples=60)
def test_sequences_agree_with_their_twin(case, length):
    starts, live = drawn(case)
    fast = np.transpose(filled(SequenceBuffer, starts, live, length).sequences()).tolist()
    assert sorted(fast) == sorted(slow_sequences(starts, live, length))


@given(masks, st.integers(1, 6), st.sampled_from([None, 1, 5, 16]))
@settings(max_examples=60)
def test_every_live_decision_is_learned_from_once_an_epoch(case, length, batch):
    starts, live = drawn(case)
    buffer = filled(SequenceBuffer, starts, live, length)
    met = []
    for samples in buffer.get(batch):
        mask = samples.mask.numpy() > 0.5
        number = samples.returns.numpy()
        met += number[mask].tolist()
        sequences = samples.lstm_states.pi[0].shape[1]
        assert not samples.episode_starts.reshape(sequences, -1)[:, 1:].any()
        first = number.reshape(sequences, -1)[:, 0].astype(int) - 1
        t, slot = np.unravel_index(first, live.shape)
        state = buffer.states[t, slot]
        for k, part in enumerate((*samples.lstm_states.pi, *samples.lstm_states.vf)):
            assert torch.equal(part.swapaxes(0, 1), state[:, k // 2, k % 2])
        at = tuple(np.unravel_index(number[mask].astype(int) - 1, live.shape))
        np.testing.assert_array_equal(samples.observations.numpy()[mask], buffer.observations[at])
        np.testing.assert_array_equal(samples.actions.numpy()[mask], buffer.actions[at])
        np.testing.assert_array_equal(samples.advantages.numpy()[mask], buffer.advantages[at])
    assert sorted(met) == buffer.returns[live].tolist()


def test_minibatches_are_about_as_large_as_asked_for():
    rng = np.random.default_rng(0)
    live = rng.random((64, 40)) < 0.9
    buffer = filled(SequenceBuffer, rng.random((64, 40)) < 0.02, live, 16)
    sizes = [int(samples.mask.sum()) for samples in buffer.get(256)]
    assert len(sizes) == round(live.sum() / 256)
    assert all(256 - 40 < size < 256 + 40 for size in sizes)


@given(masks, st.sampled_from([None, 1, 5, 16]))
@settings(max_examples=40)
def test_without_memory_every_live_decision_is_learned_from_once_too(case, batch):
    starts, live = drawn(case)
    buffer = filled(LiveBuffer, starts, live)
    met = []
    for samples in buffer.get(batch):
        number = samples.returns.numpy()
        met += number.tolist()
        at = tuple(np.unravel_index(number.astype(int) - 1, live.shape))
        np.testing.assert_array_equal(samples.observations.numpy(), buffer.observations[at])
        np.testing.assert_array_equal(samples.old_log_prob.numpy(), buffer.log_probs[at])
    assert sorted(met) == buffer.returns[live].tolist()


@pytest.mark.parametrize("kind", [SequenceBuffer, LiveBuffer])
def test_minibatches_depend_on_the_generator_alone(kind):
    def order(seed):
        buffer = filled(kind, np.zeros((9, 4)), np.ones((9, 4), bool))
        buffer.rng = np.random.default_rng(seed)
        return [samples.returns.tolist() for samples in buffer.get(8)]

    assert order(1) == order(1) != order(2)


NETWORKS = [
    Network(lstm_layers=2, lstm_size=16),
    Network(lstm_layers=1, lstm_size=8, dense=(12, 5)),
    Network(lstm_layers=0, dense=(9,)),
]


def policy_of(network):
    """A learner with weights far from their small first values."""
    recipe = recipe_of(**network.model_dump())
    env = make_env(recipe, training_pools(recipe, recipe.stages[0]))
    learner = make_learner(recipe, env, 3, "cpu")
    torch.manual_seed(0)
    with torch.no_grad():
        for parameter in learner.policy.parameters():
            parameter.normal_(0.0, 0.4)
    return learner


def mean_action(policy, x, state, layers):
    """Torch's mean action; advances ``state``, a list of hidden and cell."""
    with torch.no_grad():
        if not layers:
            return policy.get_distribution(torch.tensor(x)).mode().numpy()
        distribution, after = policy.get_distribution(
            torch.tensor(x), tuple(state), torch.zeros(len(x))
        )
        state[:] = after
        return distribution.mode().numpy()


@pytest.mark.parametrize("network", NETWORKS)
def test_the_actor_is_the_mean_of_the_policy(network):
    learner, rng = policy_of(network), np.random.default_rng(0)
    actor, n = Actor(actor_tensors(learner)), 7
    layers, size = network.lstm_layers, network.lstm_size
    assert actor.state_size == 2 * layers * (size if layers else 0)
    memory = np.zeros((n, actor.state_size), np.float32)
    state = [torch.zeros(layers, n, size) for _ in range(2)]
    for _ in range(6):
        x = rng.normal(size=(n, 62)).astype(np.float32)
        expected = mean_action(learner.policy, x, state, layers)
        np.testing.assert_allclose(actor.decide(x, memory), expected, rtol=1e-5, atol=1e-5)
    told = np.stack([part.numpy() for part in state], axis=1)  # (layers, 2, n, size)
    if layers:
        told = told.transpose(2, 0, 1, 3).reshape(n, -1)
        np.testing.assert_allclose(memory, told, rtol=1e-5, atol=1e-5)


@pytest.mark.parametrize("network", NETWORKS)
def test_the_actor_s_bits_depend_on_no_batch_and_no_order(network):
    actor, rng = Actor(actor_tensors(policy_of(network))), np.random.default_rng(1)
    n = 23
    whole = np.zeros((n, actor.state_size), np.float32)
    parted = whole.copy()
    for _ in range(5):
        x = rng.normal(size=(n, 62)).astype(np.float32)
        expected = actor.decide(x, whole)
        order = rng.permutation(n)
        for at in np.split(order, np.sort(rng.integers(0, n + 1, 4))):
            memory = parted[at]
            np.testing.assert_array_equal(actor.decide(x[at], memory), expected[at])
            parted[at] = memory
        np.testing.assert_array_equal(parted, whole)


def test_a_group_learns_from_the_mean_of_its_gradients(monkeypatch):
    """Two backward passes; the other process has gradients of its own."""
    policy, other = torch.nn.Linear(3, 2), torch.randn(8)

    def gradient():
        policy.zero_grad()
        policy(torch.ones(5, 3)).square().sum().backward()
        return torch.cat([p.grad.flatten() for p in policy.parameters()])

    own = gradient()
    LearnerGroup().average_gradients(policy)
    assert torch.equal(gradient(), own)
    monkeypatch.setattr("torch.distributed.all_reduce", lambda flat: flat.add_(other))
    LearnerGroup(0, 2).average_gradients(policy)
    for _ in range(2):
        torch.testing.assert_close(gradient(), (own + other) / 2)


def test_processes_share_rows():
    assert [LearnerGroup(rank, 3).share(64) for rank in range(3)] == [21, 21, 22]


def test_all_processes_make_as_many_minibatches(monkeypatch):
    live = np.ones((8, 6), bool)
    buffer = filled(SequenceBuffer, np.zeros((8, 6)), live)
    monkeypatch.setattr(buffer, "group", LearnerGroup(0, 2))
    for others, batches in [([48, 2], 2), ([48, 99], 6), ([48, 3], 3)]:
        answers = iter(others)
        monkeypatch.setattr(
            LearnerGroup, "gather", lambda _, value, left=answers: [value, next(left)]
        )
        met = [samples.returns[samples.mask > 0.5].tolist() for samples in buffer.get(16)]
        assert len(met) == batches
        assert sorted(x for part in met for x in part) == buffer.returns.flatten().tolist()


def test_memories_start_empty():
    learner = rolled_out(sequence=9)
    kept = learner._collector
    assert kept._memory.any()
    learner.forget()
    assert learner._collector is None
    learner._collector = kept
    assert buffer_of(learner) is learner.rollout_buffer
