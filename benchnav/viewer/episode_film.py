"""The frames of a moving picture: episodes from above, side by side and in step."""

import math
from collections.abc import Iterator, Sequence

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from benchnav.arena.body import LawKind, absent
from benchnav.arena.solid import Kind
from benchnav.arrays import ByteArray, FloatArray
from benchnav.drawing.canvas import Canvas, shade
from benchnav.drawing.palette import FILL, HIT, INK, PAPER, agent_color
from benchnav.drawing.top_view import TopView, spans
from benchnav.episode.episode import Episode, Status
from benchnav.metrics.quantities.episode_analysis import analyse
from benchnav.metrics.quantities.trajectory import positions_at, present_at

WIDTH, HEIGHT = 400, 600  # [pixels] of one arena at most; twice as many in a large film
MARK = 5.0  # [s] between the marks on a trail
FLASH = 0.6  # [s] that a contact stays marked after its end
_FINER, _FINER_LARGE = 3, 4
_HEAD, _FONT, _GAP = 24, 13, 6  # [pixels] above each arena, of its text, and at its ends


def film(
    episodes: Sequence[Episode], times: Sequence[float], *, large: bool = False, note: str = ""
) -> Iterator[ByteArray]:
    """Yield a picture (height, width, 3) of all episodes for each of the rising ``times`` [s].

    ``large`` pictures have twice the width and height; ``note`` is written behind the time.
    """
    span = spans(tuple(episode.world for episode in episodes))
    size = round(min(WIDTH * max(1.0, span[1] / span[0]), max(WIDTH, HEIGHT)))
    films = [EpisodeFilm(episode, span, size, large=large, note=note) for episode in episodes]
    columns = len(films) if len(films) <= 3 else math.ceil(math.sqrt(len(films)))
    for time in times:
        panels = [each.frame(time) for each in films]
        if columns > 1:
            panels = [_spaced(panel) for panel in panels]
        blank = np.full_like(panels[0], 255)
        panels += [blank] * (-len(panels) % columns)
        rows = [panels[n : n + columns] for n in range(0, len(panels), columns)]
        yield np.vstack([np.hstack(row) for row in rows])


class EpisodeFilm:
    """Draws one episode at rising times. Trails only grow, so each piece is drawn once."""

    def __init__(
        self, episode: Episode, span: FloatArray, size: int, *, large: bool = False, note: str = ""
    ) -> None:
        """Prepare frames of ``span`` (2,) [m], the longer side with ``size`` pixels.

        ``large`` doubles the size of everything; ``note`` is written behind the time.
        """
        self._larger, self._note = 2 if large else 1, note
        self._heading = np.unwrap(episode.heading, axis=0)
        self._episode, self._trajectories = episode, analyse(episode).trajectories
        self._view = TopView(
            episode.world, size, span=span, finer=_FINER_LARGE if large else _FINER
        )
        self._trails = self._view.background
        self._colors = [agent_color(episode.world, a) for a in range(len(self._trajectories))]
        self._drawn = 0.0  # [s] until when the trails are drawn
        for way in episode.body_position.transpose(1, 0, 2):
            self._trails.dots(way[~absent(way)], FILL[Kind.DYNAMIC], apart=3.0)

    def frame(self, time: float) -> ByteArray:
        """Return the picture (height, width, 3) at ``time`` [s], or of the end if it is later.

        Motion between two states is linear.
        """
        episode = self._episode
        time = min(time, float(episode.times[-1]))
        self._extend_trails(time)
        present = present_at(self._trajectories, np.array([time]))[:, 0]
        places = positions_at(self._trajectories, np.array([time]))[:, 0]
        bodies = self._bodies(time)
        picture = self._view.draw(
            places, self._between(self._heading, time), bodies, present, self._trails.copy()
        )
        self._draw_ends(picture, time)
        self._draw_contacts(picture, time, places, bodies)
        state = int(time / episode.world.clock.dt + 1e-6)
        status = episode.status[state, episode.world.agents.evaluated]
        arrived = int((status == int(Status.ARRIVED)).sum())
        text = f"{arrived} of {len(status)} arrived, {time:.1f} s{self._note}"
        return _headed(picture.array(self._larger), episode.identity.navigator, text, self._larger)

    def _between(self, states: FloatArray, time: float) -> FloatArray:
        """Return the values (…) of ``states`` (T+1, …) at ``time`` [s], linear between states."""
        at = time / self._episode.world.clock.dt
        low = min(int(at + 1e-6), len(states) - 1)
        share = max(0.0, at - low)
        value: FloatArray = states[low]
        if low + 1 < len(states):
            value = (1.0 - share) * value + share * states[low + 1]
        return value

    def _bodies(self, time: float) -> FloatArray:
        """Return the places (M, 2) [m] of moving obstacles; some are re-placed, come or go."""
        states = self._episode.body_position
        places = self._between(states, time).copy()
        state = int(time / self._episode.world.clock.dt + 1e-6)
        after = min(state + 1, len(states) - 1)
        jumps = np.array([b.law.kind == LawKind.RELOCATE for b in self._episode.world.bodies], bool)
        jumps |= absent(states[state]) != absent(states[after])
        places[jumps] = states[state, jumps]
        return places

    def _extend_trails(self, until: float) -> None:
        """Draw the pieces since the last frame: darker until an attempt ends, a mark every 5 s."""
        cut, dt = self._trajectories, self._episode.world.clock.dt
        first, last = round(self._drawn / dt), round(until / dt)
        marks = np.arange(math.floor(self._drawn / MARK) + 1, until / MARK + 1e-9) * MARK
        places, begin = positions_at(cut, marks), cut.begin
        for a, color in enumerate(self._colors):
            entered = max(first, round(begin[a] / dt))
            piece = cut.position[a, entered : min(last, int(cut.last[a])) + 1]
            if len(piece) > 1:
                strength = 0.4 + 0.6 * min(1.0, until / max(float(cut.end[a]), dt))
                self._trails.line(piece, shade(color, strength), 1.6)
            for place, mark in zip(places[a], marks, strict=True):
                if begin[a] <= mark <= cut.end[a]:
                    self._trails.disc(place, 0.0, fill=color, least=2.0)
        self._drawn = until

    def _draw_ends(self, picture: Canvas, time: float) -> None:
        """Draw a cross where an attempt ended without arrival."""
        cut = self._trajectories
        lost = ~np.isin(self._episode.status[-1], (int(Status.ARRIVED), int(Status.WAITING)))
        lost &= cut.end <= time + 1e-9
        for a in np.flatnonzero(lost):
            picture.cross(cut.position[a, -1], self._colors[a], arm=5.0, width=2.5)

    def _draw_contacts(
        self, picture: Canvas, time: float, places: FloatArray, bodies: FloatArray
    ) -> None:
        """Draw rings around agents in contact, and lines to agents and obstacles that they hit."""
        episode, contacts = self._episode, self._episode.contacts
        shown = (contacts.start <= time + 1e-9) & (time <= contacts.end + FLASH)
        for n in np.flatnonzero(shown):
            agent, partner = int(contacts.agent[n]), int(contacts.partner[n])
            fade = 1.0 - max(0.0, time - float(contacts.end[n])) / FLASH
            color, place = shade(HIT, 0.25 + 0.75 * fade), places[agent]
            other = None
            if contacts.kind[n] == int(Kind.AGENT):
                other = places[partner]
            elif partner < 0:
                other = bodies[-1 - partner]
            if other is not None:
                picture.line(np.array([place, other]), color, 2.0)
            radius = float(episode.world.agents.radius[agent])
            picture.disc(place, 1.5 * radius, outline=color, width=2.5, least=7.0)


def _spaced(panel: ByteArray) -> ByteArray:
    """Return a panel with paper at its sides, so that walls of neighbours do not join."""
    spaced: ByteArray = np.pad(panel, ((0, 0), (_GAP // 2, _GAP // 2), (0, 0)), constant_values=255)
    return spaced


def _headed(picture: ByteArray, left: str, right: str, larger: int) -> ByteArray:
    """Return a picture with a line of text above it; the left text is cut if it is too long."""
    high, wide = picture.shape[:2]
    head, gap = larger * _HEAD, larger * _GAP
    whole = Image.new("RGB", (wide, high + head), PAPER)
    whole.paste(Image.fromarray(picture), (0, head))
    draw, font = ImageDraw.Draw(whole), ImageFont.load_default(larger * _FONT)
    space = wide - 3 * gap - draw.textlength(right, font)
    name = left
    while name and draw.textlength(name, font) > space:
        left = left[:-1]
        name = f"{left}…" if left else ""
    draw.text((gap, head / 2), name, INK, font, "lm")
    draw.text((wide - gap, head / 2), right, INK, font, "rm")
    return np.asarray(whole)
