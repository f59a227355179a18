"""Encoders by name."""

from benchnav.envs.encoders.dynamic_window import DynamicWindowEncoder
from benchnav.envs.encoders.encoder import Encoder
from benchnav.envs.encoders.near import NearEncoder
from benchnav.envs.encoders.panorama import PanoramaEncoder
from benchnav.envs.encoders.paper import EgoEncoder, PaperEncoder
from benchnav.envs.encoders.surround import SurroundEncoder
from benchnav.errors import UsageError, did_you_mean

_OTHERS = {
    kind.name: kind
    for kind in (NearEncoder, SurroundEncoder, PanoramaEncoder, DynamicWindowEncoder)
}
ENCODERS = ("paper", "paper-static", "ego", "ego-static", *_OTHERS)


def encoder(name: str) -> Encoder:
    """Return the encoder with ``name``; the static ones have no numbers about movers.

    Raises UsageError if there is none.
    """
    if name not in ENCODERS:
        raise UsageError(
            f"An encoder must be one of {', '.join(ENCODERS)}. Got {name!r} instead."
            f"{did_you_mean(name, ENCODERS)}"
        )
    if name in _OTHERS:
        return _OTHERS[name]()
    kind = PaperEncoder if name.startswith("paper") else EgoEncoder
    return kind(movers=not name.endswith("-static"))
