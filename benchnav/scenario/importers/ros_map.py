"""Maps of ROS map_server and nav2: a YAML file and the image that it names.

Format: https://github.com/ros-navigation/navigation2, nav2_map_server. Image row 0
is the top; the origin is the pose of the lower left corner of the lower left pixel.
"""

from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, model_validator

from benchnav.arrays import BoolArray, FloatArray
from benchnav.errors import MapError, ScenarioError, did_you_mean
from benchnav.scenario.document import Document
from benchnav.scenario.importers.grid import Occupancy
from benchnav.scenario.importers.image import read_shades
from benchnav.scenario.validation import FieldError, validate
from benchnav.scenario.yaml_reader import read_yaml

Number = Annotated[float, Field(allow_inf_nan=False, ge=-1e9, le=1e9)]
Share = Annotated[float, Field(allow_inf_nan=False, ge=0.0, le=1.0)]


class RosMap(BaseModel):
    """The keys of a map_server YAML file that say where the cells are; others are ignored."""

    model_config = ConfigDict(extra="ignore", frozen=True)

    image: Annotated[str, Field(min_length=1)]
    resolution: Annotated[float, Field(allow_inf_nan=False, gt=0.0, le=1e4)]  # [m] a pixel
    origin: tuple[Number, Number, Number]  # (x, y, yaw) [m, m, rad]
    negate: Literal[0, 1] | bool
    occupied_thresh: Share
    free_thresh: Share
    mode: Literal["trinary", "scale", "raw"] = "trinary"

    @model_validator(mode="after")
    def _ordered(self) -> "RosMap":
        if self.free_thresh >= self.occupied_thresh:
            raise FieldError(
                ("free_thresh",),
                f"must be < occupied_thresh = {self.occupied_thresh}; got {self.free_thresh}",
            )
        return self


def read_map(path: Path | str, cell: float | None = None) -> Occupancy:
    """The map that the YAML file ``path`` describes.

    Thresholds follow the map_server conventions: a pixel of brightness v has the
    occupancy p = 1 − v (v if ``negate``); p ≥ occupied_thresh is blocked, p ≤
    free_thresh is free, anything between is unknown. In mode `scale` a pixel that is
    not opaque is unknown. In mode `raw` a pixel's value is itself the occupancy in
    per cent, and unknown above 100.

    Args:
        path: the YAML file.
        cell: [m] a pixel, instead of the file's ``resolution``.

    Raises:
        MapError: the YAML file or its image is not what it must be.
    """
    document, spec = read_header(path)
    image = image_path(document, spec)
    shade, opaque = read_shades(image, average_alpha=spec.mode == "trinary")
    blocked, unknown = _cells(spec, shade, opaque)
    upright = slice(None, None, -1)
    return Occupancy(
        np.ascontiguousarray(blocked[upright]),
        np.ascontiguousarray(unknown[upright]),
        spec.resolution if cell is None else cell,
        spec.origin,
    )


def read_header(path: Path | str) -> tuple[Document, RosMap]:
    """The YAML file as a document and as checked values.

    Raises:
        MapError: it is not a map_server YAML file.
    """
    try:
        document = read_yaml(path)
        return document, validate(RosMap, document)
    except ScenarioError as error:
        raise MapError(str(error)) from None


def image_path(document: Document, spec: RosMap) -> Path:
    """The image file, relative to the YAML file.

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
        near = did_you_mean(image.name, [p.name for p in folder.iterdir()])
        raise MapError(
            f"{document.where(['image'])} must name an existing image file; "
            f"got {spec.image!r}, and there is no {image}.{near}"
        )
    return image


def _cells(spec: RosMap, shade: FloatArray, opaque: BoolArray) -> tuple[BoolArray, BoolArray]:
    """(blocked, unknown) in image order."""
    occupancy = shade if spec.negate else 1.0 - shade
    known = np.ones(shade.shape, bool)
    if spec.mode == "raw":
        percent = np.rint(shade * 255.0)
        occupancy, known = percent / 100.0, percent <= 100.0
    elif spec.mode == "scale":
        known = opaque
    blocked = known & (occupancy >= spec.occupied_thresh)
    free = known & (occupancy <= spec.free_thresh)
    return blocked, ~(blocked | free)
