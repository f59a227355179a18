"""Register ``benchnav/Leader-v0`` in Gymnasium, by an import of this module.

``gymnasium.make("benchnav.envs.gym.registration:benchnav/Leader-v0")`` imports it.
"""

import gymnasium

LEADER = "benchnav/Leader-v0"


def register_envs() -> None:
    """Register the environments that are not registered yet."""
    if LEADER not in gymnasium.registry:
        gymnasium.register(
            id=LEADER,
            entry_point="benchnav.envs.gym.leader_env:LeaderEnv",
            vector_entry_point="benchnav.envs.gym.leader_vector_env:LeaderVectorEnv",
        )


register_envs()
