"""Tells Gymnasium of ``benchnav/Leader-v0``; importing this module is enough.

``gymnasium.make("benchnav.envs.gym.registration:benchnav/Leader-v0")`` imports it by itself.
"""

import gymnasium

LEADER = "benchnav/Leader-v0"


def register_envs() -> None:
    """Register what is not registered yet."""
    if LEADER not in gymnasium.registry:
        gymnasium.register(
            id=LEADER,
            entry_point="benchnav.envs.gym.leader_env:LeaderEnv",
            vector_entry_point="benchnav.envs.gym.leader_vector_env:LeaderVectorEnv",
        )


register_envs()
