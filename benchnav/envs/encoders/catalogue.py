"""Encoders by name."""

from benchnav.envs.encoders.encoder import Encoder
from benchnav.envs.encoders.near import NearEncoder
from benchnav.envs.encoders.outlook import OutlookEncoder
from benchnav.envs.encoders.panorama import PanoramaEncoder
from benchnav.envs.encoders.paper import EgoEncoder, PaperEncoder
from benchnav.envs.encoders.surround import SurroundEncoder
from benchnav.errors import UsageError, did_you_mean

ENCODERS = ("paper", "paper-static", "ego", "ego-static", "near", "surround", "panorama", "outlook")


def encoder(name: str) -> Encoder:
    """Return the encoder with ``name``; the static ones have no numbers about movers.

    Raises UsageError if there is none.
    """
    if name not in ENCODERS:
        raise UsageError(
            f"An encoder must be one of {', '.join(ENCODERS)}. Got {name!r} instead."
            f"{did_you_mean(name, ENCODERS)}"
        )
    if name == "surround":
        return SurroundEncoder()
    if name == "panorama":
        return PanoramaEncoder()
    if name == "outlook":
        return OutlookEncoder()
    if name == "near":
        return NearEncoder()
    kind = PaperEncoder if name.startswith("paper") else EgoEncoder
    return kind(movers=not name.endswith("-static"))
