"""The maps that a knowledge track grants for the worlds of a simulation, as they are now."""

from benchnav.navigation.map import Map
from benchnav.navigation.tracks import granted_map
from benchnav.world.simulation import Simulation


class HeldMaps:
    """The map of each world of a simulation, replaced when its static obstacles are re-placed.

    Args:
        simulation: B worlds; call `begin` for a row before its map is used.
        track: the knowledge track that grants the maps.
    """

    def __init__(self, simulation: Simulation, track: str) -> None:
        self._simulation = simulation
        self._track = track
        self._maps: list[Map | None] = [None] * simulation.B
        self._moving: set[int] = set()  # rows whose map may change

    def begin(self, row: int) -> Map | None:
        """Return the map of the world that starts in ``row``, and keep it for `now`."""
        world = self._simulation.worlds[row]
        self._maps[row] = granted_map(world, self._track)
        self._moving.discard(row)
        if self._track == "known" and world.relocates:
            self._moving.add(row)
        return self._maps[row]

    def now(self) -> tuple[Map | None, ...]:
        """Return the (B,) maps as they are now."""
        simulation = self._simulation
        for row in self._moving:
            held, revision = self._maps[row], int(simulation.revision[row])
            if held is not None and held.revision != revision:
                position = simulation.body_position[row].copy()
                world = simulation.worlds[row]
                self._maps[row] = granted_map(world, self._track, position, revision)
        return tuple(self._maps)
