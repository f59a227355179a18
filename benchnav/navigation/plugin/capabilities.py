"""What a navigator says of itself before it runs: all that whoever runs it must know."""

from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import Annotated, Any

from pydantic import (
    AfterValidator,
    BaseModel,
    ConfigDict,
    Field,
    StrictBool,
    ValidationError,
)

from benchnav.arena.sensing import Sensing
from benchnav.errors import BenchnavError, BrokenPluginError, MissingExtraError, PluginError
from benchnav.navigation.command_check import said, short
from benchnav.navigation.navigator import CommandKind, Navigator, Need, Training
from benchnav.navigation.plugin.configure import Spec, configure, make, split
from benchnav.navigation.plugin.plugin_process import CONFIG, IMPORT, Stepping
from benchnav.navigation.plugin.trace import class_name
from benchnav.plugins import NAVIGATORS, Source

Line = Annotated[str, AfterValidator(short)]


class Introduction(BaseModel):
    """Plain data, of which each has the value that it has for most."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    needs: frozenset[Need] = Field(frozenset(), description="What it cannot do without.")
    command: CommandKind = Field("velocity", description="What it answers: velocity or twist.")
    uses_map: StrictBool = Field(True, description="False where no map changes what it answers.")
    reproducible: StrictBool = Field(True, description="False where a clock decides its answers.")
    remarks: StrictBool = Field(False, description="Whether it has something to tell of episodes.")
    rehearsal: int = Field(0, ge=0, description="Rehearsals that it asks for.")
    leader: str | dict[str, Any] | None = Field(None, description="Who leads in them.")
    training: Training | None = Field(None, description="{decisions, seconds} that it took.")
    fingerprint: Line = Field("", description="Of the files that it reads.")
    spec: dict[str, Any] = Field({}, description="{type: name, …every parameter}.")
    made_of: tuple[Line, ...] = Field((), description="Distributions, with their versions.")
    parts: tuple[Line, ...] = Field((), description="module:attribute of each part's class.")
    unfit: tuple[Line, ...] = Field((), description="Why it cannot, for each sensing asked.")
    lacks: Line = Field("", description="What is not installed that it needs to be made.")


def introduction(spec: Spec, sensings: Sequence[Sensing] = (), *, where: str = "") -> Introduction:
    """What the navigator of ``spec`` says of itself; it is made for it, in this process.

    Takes and raises what `meet` does.
    """
    return meet(spec, sensings, where=where)[1]


def _unnoticed(step: str) -> None:
    """Nobody is told."""


def meet(
    spec: Spec,
    sensings: Sequence[Sensing] = (),
    *,
    where: str = "",
    stepping: Stepping = _unnoticed,
) -> tuple[Navigator | None, Introduction]:
    """The navigator of ``spec``, and what it says of itself.

    Args:
        spec: a name or ``{type: name, …parameters}``.
        sensings: of which it says whether it can drive agents that sense so.
        where: what the spec stands at, for messages.
        stepping: is told what is asked next.

    Raises what `make` raises, but for what is not installed: this is said, and there is none.
    BrokenPluginError also where it says of itself what cannot be.
    """
    name, _ = split(NAVIGATORS, spec, where=where)
    stepping(IMPORT)
    with suppress(PluginError):  # `configure` says it better
        NAVIGATORS.load(name)
    stepping(CONFIG)
    _, config = configure(NAVIGATORS, spec, where=where)
    full = {"type": name, **config.model_dump(mode="json")}
    source = NAVIGATORS.source(name).distribution
    stepping("__init__")
    try:
        navigator: Navigator = make(NAVIGATORS, spec, where=where)
    except MissingExtraError as error:
        return None, Introduction(spec=full, made_of=(source,), lacks=str(error))
    broken = f"{where + ': ' if where else ''}The navigator {name!r} cannot be used: "
    if not isinstance(navigator, Navigator):
        raise BrokenPluginError(f"{broken}its class makes a {class_name(navigator)}.")
    asked = _Asked(navigator, broken, stepping)
    parts = asked.get("parts", _parts)
    try:
        return navigator, Introduction(
            needs=asked.get("required", _needs),
            command=asked.get("command"),
            uses_map=asked.get("uses_map"),
            reproducible=asked.get("reproducible"),
            remarks=asked.get("remarks", lambda _: _has_remarks(navigator)),
            rehearsal=asked.get("rehearsal"),
            leader=asked.get("leader", _leader),
            training=asked.get("training"),
            fingerprint=asked.get("fingerprint"),
            spec=full,
            made_of=tuple(dict.fromkeys((source, *(part.distribution for part in parts)))),
            parts=tuple(dict.fromkeys(part.value for part in parts)),
            unfit=asked.get("unfit", lambda _: tuple(unfit(navigator, each) for each in sensings)),
        )
    except ValidationError as error:
        raise BrokenPluginError(broken + lie(error)) from None


@dataclass(frozen=True)
class _Asked:
    """Reads what a navigator says of itself, one attribute after another."""

    navigator: Navigator
    broken: str  # how a message begins
    stepping: Stepping

    def get(self, name: str, plain: Callable[[Any], Any] = lambda value: value) -> Any:
        """The attribute ``name`` as ``plain`` makes it of what is there.

        Raises BrokenPluginError where that fails.
        """
        self.stepping(name)
        try:
            return plain(getattr(self.navigator, name))
        except BenchnavError:
            raise
        except (Exception, SystemExit) as error:
            raise BrokenPluginError(f"{self.broken}its {name} raised {said(error)}.") from error


def _has_remarks(navigator: Navigator) -> bool:
    return type(navigator).remarks is not Navigator.remarks


def _needs(value: Any) -> frozenset[Any]:
    if isinstance(value, str):
        raise TypeError(f"a set of needs, and not {value!r}")
    return frozenset(value)


def _leader(value: Any) -> Any:
    return dict(value) if value is not None and not isinstance(value, str) else value


def _parts(value: Any) -> tuple[Source, ...]:
    parts = tuple(value)
    if not all(isinstance(part, Source) for part in parts):
        raise TypeError("parts must be benchnav.plugins.Source")
    return parts


def lie(error: ValidationError) -> str:
    """Which attribute is not what it must be, and what it is."""
    first = error.errors()[0]
    name = str(first["loc"][0]) if first["loc"] else "answer"
    key = {"needs": "required"}.get(name, name)
    rule = first["msg"].removeprefix("Input should be ")
    return f"its {key} must be {rule}. Got {short(_text(first['input']))} instead."


def _text(value: object) -> str:
    try:
        return repr(value)
    except (Exception, SystemExit):
        return f"a {class_name(value)}"


def unfit(navigator: Navigator, sensing: Sensing) -> str:
    """Why it cannot drive agents that sense so; "" where it can."""
    required = navigator.required
    lacking = sorted(n for n in required - {Need.MAP} if getattr(sensing, n, None) is None)
    if lacking:
        return f"needs {' and '.join(lacking)}, which nobody senses there"
    return navigator.unfit(sensing)
