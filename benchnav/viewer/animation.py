"""Episodes as moving pictures: GIF and MP4 files."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import chain
from pathlib import Path
from typing import Any

import numpy as np

from benchnav.arrays import AnyArray
from benchnav.episode.episode import Episode
from benchnav.errors import MissingExtraError
from benchnav.system.plain_file import writing
from benchnav.viewer.picture import blank
from benchnav.viewer.scene_figure import aspect, draw_episode

FRAMES = 100  # of a GIF at most, whatever the length of the episode
RATE = 10  # [frames/s]
_COLORS = 64
_WIDTH, _DPI = 4.0, 90  # [inch] of one arena, [dots/inch]


def save_gif(episodes: Sequence[Episode], path: Path) -> None:
    """Write episodes side by side as a GIF that repeats: at most 10 s, faster if need be.

    Raises MissingExtraError without matplotlib, StoreError if the file cannot be written.
    """
    from PIL.Image import Dither, fromarray

    frames = [fromarray(frame) for frame in _frames(episodes, frame_times(episodes, FRAMES))]
    palette = frames[len(frames) // 2].quantize(_COLORS)
    same = [frame.quantize(palette=palette, dither=Dither.NONE) for frame in frames]
    with writing(path):
        same[0].save(
            path, save_all=True, append_images=same[1:], duration=1000 // RATE, loop=0,
            optimize=True,
        )  # fmt: skip


def save_mp4(episodes: Sequence[Episode], path: Path) -> None:
    """Write episodes side by side as an MP4 film (H.264) in real time.

    Raises MissingExtraError without matplotlib or the encoder, StoreError if the file cannot be
    written.
    """
    try:
        from imageio_ffmpeg import write_frames
    except ImportError as error:
        raise MissingExtraError("A film", "video") from error
    frames = _frames(episodes, frame_times(episodes))
    first = next(frames)
    high, wide = first.shape[0] // 2 * 2, first.shape[1] // 2 * 2  # H.264 needs even sizes
    rate = 1.0 / min(episode.world.clock.dt for episode in episodes)
    with writing(path):
        path.open("wb").close()  # a missing folder is noticed here, not in the encoder
        encoder = write_frames(
            str(path), (wide, high), fps=rate, macro_block_size=2, ffmpeg_log_level="fatal"
        )
        encoder.send(None)
        for frame in chain([first], frames):
            encoder.send(np.ascontiguousarray(frame[:high, :wide]))
        encoder.close()


def frame_times(episodes: Sequence[Episode], most: int | None = None) -> list[float]:
    """Return the times [s] of frames: states of the longest episode, evenly spaced, or all."""
    longest = max(episodes, key=lambda episode: len(episode.position))
    states = len(longest.position)
    count = states if most is None else min(states, most)
    chosen = np.unique(np.linspace(0, states - 1, count).round().astype(int))
    return [float(time) for time in longest.times[chosen]]


def _frames(episodes: Sequence[Episode], times: Sequence[float]) -> Iterator[AnyArray]:
    """Yield pictures (height, width, 3) of bytes."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    ratio = min(aspect(episode.world) for episode in episodes)
    figure = blank(_WIDTH * len(episodes), _WIDTH / ratio + 0.3)
    figure.set_dpi(_DPI)
    canvas: Any = FigureCanvasAgg(figure)
    panels = figure.subplots(1, len(episodes), squeeze=False)[0]
    for time in times:
        for axes, episode in zip(panels, episodes, strict=True):
            axes.clear()
            draw_episode(axes, episode, min(time, float(episode.times[-1])))
            axes.set_title(f"{episode.identity.navigator}, {time:.1f} s", fontsize=9)
        canvas.draw()
        yield np.asarray(canvas.buffer_rgba())[..., :3]
