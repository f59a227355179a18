"""Brightness of a greyscale or colour image, refused early when it is hostile."""

import warnings
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from benchnav.arrays import AnyArray, BoolArray, FloatArray
from benchnav.errors import MapError
from benchnav.scenario.importers.grid import check_size

if TYPE_CHECKING:
    from PIL.Image import Image

_FORMATS = ("PNG", "BMP", "PPM")  # PPM is Pillow's name for PGM too


def read_shades(path: Path, average_alpha: bool) -> tuple[FloatArray, BoolArray]:
    """(H, W) brightness in [0, 1], row 0 at the top, and (H, W) True where fully opaque.

    The brightness of a pixel is the mean of its colours; with ``average_alpha``
    its opacity counts as one more colour, which is what map_server does in its
    mode `trinary`.

    Raises:
        MapError: not a PNG, PGM or BMP image, cut short, or too large.
    """
    from PIL import Image as pillow

    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")  # Pillow warns of images that unpack to gigabytes
            with pillow.open(path, formats=_FORMATS) as image:
                check_size(f"{path}:1", *image.size)
                channels, top = _channels(image)
    except MapError:
        raise
    except Exception as error:  # Pillow's decoders raise a dozen kinds
        raise MapError(
            f"{path}:1: the image must be a whole PNG, PGM or BMP file; got: {error}."
        ) from None
    values = np.asarray(channels, np.float64) / top
    opaque = np.ones(values.shape[:2], bool)
    if values.shape[2] in {2, 4}:  # grey or RGB, and opacity
        opaque = values[..., -1] >= 1.0
        if not average_alpha:
            values = values[..., :-1]
    return values.mean(axis=2), opaque


def _channels(image: "Image") -> tuple[AnyArray, float]:
    """(H, W, C) samples and the value of full brightness; colours before opacity."""
    if image.mode.startswith("I"):  # 16 bits
        return np.asarray(image, np.int64)[..., None], 65535.0
    if image.mode == "P":
        image = image.convert("RGBA" if "transparency" in image.info else "RGB")
    elif image.mode not in {"L", "LA", "RGB", "RGBA"}:
        image = image.convert("L" if image.mode == "1" else "RGBA")
    samples = np.asarray(image)
    return samples.reshape(*samples.shape[:2], -1), 255.0
