"""Maps of ROS map_server and nav2: a YAML file and the image that it names.

Format: https://github.com/ros-navigation/navigation2, nav2_map_server. Image row 0
is the top; the origin is the pose of the lower left corner of the lower left pixel.
"""

import re
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, model_validator

from benchnav.arrays import BoolArray
from benchnav.config.document import Document, shown
from benchnav.config.validation import FieldError, validate
from benchnav.config.yaml_reader import read_yaml
from benchnav.errors import MapError, ScenarioError, did_you_mean
from benchnav.scenario.importers.grid import Occupancy
from benchnav.scenario.importers.image import read_levels

UNKNOWN_GREY = 205  # the level that map_saver writes for unknown cells in its mode trinary

_NUMBER = re.compile(r"\s*[-+]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][-+]?[0-9]+)?\s*", re.ASCII)
_FLAGS = {
    **dict.fromkeys(("0", "n", "no", "false", "off"), False),
    **dict.fromkeys(("1", "y", "yes", "true", "on"), True),
}


def _number(value: Any) -> Any:
    """Return the number in a quoted text, as yaml-cpp reads it."""
    return float(value) if isinstance(value, str) and _NUMBER.fullmatch(value) else value


def _flag(value: Any) -> bool:
    """Return a truth value written as YAML 1.1 allows, or as 0 or 1, quoted or not."""
    text = str(value).strip().lower()
    if isinstance(value, bool | int | str) and text in _FLAGS:
        return _FLAGS[text]
    got = "nothing" if value is None else repr(value) if isinstance(value, str) else shown(value)
    raise FieldError((), f"must be 0 or 1, or yes or no; got {got}")


def _small(value: Any) -> Any:
    return value.lower() if isinstance(value, str) else value


Quotable = BeforeValidator(_number)
Number = Annotated[float, Field(allow_inf_nan=False, ge=-1e9, le=1e9), Quotable]
Share = Annotated[float, Field(allow_inf_nan=False, ge=0.0, le=1.0), Quotable]


class RosMap(BaseModel):
    """The keys of a map_server YAML file that locate and classify cells; others are ignored."""

    model_config = ConfigDict(extra="ignore", frozen=True)

    image: Annotated[str, Field(min_length=1)]
    resolution: Annotated[float, Field(allow_inf_nan=False, gt=0.0, le=1e4), Quotable]  # [m]
    origin: tuple[Number, Number, Number]  # (x, y, yaw) [m, m, rad]
    negate: Annotated[bool, BeforeValidator(_flag)]
    occupied_thresh: Share
    free_thresh: Share
    mode: Annotated[Literal["trinary", "scale", "raw"], BeforeValidator(_small)] = "trinary"

    @model_validator(mode="after")
    def _ordered(self) -> "RosMap":
        if self.free_thresh > self.occupied_thresh:
            raise FieldError(
                ("free_thresh",),
                f"must be < occupied_thresh = {self.occupied_thresh} or equal to it;"
                f" got {self.free_thresh}",
            )
        return self


def read_map(path: Path | str, cell: float | None = None) -> Occupancy:
    """Return the map that the YAML file ``path`` describes, as nav2's map_server reads it.

    A pixel of brightness v has the occupancy p = 1 − v (v if ``negate``); p ≥
    occupied_thresh is blocked, p ≤ free_thresh is free, values between are unknown.
    Mode `scale` grades values between from 0 to 100: a grade that rounds to 0 is free,
    one that rounds to 100 is blocked. A pixel that is not opaque is unknown. In mode
    `raw` a pixel's level is itself the occupancy in per cent, and unknown above 100.

    Args:
        path: the YAML file.
        cell: side of a pixel [m], instead of the file's ``resolution``.

    Raises:
        MapError: the YAML file or its image is wrong.
    """
    document, spec = read_header(path)
    levels, opaque = read_levels(image_path(document, spec))
    known = opaque if spec.mode != "raw" else np.ones_like(opaque)
    free_levels, blocked_levels = _meaning(spec)
    free, blocked = known & free_levels[levels], known & blocked_levels[levels]
    doubtful = spec.mode == "trinary" and int(np.count_nonzero(free & (levels == UNKNOWN_GREY)))
    upright = slice(None, None, -1)
    return Occupancy(
        np.ascontiguousarray(blocked[upright]),
        np.ascontiguousarray(~(free | blocked)[upright]),
        spec.resolution if cell is None else cell,
        spec.origin,
        int(doubtful),
    )


def read_header(path: Path | str) -> tuple[Document, RosMap]:
    """Return the YAML file as a document and as checked values.

    Raises:
        MapError: it is not a map_server YAML file.
    """
    try:
        document = read_yaml(path)
        return document, validate(RosMap, document)
    except ScenarioError as error:
        raise MapError(str(error)) from None


def image_path(document: Document, spec: RosMap) -> Path:
    """Return the image file, relative to the YAML file.

    Raises:
        MapError: there is no such file.
    """
    folder = Path(document.name).parent
    image = folder / spec.image
    try:
        there = image.is_file()
    except (OSError, ValueError):
        there = False
    if not there:
        near = did_you_mean(image.name, [p.name for p in folder.iterdir() if p.is_file()])
        raise MapError(
            f"{document.where(['image'])} must name an existing image file; "
            f"got {spec.image!r}, and there is no {image}.{near}"
        )
    return image


def _meaning(spec: RosMap) -> tuple[BoolArray, BoolArray]:
    """Return whether each level (256,) is free, and whether it is blocked."""
    level = np.arange(256)
    if spec.mode == "raw":
        occupancy = np.where(level <= 100, level / 100.0, np.nan)
    else:
        occupancy = level / 255.0 if spec.negate else 1.0 - level / 255.0
    low, high = spec.free_thresh, spec.occupied_thresh
    margin = 0.005 * (high - low) if spec.mode == "scale" else 0.0  # half a per cent is rounded off
    free = (occupancy <= low) | (occupancy < low + margin)
    blocked = (occupancy >= high) | (occupancy >= high - margin)
    return free, blocked & ~free
