"""Grey levels and opacity of an image; hostile images are refused early."""

import warnings
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from benchnav.arrays import BoolArray
from benchnav.errors import MapError
from benchnav.scenario.importers.grid import MAX_CELLS, check_size
from benchnav.system.plain_file import open_file

if TYPE_CHECKING:
    from PIL.Image import Image

Levels = NDArray[np.uint8]

_FORMATS = ("PNG", "PPM", "BMP", "JPEG", "TIFF", "GIF")  # PPM is Pillow's name for PGM too


def read_levels(path: Path) -> tuple[Levels, BoolArray]:
    """Return the grey levels (H, W) 0 to 255, row 0 at the top, and which pixels are opaque.

    A colour counts by its luma (ITU-R 601), whatever its opacity; 16 bits are rounded to 8.

    Raises:
        MapError: the image has another format, is truncated, or is too large.
    """
    from PIL import Image as pillow

    bombs = pillow.DecompressionBombWarning, pillow.DecompressionBombError
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # Pillow warns of metadata that no map needs
            warnings.simplefilter("error", pillow.DecompressionBombWarning)
            with open_file(path) as file, pillow.open(file, formats=_FORMATS) as image:
                check_size(f"{path}:1", *image.size)
                return _levels(image)
    except MapError:
        raise
    except bombs:
        raise MapError(
            f"{path}:1: a map has at most {MAX_CELLS} cells; the image has many more."
            " Cut it or scale it down."
        ) from None
    except Exception as error:  # Pillow's decoders raise a dozen kinds
        raise MapError(
            f"{path}:1: the image must be a complete JPEG, TIFF, GIF, PNG, PGM or BMP file;"
            f" got: {error}."
        ) from None


def _levels(image: "Image") -> tuple[Levels, BoolArray]:
    if image.mode.startswith("I"):  # 16 bits, which Pillow does not convert faithfully
        samples = np.asarray(image, np.int64)
        opaque = np.asarray(samples != image.info.get("transparency", -1))
        return np.clip((samples + 128) // 257, 0, 255).astype(np.uint8), opaque
    colours = image.convert("RGBA")  # applies the transparent colour of a palette or a PNG
    opaque = np.asarray(colours.getchannel("A")) == 255
    return np.array(colours.convert("L")), opaque
