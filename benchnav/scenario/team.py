"""Teams: starts, goals, bodies and drivers of groups of agents."""

from typing import Annotated, Any, Literal

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, model_validator

from benchnav.config.validation import FieldError
from benchnav.scenario.base import Distance, Length, Name, Point, Spec
from benchnav.scenario.sampling.region import Region
from benchnav.scenario.sampling.sampler import Count, PositiveScalar, Scalar, support


class RegionStart(Spec):
    """Each agent somewhere in a region."""

    type: Literal["region"]
    region: Region
    separation: Distance = Field(0.0, description="least gap [m] to any agent at the start")


class CircleStart(Spec):
    """Agents on a circle."""

    type: Literal["circle"]
    center: Point = Field((0.0, 0.0), description="[m]")
    radius: Length = Field(description="[m]")
    angles: Literal["even", "random"] = Field("even", description="even begins at angle 0")
    jitter: Distance = Field(
        0.0, description="x and y are each shifted by up to half of it either way [m]"
    )
    separation: Distance = Field(0.0, description="least gap [m] to any agent at the start")
    clear_of_goals: bool = Field(
        False, description="keep the gap to the goals of those placed before, too"
    )


class GridStart(Spec):
    """Agents in rows and columns, row by row from the lower left."""

    type: Literal["grid"]
    origin: Point = Field(description="centre of the first agent [m]")
    columns: int = Field(ge=1, le=5000)
    spacing: Length = Field(description="between centres [m]")
    jitter: Distance = Field(
        0.0, description="x and y are each shifted by up to half of it either way [m]"
    )
    separation: Distance = Field(0.0, description="least gap [m] to any agent at the start")


class PackedStart(Spec):
    """Agents on a hexagonal lattice in a region, those nearest to its front first."""

    type: Literal["packed"]
    region: Region = Field(description="of their centres")
    front: Point = Field(description="a point of the lattice, also beside the region [m]")
    spacing: Length = Field(description="between centres [m]")
    jitter: Distance = Field(
        0.0, description="x and y are each shifted by up to half of it either way [m]"
    )
    separation: Distance = Field(0.0, description="least gap [m] to any agent at the start")


class PointsStart(Spec):
    """Agent i at point i."""

    type: Literal["points"]
    points: tuple[Point, ...] = Field(min_length=1, max_length=5000, description="[m]")
    separation: Distance = Field(0.0, description="least gap [m] to any agent at the start")


class RegionGoal(Spec):
    """Each agent's goal somewhere in a region."""

    type: Literal["region"]
    region: Region
    min_distance: Distance = Field(0.0, description="least distance [m] from the start")


class PointsGoal(Spec):
    """Agent i's goal is point i."""

    type: Literal["points"]
    points: tuple[Point, ...] = Field(min_length=1, max_length=5000, description="[m]")


class AntipodalGoal(Spec):
    """Each agent's goal is its start, mirrored through a centre."""

    type: Literal["antipodal"]
    center: Point = Field((0.0, 0.0), description="[m]")


class ShiftedGoal(Spec):
    """Each agent's goal is its start, moved by a vector: a group keeps its formation."""

    type: Literal["shifted"]
    by: Point = Field(description="[m]")


Start = Annotated[
    RegionStart | CircleStart | GridStart | PackedStart | PointsStart, Field(discriminator="type")
]
Goal = Annotated[RegionGoal | PointsGoal | AntipodalGoal | ShiftedGoal, Field(discriminator="type")]


class NavigatorChoice(BaseModel):
    """A navigator by name, with its parameters as further keys."""

    model_config = ConfigDict(frozen=True, extra="allow", allow_inf_nan=False)

    type: str = Field(min_length=1, max_length=200)

    @property
    def params(self) -> dict[str, Any]:
        """Return every key except ``type``."""
        return dict(self.model_extra or {})


def _named(value: Any) -> Any:
    return {"type": value} if isinstance(value, str) else value


class Team(Spec):
    """Agents that share a role, a body and a driver.

    Two teams with one name, one for each role, form one team of leaders and followers.
    """

    name: Name
    role: Literal["leader", "follower"] = "leader"
    count: Count = Field(1.0, description="agents in the team")
    radius: PositiveScalar = Field(description="[m]")
    max_speed: PositiveScalar = Field(description="[m/s]")
    preferred_speed: PositiveScalar | None = Field(
        None, description="[m/s]; max_speed if not given"
    )
    max_turn_rate: PositiveScalar = Field(2.5, description="[rad/s], of unicycles")
    dynamics: Literal["holonomic", "unicycle"] = "holonomic"
    start: Start
    goal: Goal
    heading: Literal["goal"] | Scalar = Field(
        "goal", description="at the start [rad], or goal: towards the goal"
    )
    driver: Annotated[
        NavigatorChoice, BeforeValidator(_named, json_schema_input_type=str | NavigatorChoice)
    ] = NavigatorChoice(type="evaluated")
    ignores: tuple[str, ...] = Field((), description="teams that these agents do not perceive")

    @property
    def evaluated(self) -> bool:
        """Whether the evaluated navigator drives this team."""
        return self.driver.type == "evaluated"

    @model_validator(mode="after")
    def _check(self) -> "Team":
        most = support(self.count)[1]
        for key, place in (("start", self.start), ("goal", self.goal)):
            if isinstance(place, PointsStart | PointsGoal) and len(place.points) < most:
                raise FieldError(
                    (key, "points"),
                    f"must have a point for each of up to {most:g} agents; got {len(place.points)}",
                )
        if self.preferred_speed is not None:
            preferred, top = support(self.preferred_speed), support(self.max_speed)
            if preferred[1] > top[1]:
                raise FieldError(
                    ("preferred_speed",), f"must be ≤ max_speed ({top[1]:g}); got {preferred[1]:g}"
                )
        if self.evaluated and self.driver.params:
            raise FieldError(("driver",), "takes no parameters if it is `evaluated`")
        return self
