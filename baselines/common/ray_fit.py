"""Whether the rays of agents are those that an encoder was made for."""

import math

from benchnav.arena import Sensing
from benchnav.envs import Encoder
from benchnav.envs.encoders.paper import RANGE, RAYS
from benchnav.navigation import Need


def why_rays_do_not_fit(encoder: Encoder, sensing: Sensing) -> str:
    """Return why agents with these sensors cannot use the encoder; "" if they can."""
    rays = sensing.rays
    if Need.RAYS not in encoder.needs or rays is None:
        return ""
    like = (rays.count, round(rays.fan, 6), rays.range, rays.thick)
    if like == (RAYS, round(math.pi, 6), RANGE, True):
        return ""
    return (
        f"its encoder {encoder.name!r} was made for {RAYS} thick rays over 180° and"
        f" {RANGE:g} m, and agents there have {rays.count}{' thick' if rays.thick else ''}"
        f" over {math.degrees(rays.fan):.0f}° and {rays.range:g} m"
    )
