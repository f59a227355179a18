"""What a navigator says of itself before it runs: all that whoever runs it must know."""

from collections.abc import Sequence
from typing import Any

from pydantic import BaseModel, ConfigDict, Field

from benchnav.arena.sensing import Sensing
from benchnav.errors import MissingExtraError
from benchnav.navigation.configure import Spec, configure, make, split
from benchnav.navigation.navigator import CommandKind, Navigator, Need, Training
from benchnav.plugins import NAVIGATORS


class Introduction(BaseModel):
    """Plain data, of which each has the value that it has for most."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    needs: frozenset[Need] = Field(frozenset(), description="What it cannot do without.")
    command: CommandKind = Field("velocity", description="What it answers: velocity or twist.")
    uses_map: bool = Field(True, description="False where no map changes what it answers.")
    reproducible: bool = Field(True, description="False where a clock decides what it answers.")
    remarks: bool = Field(False, description="Whether it has something to tell of episodes.")
    rehearsal: int = Field(0, ge=0, description="Rehearsals that it asks for.")
    leader: str | dict[str, Any] | None = Field(None, description="Who leads in them.")
    training: Training | None = Field(None, description="{decisions, seconds} that it took.")
    fingerprint: str = Field("", description="Of the files that it reads.")
    spec: dict[str, Any] = Field({}, description="{type: name, …every parameter}.")
    made_of: tuple[str, ...] = Field((), description="Distributions, with their versions.")
    parts: tuple[str, ...] = Field((), description="module:attribute of each part's class.")
    unfit: tuple[str, ...] = Field((), description="Why it cannot, for each sensing asked.")
    lacks: str = Field("", description="What is not installed that it needs to be made.")


def introduction(spec: Spec, sensings: Sequence[Sensing] = (), *, where: str = "") -> Introduction:
    """What the navigator of ``spec`` says of itself; it is made for it, in this process.

    Takes and raises what `meet` does.
    """
    return meet(spec, sensings, where=where)[1]


def meet(
    spec: Spec, sensings: Sequence[Sensing] = (), *, where: str = ""
) -> tuple[Navigator | None, Introduction]:
    """The navigator of ``spec``, and what it says of itself.

    Args:
        spec: a name or ``{type: name, …parameters}``.
        sensings: of which it says whether it can drive agents that sense so.
        where: what the spec stands at, for messages.

    Raises what `make` raises, but for what is not installed: this is said, and there is none.
    """
    name, _ = split(NAVIGATORS, spec, where=where)
    _, config = configure(NAVIGATORS, spec, where=where)
    full = {"type": name, **config.model_dump(mode="json")}
    source = NAVIGATORS.source(name).distribution
    try:
        navigator: Navigator = make(NAVIGATORS, spec, where=where)
    except MissingExtraError as error:
        return None, Introduction(spec=full, made_of=(source,), lacks=str(error))
    led = navigator.leader
    return navigator, Introduction(
        needs=navigator.required,
        command=navigator.command,
        uses_map=navigator.uses_map,
        reproducible=navigator.reproducible,
        remarks=type(navigator).remarks is not Navigator.remarks,
        rehearsal=navigator.rehearsal,
        leader=dict(led) if led is not None and not isinstance(led, str) else led,
        training=navigator.training,
        fingerprint=navigator.fingerprint,
        spec=full,
        made_of=tuple(dict.fromkeys((source, *(part.distribution for part in navigator.parts)))),
        parts=tuple(dict.fromkeys(part.value for part in navigator.parts)),
        unfit=tuple(unfit(navigator, sensing) for sensing in sensings),
    )


def unfit(navigator: Navigator, sensing: Sensing) -> str:
    """Why it cannot drive agents that sense so; "" where it can."""
    required = navigator.required
    lacking = sorted(n for n in required - {Need.MAP} if getattr(sensing, n, None) is None)
    if lacking:
        return f"needs {' and '.join(lacking)}, which nobody senses there"
    return navigator.unfit(sensing)
