"""Pictures of the worlds that an environment steps, as arrays or in a window."""

import numpy as np

from benchnav.arrays import ByteArray
from benchnav.drawing.canvas import Canvas
from benchnav.drawing.palette import HIT
from benchnav.drawing.top_view import TopView, spans
from benchnav.envs.autoreset import AutoresetSimulation
from benchnav.envs.window import Window
from benchnav.episode.episode import Status

RGB_ARRAY, HUMAN = "rgb_array", "human"
RENDER_MODES = (RGB_ARRAY, HUMAN)  # of environments of one world
FPS = 5  # decisions a second of nearly all scenarios


class Renderer:
    """Draws rows of a simulation. All pictures have one size, whatever the size of a world."""

    def __init__(self, simulation: AutoresetSimulation, size: int = 480) -> None:
        """Prepare pictures whose longer side has ``size`` pixels."""
        self._simulation, self._size = simulation, size
        self._span = spans(simulation.pool)
        self._views: dict[int, TopView] = {}

    def frame(self, row: int = 0, marked: int | None = None) -> ByteArray:
        """Return a row now as a picture (height, width, 3), with a ring around one agent."""
        return self.frames(row, [marked])[0]

    def frames(self, row: int, marked: list[int | None]) -> list[ByteArray]:
        """Return a picture of a row for each entry of ``marked``: an agent, or None."""
        view, s = self._view(row), self._simulation
        picture = view.draw(s.position[row], s.heading[row], s.body_position[row], s.present[row])
        self._draw_contacts(picture, row, len(view.world.agents))
        out = []
        for agent in marked:
            own = picture
            if agent is not None:
                own = picture.copy()
                view.ring(own, agent, s.position[row, agent])
            out.append(own.array())
        return out

    def _draw_contacts(self, picture: Canvas, row: int, agents: int) -> None:
        """Draw a cross where an agent vanished because its attempt ended in a contact."""
        s = self._simulation
        gone = (s.status[row] == int(Status.ENDED)) & ~s.present[row]
        for agent in np.flatnonzero(gone[:agents]):
            picture.cross(s.position[row, agent], HIT)

    def _view(self, row: int) -> TopView:
        world = self._simulation.worlds[row]
        view = self._views.get(row)
        if view is None or view.world is not world:
            view = self._views[row] = TopView(world, self._size, span=self._span)
        return view


class Display:
    """Shows an environment of one world: as arrays, in a window, or not at all."""

    def __init__(self, mode: str | None, simulation: AutoresetSimulation, title: str) -> None:
        """Open a window for the mode "human". Raises NoRenderingError where there is no display."""
        self._mode, self._renderer = mode, Renderer(simulation)
        rate = 1.0 / float(simulation.records["dt"][0])
        self._window = Window(title, rate) if mode == HUMAN else None

    def frame(self, marked: int | None = None) -> ByteArray | None:
        """Return a picture in the mode "rgb_array"; show it in the mode "human", return None."""
        if self._mode == RGB_ARRAY:
            return self._renderer.frame(0, marked)
        self.refresh(marked)
        return None

    def refresh(self, marked: int | None = None) -> None:
        """Show the world now in the window, if there is one."""
        if self._window is not None and self._window.is_open:
            self._window.show(self._renderer.frame(0, marked))

    def close(self) -> None:
        """Close the window."""
        if self._window is not None:
            self._window.close()
