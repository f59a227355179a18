import numpy as np
import pytest
import yaml
from benchnav_baselines.learned.recurrent_ppo.foresight import foresee
from benchnav_baselines.learned.recurrent_ppo.navigator import RecurrentPPO
from benchnav_baselines.learned.recurrent_ppo.policy_at_work import SHIPPED

from benchnav.envs.agent_batch import AgentBatch
from benchnav.envs.encoders.catalogue import encoder
from benchnav.envs.encoders.encoder import Bodies
from benchnav.envs.reward import RewardWeights
from benchnav.errors import PluginError
from benchnav.generation.build import build
from benchnav.runner.plan.suite import Selection, load_suite
from benchnav.scenario.catalogue import find
from tests.reference.foresight import corrected


@pytest.mark.parametrize(
    ("scenario", "hold"), [("leaders/dynamic", 0.9), ("corridor/bidirectional", 0.3)]
)
def test_foresight_agrees_with_its_twin(scenario, hold):
    worlds = [build(find(scenario), "validation", seed) for seed in range(9)]
    rng = np.random.default_rng(0)
    batch = AgentBatch(worlds, 9, encoder("surround"), RewardWeights(), rng)
    batch.reset()
    changed = 0
    for _ in range(4):
        for _ in range(6):
            batch.step(rng.uniform(-0.5, 1.0, (9, batch.width, 2)))
        seen = batch._observe(batch.active)
        limits = batch.simulation.agents
        bodies = Bodies(limits["radius"], limits["max_speed"], limits["max_turn_rate"])
        tolerance = np.full(batch.active.shape, 0.5)
        twist = np.stack(
            [
                rng.uniform(0, bodies.max_speed),
                rng.uniform(-1, 1, tolerance.shape) * bodies.max_turn_rate,
            ],
            axis=-1,
        )
        found = foresee(seen, bodies, twist, tolerance, hold)
        for b, a in np.argwhere(batch.active):
            expected = corrected(twist[b, a], seen, bodies, tolerance, b, a, hold)
            np.testing.assert_allclose(found[b, a], expected, atol=1e-9)
            changed += bool((found[b, a] != twist[b, a]).any())
        assert (found[~batch.active] == twist[~batch.active]).all()
    assert changed > 10


def test_another_fan_of_rays_is_not_applicable_with_the_reason(tmp_path):
    said = find("circle/antipodal").model_dump(mode="json", exclude_none=True)
    said["name"], said["sensing"]["rays"]["count"] = "test/rays", 9
    del said["parameters"]  # of which the values stand where they are used

    path = tmp_path / "rays.yaml"
    path.write_text(yaml.safe_dump(said))
    wanted = Selection(scenarios=(str(path),), navigators=("recurrent-ppo", "recurrent-ppo-plus"))
    first, second = load_suite("quick", wanted).jobs()
    assert "was made for 7 thick rays over 180° and 8 m, and agents there have 9" in first.reason
    assert second.reason == ""


def test_other_weights_are_another_navigator(tmp_path):
    copy = tmp_path / "other.safetensors"
    copy.write_bytes((SHIPPED / "recurrent-ppo-plus.safetensors").read_bytes())
    spec = f"{{type: recurrent-ppo, label: mine, weights: {copy}}}"
    wanted = Selection(scenarios=("trap/u",), navigators=("recurrent-ppo", spec))
    shipped, mine = load_suite("quick", wanted).contestants
    assert shipped.fingerprint != mine.fingerprint
    before = mine.hash
    copy.write_bytes((SHIPPED / "recurrent-ppo.safetensors").read_bytes())
    assert load_suite("quick", wanted).contestants[1].hash != before
    resolved = load_suite("quick", wanted).resolved()["navigators"][0]
    assert resolved["training"]["decisions"] > 1_000_000


def test_missing_weights_are_a_mistake_of_the_user(tmp_path):
    with pytest.raises(PluginError, match="cannot be read"):
        RecurrentPPO(RecurrentPPO.Config(weights=str(tmp_path / "none.safetensors")))
