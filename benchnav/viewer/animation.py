"""Episodes as moving pictures: GIF and MP4 files."""

from collections.abc import Sequence
from itertools import chain
from pathlib import Path

import numpy as np
from PIL import Image

from benchnav.drawing.canvas import shade
from benchnav.drawing.palette import HIT, channels
from benchnav.episode.episode import Episode
from benchnav.errors import MissingExtraError
from benchnav.system.plain_file import writing
from benchnav.viewer.episode_film import film

LONGEST = 10.0  # [s] that a GIF lasts, at most
GIF_RATE, FILM_RATE = 10, 25  # [frames/s]
_COLORS = 64


def save_gif(episodes: Sequence[Episode], path: Path) -> None:
    """Write episodes side by side as a GIF that repeats, in real time.

    Longer episodes than `LONGEST` are played faster, and the speed is written in the picture.
    Raises StoreError if the file cannot be written.
    """
    speed = max(1.0, longest(episodes) / LONGEST)
    times = frame_times(episodes, GIF_RATE / speed)
    note = f", {speed:.2g}x" if speed > 1.0 else ""
    frames = [Image.fromarray(frame) for frame in film(episodes, times, note=note)]
    palette = _palette(frames)
    same = [frame.quantize(palette=palette, dither=Image.Dither.NONE) for frame in frames]
    with writing(path):
        same[0].save(
            path, save_all=True, append_images=same[1:], duration=1000 // GIF_RATE, loop=0,
            optimize=True,
        )  # fmt: skip


def save_mp4(episodes: Sequence[Episode], path: Path) -> None:
    """Write episodes side by side as an MP4 film (H.264) in real time.

    Raises MissingExtraError without the encoder, StoreError if the file cannot be written.
    """
    try:
        from imageio_ffmpeg import write_frames
    except ImportError as error:
        raise MissingExtraError("A film", "video") from error
    frames = film(episodes, frame_times(episodes, FILM_RATE), large=len(episodes) == 1)
    first = next(frames)
    high, wide = first.shape[0] // 2 * 2, first.shape[1] // 2 * 2  # H.264 needs even sizes
    with writing(path):
        path.open("wb").close()  # an error is noticed here, not in the encoder
        encoder = write_frames(
            str(path), (wide, high), fps=FILM_RATE, macro_block_size=2, ffmpeg_log_level="fatal"
        )
        encoder.send(None)
        for frame in chain([first], frames):
            encoder.send(np.ascontiguousarray(frame[:high, :wide]))
        encoder.close()


def longest(episodes: Sequence[Episode]) -> float:
    """Return the duration [s] of the longest episode."""
    return max(float(episode.times[-1]) for episode in episodes)


def frame_times(episodes: Sequence[Episode], rate: float) -> list[float]:
    """Return the times [s] of ``rate`` frames a second, from the start to the last end."""
    end = longest(episodes)
    times: list[float] = np.linspace(0.0, end, round(end * rate) + 1).tolist()
    return times


def _palette(frames: Sequence[Image.Image]) -> Image.Image:
    """Return the colours of a GIF: those of some frames, and those of contacts, which are rare."""
    chosen = frames[:: max(1, len(frames) // 8)]
    wide, high = frames[0].size
    sheet = Image.new("RGB", (wide, high * len(chosen)))
    for n, frame in enumerate(chosen):
        sheet.paste(frame, (0, n * high))
    contacts = [channels(shade(HIT, strength)) for strength in (0.25, 0.5, 0.75, 1.0)]
    table = np.array(sheet.quantize(_COLORS - len(contacts)).getpalette()).reshape(-1, 3)
    table[(table > 245).all(axis=1)] = 255  # paper, which the mean of its edges tints
    palette = Image.new("P", (1, 1))
    palette.putpalette([*table.ravel().tolist(), *chain.from_iterable(contacts)])
    return palette
