"""Pictures of the world that an environment steps."""

from benchnav.arena.world import World
from benchnav.arrays import ByteArray
from benchnav.drawing.top_view import TopView
from benchnav.envs.autoreset import AutoresetSimulation

RGB_ARRAY = "rgb_array"
RENDER_MODES = (RGB_ARRAY,)


class Renderer:
    """Draws one row of a simulation; it prepares anew when the row starts another world."""

    def __init__(self) -> None:
        self._view: TopView | None = None

    def frame(
        self, simulation: AutoresetSimulation, row: int = 0, marked: int | None = None
    ) -> ByteArray:
        """Return the row now as a picture (height, width, 3), with a ring around one agent."""
        world: World = simulation.world(row)
        if self._view is None or self._view.world is not world:
            self._view = TopView(world)
        return self._view.draw(
            simulation.position[row], simulation.heading[row], simulation.body_position[row],
            simulation.present[row], marked,
        )  # fmt: skip
