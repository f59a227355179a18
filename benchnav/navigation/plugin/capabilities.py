"""The properties that a navigator reports before it runs."""

from collections.abc import Callable, Collection, Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import Annotated, Any, get_args

from pydantic import (
    AfterValidator,
    BaseModel,
    ConfigDict,
    Field,
    StrictBool,
    ValidationError,
)

from benchnav.arena.sensing import Sensing
from benchnav.config.model_errors import first_problem
from benchnav.errors import BenchnavError, BrokenPluginError, MissingExtraError, PluginError
from benchnav.navigation.command_check import exception_text, short
from benchnav.navigation.navigator import (
    ALL_DYNAMICS,
    CommandKind,
    DynamicsName,
    Navigator,
    Need,
    Training,
)
from benchnav.navigation.plugin.configure import Spec, configure, make, split
from benchnav.navigation.plugin.plugin_process import CONFIG, IMPORT, StepCallback
from benchnav.navigation.plugin.trace import class_name
from benchnav.plugins import NAVIGATORS, Source
from benchnav.text.plural import listed

Line = Annotated[str, AfterValidator(short)]


class Capabilities(BaseModel):
    """The reported properties as plain data; defaults are the most common values."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    needs: frozenset[Need] = Field(frozenset(), description="The inputs that it requires.")
    command: CommandKind = Field(
        "velocity", description="The kind of its commands: velocity or twist."
    )
    drives: frozenset[DynamicsName] = Field(
        ALL_DYNAMICS, description="The dynamics of the bodies that it can drive."
    )
    uses_map: StrictBool = Field(True, description="Whether the map can affect its commands.")
    reproducible: StrictBool = Field(True, description="False if a clock affects its commands.")
    remarks: StrictBool = Field(False, description="Whether it makes remarks on episodes.")
    rehearsal: int = Field(0, ge=0, description="The number of rehearsals that it requests.")
    leader: str | dict[str, Any] | None = Field(
        None, description="The leaders' navigator in rehearsals."
    )
    training: Training | None = Field(None, description="Its training: {decisions, seconds}.")
    fingerprint: Line = Field("", description="The fingerprint of the files that it reads.")
    spec: dict[str, Any] = Field({}, description="{type: name, …every parameter}.")
    made_of: tuple[Line, ...] = Field((), description="Its distributions, with versions.")
    parts: tuple[Line, ...] = Field((), description="module:attribute of each part's class.")
    unfit: tuple[Line, ...] = Field((), description='Why it cannot use each sensing; "": it can.')
    missing_extra: Line = Field("", description="The error that names the missing extra, if any.")


def read_capabilities(
    spec: Spec, sensings: Sequence[Sensing] = (), *, where: str = ""
) -> Capabilities:
    """Return the properties of the navigator of ``spec``, which is made in this process.

    Arguments and errors are those of `inspect_navigator`.
    """
    return inspect_navigator(spec, sensings, where=where)[1]


def _ignore_step(step: str) -> None:
    """Do nothing."""


def inspect_navigator(
    spec: Spec,
    sensings: Sequence[Sensing] = (),
    *,
    where: str = "",
    on_step: StepCallback = _ignore_step,
) -> tuple[Navigator | None, Capabilities]:
    """Return the navigator of ``spec`` and its properties.

    Args:
        spec: a name or ``{type: name, …parameters}``.
        sensings: to check whether it can drive agents with each of them.
        where: the place of the spec, for messages.
        on_step: called with the name of each step before the step begins.

    Raises what `make` raises, except for a missing extra: then the navigator is None, and
    ``missing_extra`` names it. Raises BrokenPluginError also for an invalid property.
    """
    name, _ = split(NAVIGATORS, spec, where=where)
    on_step(IMPORT)
    with suppress(PluginError):  # `configure` raises it with a better message
        NAVIGATORS.load(name)
    on_step(CONFIG)
    _, config = configure(NAVIGATORS, spec, where=where)
    full = {"type": name, **config.model_dump(mode="json")}
    source = NAVIGATORS.source(name).distribution
    on_step("__init__")
    try:
        navigator: Navigator = make(NAVIGATORS, spec, where=where)
    except MissingExtraError as error:
        return None, Capabilities(spec=full, made_of=(source,), missing_extra=str(error))
    broken = f"{where + ': ' if where else ''}The navigator {name!r} cannot be used: "
    if not isinstance(navigator, Navigator):
        raise BrokenPluginError(f"{broken}its class makes a {class_name(navigator)}.")
    reader = _PropertyReader(navigator, broken, on_step)
    parts = reader.get("parts", _parts)
    try:
        return navigator, Capabilities(
            needs=reader.get("required", _names),
            command=reader.get("command"),
            drives=reader.get("drives", _names),
            uses_map=reader.get("uses_map"),
            reproducible=reader.get("reproducible"),
            remarks=reader.get("remarks", lambda _: _has_remarks(navigator)),
            rehearsal=reader.get("rehearsal"),
            leader=reader.get("leader", _leader),
            training=reader.get("training"),
            fingerprint=reader.get("fingerprint"),
            spec=full,
            made_of=tuple(dict.fromkeys((source, *(part.distribution for part in parts)))),
            parts=tuple(dict.fromkeys(part.value for part in parts)),
            unfit=reader.get("unfit", lambda _: tuple(unfit(navigator, each) for each in sensings)),
        )
    except ValidationError as error:
        raise BrokenPluginError(broken + invalid_property(error)) from None


@dataclass(frozen=True)
class _PropertyReader:
    """Reads the properties of a navigator, one attribute after another."""

    navigator: Navigator
    broken: str  # the beginning of messages
    on_step: StepCallback

    def get(self, name: str, plain: Callable[[Any], Any] = lambda value: value) -> Any:
        """Return the attribute ``name``, converted by ``plain``.

        Raises BrokenPluginError if that fails.
        """
        self.on_step(name)
        try:
            return plain(getattr(self.navigator, name))
        except BenchnavError:
            raise
        except (Exception, SystemExit) as error:
            raise BrokenPluginError(
                f"{self.broken}its {name} raised {exception_text(error)}."
            ) from error


def _has_remarks(navigator: Navigator) -> bool:
    return type(navigator).remarks is not Navigator.remarks


def _names(value: Any) -> frozenset[Any]:
    if isinstance(value, str):
        raise TypeError(f"a set of names, and not {value!r}")
    return frozenset(value)


def _leader(value: Any) -> Any:
    return dict(value) if value is not None and not isinstance(value, str) else value


def _parts(value: Any) -> tuple[Source, ...]:
    parts = tuple(value)
    if not all(isinstance(part, Source) for part in parts):
        raise TypeError("parts must be benchnav.plugins.Source")
    return parts


def invalid_property(error: ValidationError) -> str:
    """Return a message on the first invalid property: its name, the rule and the value."""
    problem = first_problem(error)
    name = problem.key.partition(".")[0] or "answer"
    key = {"needs": "required"}.get(name, name)
    return f"its {key} {problem.requirement}. Got {problem.got} instead."


def undriven(drives: Collection[str], dynamics: Collection[str]) -> str:
    """Return why a navigator that ``drives`` some dynamics cannot drive all of ``dynamics``.

    "" if it can.
    """
    if set(dynamics) <= set(drives):
        return ""
    names = [name for name in get_args(DynamicsName) if name in drives]
    return f"drives {listed(names)} bodies only" if names else "drives no bodies"


def unfit(navigator: Navigator, sensing: Sensing) -> str:
    """Return why a navigator cannot drive agents with this sensing; "" if it can."""
    required = navigator.required
    missing = sorted(n for n in required - {Need.MAP} if getattr(sensing, n, None) is None)
    if missing:
        return f"needs {' and '.join(missing)}, which no sensor gives there"
    return navigator.unfit(sensing)
