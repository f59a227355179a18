"""Environments in the perception track `noisy`."""

import numpy as np
import pytest

from benchnav.envs.factory import make_batch
from benchnav.errors import UsageError


def played(perception, seed=0, steps=120):
    """Observations of 3 rows that start again, with actions that do not depend on them."""
    batch = make_batch(
        "leaders/dynamic", "ego", "train", 4, None, rows=3, perception=perception
    )  # fmt: skip
    batch.reseed(np.random.default_rng(seed))
    rng = np.random.default_rng(1)
    seen, restarts = [batch.reset()], 0
    for _ in range(steps):
        step = batch.step(rng.uniform(-0.2, 1.0, (3, batch.width, 2)))
        seen.append(step.observation)
        restarts += int(step.restarted.any(1).sum())
    return np.array(seen), restarts


def test_a_seed_repeats_the_noise_also_of_rows_that_start_again():
    one, restarts = played("noisy")
    assert restarts > 2
    again, _ = played("noisy")
    assert one.tobytes() == again.tobytes()
    other, _ = played("noisy", 1)
    assert (one != other).any()


def test_the_noise_is_seen():
    exact, _ = played("exact", steps=3)
    noisy, _ = played("noisy", steps=3)
    assert np.isfinite(noisy).all()
    assert (exact != noisy).mean() > 0.2


def test_an_unknown_perception():
    with pytest.raises(UsageError) as raised:
        make_batch("leaders/dynamic", "ego", "train", 2, None, perception="noise")
    assert str(raised.value) == (
        "A perception must be one of exact, noisy. Got 'noise' instead. Did you mean 'noisy'?"
    )


@pytest.mark.parametrize("kind", ["vector", "sb3", "gymnasium", "pettingzoo"])
def test_every_kind_of_environment_takes_it(kind):
    pytest.importorskip(
        {"sb3": "stable_baselines3", "pettingzoo": "pettingzoo"}.get(kind, "gymnasium")
    )
    from benchnav.api.execution.env import make_env

    others = {"others": "straight-line"} if kind == "gymnasium" else {}
    env = make_env("leaders/static", kind=kind, worlds=2, perception="noisy", **others)
    batch = env.unwrapped.batches[0] if kind == "sb3" else env.batch
    assert batch._senses is not None
    env.reset()
    env.close()
