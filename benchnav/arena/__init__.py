"""The parts of a drawn world. A name is loaded when it is first used."""

from typing import TYPE_CHECKING

from benchnav.lazy_names import lazy_names

if TYPE_CHECKING:
    from benchnav.arena.agents import Agents, Dynamics, Role
    from benchnav.arena.body import Body, Law, LawKind
    from benchnav.arena.mesh import Mesh
    from benchnav.arena.noise import EdgeNoise, NeighbourNoise, Noise, OdometryNoise, RayNoise
    from benchnav.arena.sensing import EdgeSensor, NeighbourSensor, RaySensor, Sensing
    from benchnav.arena.solid import Kind, Solid
    from benchnav.arena.world import Afterwards, Charge, Clock, ContactRule, Rules, World
else:
    __getattr__ = lazy_names(
        __name__,
        {
            "Afterwards": "benchnav.arena.world",
            "Agents": "benchnav.arena.agents",
            "Body": "benchnav.arena.body",
            "Charge": "benchnav.arena.world",
            "Clock": "benchnav.arena.world",
            "ContactRule": "benchnav.arena.world",
            "Dynamics": "benchnav.arena.agents",
            "EdgeNoise": "benchnav.arena.noise",
            "EdgeSensor": "benchnav.arena.sensing",
            "Kind": "benchnav.arena.solid",
            "Law": "benchnav.arena.body",
            "LawKind": "benchnav.arena.body",
            "Mesh": "benchnav.arena.mesh",
            "NeighbourNoise": "benchnav.arena.noise",
            "NeighbourSensor": "benchnav.arena.sensing",
            "Noise": "benchnav.arena.noise",
            "OdometryNoise": "benchnav.arena.noise",
            "RayNoise": "benchnav.arena.noise",
            "RaySensor": "benchnav.arena.sensing",
            "Role": "benchnav.arena.agents",
            "Rules": "benchnav.arena.world",
            "Sensing": "benchnav.arena.sensing",
            "Solid": "benchnav.arena.solid",
            "World": "benchnav.arena.world",
        },
    )

__all__ = [
    "Afterwards",
    "Agents",
    "Body",
    "Charge",
    "Clock",
    "ContactRule",
    "Dynamics",
    "EdgeNoise",
    "EdgeSensor",
    "Kind",
    "Law",
    "LawKind",
    "Mesh",
    "NeighbourNoise",
    "NeighbourSensor",
    "Noise",
    "OdometryNoise",
    "RayNoise",
    "RaySensor",
    "Role",
    "Rules",
    "Sensing",
    "Solid",
    "World",
]
