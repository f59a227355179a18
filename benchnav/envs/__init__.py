"""Learning environments over the benchmark's own worlds, sensors and contacts.

Names are loaded at their first use. `benchnav.make_env` makes environments.
"""

from typing import TYPE_CHECKING

from benchnav.lazy_names import lazy_names

if TYPE_CHECKING:
    from benchnav.envs.agent_batch import AgentBatch
    from benchnav.envs.encoders.catalogue import ENCODERS, encoder
    from benchnav.envs.encoders.encoder import Bodies, Encoder
    from benchnav.envs.gym.leader_env import LeaderEnv
    from benchnav.envs.gym.leader_vector_env import LeaderVectorEnv
    from benchnav.envs.parallel_env import LeadersEnv
    from benchnav.envs.reward import RewardWeights
    from benchnav.envs.sb3.agent_vec_env import AgentVecEnv
    from benchnav.envs.sb3.attempt_monitor import AttemptMonitor
    from benchnav.envs.sb3.attempt_ppo import AttemptPPO
    from benchnav.envs.sb3.live_buffer import LiveBuffer
    from benchnav.envs.sb3.live_replay_buffer import LiveReplayBuffer
    from benchnav.envs.trainer import Trainer, TrainingReport
else:
    __getattr__ = lazy_names(
        __name__,
        {
            "AgentBatch": "benchnav.envs.agent_batch",
            "AgentVecEnv": "benchnav.envs.sb3.agent_vec_env",
            "AttemptMonitor": "benchnav.envs.sb3.attempt_monitor",
            "AttemptPPO": "benchnav.envs.sb3.attempt_ppo",
            "Bodies": "benchnav.envs.encoders.encoder",
            "ENCODERS": "benchnav.envs.encoders.catalogue",
            "Encoder": "benchnav.envs.encoders.encoder",
            "LeaderEnv": "benchnav.envs.gym.leader_env",
            "LeaderVectorEnv": "benchnav.envs.gym.leader_vector_env",
            "LeadersEnv": "benchnav.envs.parallel_env",
            "LiveBuffer": "benchnav.envs.sb3.live_buffer",
            "LiveReplayBuffer": "benchnav.envs.sb3.live_replay_buffer",
            "RewardWeights": "benchnav.envs.reward",
            "Trainer": "benchnav.envs.trainer",
            "TrainingReport": "benchnav.envs.trainer",
            "encoder": "benchnav.envs.encoders.catalogue",
        },
    )

__all__ = [
    "ENCODERS",
    "AgentBatch",
    "AgentVecEnv",
    "AttemptMonitor",
    "AttemptPPO",
    "Bodies",
    "Encoder",
    "LeaderEnv",
    "LeaderVectorEnv",
    "LeadersEnv",
    "LiveBuffer",
    "LiveReplayBuffer",
    "RewardWeights",
    "Trainer",
    "TrainingReport",
    "encoder",
]
