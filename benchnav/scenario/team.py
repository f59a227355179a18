"""Teams: starts, goals, bodies and drivers of groups of agents."""

from typing import Annotated, Any, Literal

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, model_validator

from benchnav.config.document import shown
from benchnav.config.validation import FieldError
from benchnav.scenario.base import Distance, Length, Name, Point, Spec
from benchnav.scenario.canonical import added_field, label_field
from benchnav.scenario.dynamics import Ackermann, DifferentialDrive, DynamicsSpec, Holonomic
from benchnav.scenario.entry import Entry
from benchnav.scenario.footprint import DiscFootprint, Footprint, Range
from benchnav.scenario.sampling.region import Region
from benchnav.scenario.sampling.sampler import Count, PositiveScalar, Scalar, support


class RegionStart(Spec):
    """Each agent starts at a random point of a region."""

    type: Literal["region"]
    region: Region = Field(description="region of the centres")
    separation: Distance = Field(0.0, description="smallest gap [m] between bodies at the start")


class CircleStart(Spec):
    """The agents start on a circle."""

    type: Literal["circle"]
    center: Point = Field((0.0, 0.0), description="centre [m] of the circle")
    radius: Length = Field(description="radius [m] of the circle")
    angles: Literal["even", "random"] = Field(
        "even", description="`even`: equal steps from angle 0; `random`: uniform"
    )
    jitter: Distance = Field(
        0.0, description="width of a random shift: x and y each move by up to ± half of it [m]"
    )
    separation: Distance = Field(0.0, description="smallest gap [m] between bodies at the start")
    clear_of_goals: bool = Field(
        False, description="whether `separation` also holds to the goals of agents placed before"
    )


class GridStart(Spec):
    """The agents start in rows and columns, filled row by row from the lower left."""

    type: Literal["grid"]
    origin: Point = Field(description="centre [m] of the first agent")
    columns: int = Field(ge=1, le=5000, description="agents in a full row")
    spacing: Length = Field(description="distance [m] between neighbouring centres")
    jitter: Distance = Field(
        0.0, description="width of a random shift: x and y each move by up to ± half of it [m]"
    )
    separation: Distance = Field(0.0, description="smallest gap [m] between bodies at the start")


class PackedStart(Spec):
    """The agents start on a hexagonal lattice in a region, nearest to `front` first."""

    type: Literal["packed"]
    region: Region = Field(description="region of the centres")
    front: Point = Field(description="a point [m] of the lattice; it may lie outside the region")
    spacing: Length = Field(description="distance [m] between neighbouring centres")
    jitter: Distance = Field(
        0.0, description="width of a random shift: x and y each move by up to ± half of it [m]"
    )
    separation: Distance = Field(0.0, description="smallest gap [m] between bodies at the start")


class PointsStart(Spec):
    """Agent i starts at point i."""

    type: Literal["points"]
    points: tuple[Point, ...] = Field(
        min_length=1, max_length=5000, description="starts [m], at least one for each agent"
    )
    separation: Distance = Field(0.0, description="smallest gap [m] between bodies at the start")


class RecordedStart(Spec):
    """The agent starts where and when a person of the scenario's `recording` appears."""

    type: Literal["recorded"]
    separation: Distance = Field(
        0.0, description="smallest gap [m] to the recorded people at the start"
    )


class RegionGoal(Spec):
    """Each agent's goal is a random point of a region."""

    type: Literal["region"]
    region: Region = Field(description="region of the goals")
    min_distance: Distance = Field(0.0, description="smallest distance [m] between start and goal")


class PointsGoal(Spec):
    """Agent i's goal is point i."""

    type: Literal["points"]
    points: tuple[Point, ...] = Field(
        min_length=1, max_length=5000, description="goals [m], at least one for each agent"
    )


class AntipodalGoal(Spec):
    """Each agent's goal is its start, mirrored at a centre."""

    type: Literal["antipodal"]
    center: Point = Field((0.0, 0.0), description="centre [m] of the reflection")


class ShiftedGoal(Spec):
    """Each agent's goal is its start plus a vector, so the team keeps its formation."""

    type: Literal["shifted"]
    by: Point = Field(description="shift [m] from start to goal: [x, y]")


class RecordedGoal(Spec):
    """The agent's goal is where the person of its recorded start vanishes."""

    type: Literal["recorded"]


Start = Annotated[
    RegionStart | CircleStart | GridStart | PackedStart | PointsStart | RecordedStart,
    Field(discriminator="type"),
]
Goal = Annotated[
    RegionGoal | PointsGoal | AntipodalGoal | ShiftedGoal | RecordedGoal,
    Field(discriminator="type"),
]


class NavigatorChoice(BaseModel):
    """A navigator by name, with its parameters as further keys."""

    model_config = ConfigDict(frozen=True, extra="allow", allow_inf_nan=False)

    type: str = Field(min_length=1, max_length=200, description="name of the navigator")

    @property
    def params(self) -> dict[str, Any]:
        """Return every key except ``type``."""
        return dict(self.model_extra or {})


def named(value: Any) -> Any:
    """Return the mapping of a navigator that is given by its name only."""
    return {"type": value} if isinstance(value, str) else value


def _named_robot(value: Any) -> Any:
    if not isinstance(value, str | dict):
        raise ValueError(
            f"must be the name of a robot, or a mapping with its `type`; got {shown(value)}"
        )
    return named(value)


class RobotChoice(Spec):
    """A robot by name, whose keys the team takes."""

    type: str = Field(
        min_length=1, max_length=200, description="name of the robot, or its YAML file"
    )
    acceleration_limits: bool = Field(
        True, description="whether the team takes the acceleration limits of the robot"
    )


class Team(Spec):
    """Agents that share a role, a body and a driver (the navigator that controls them).

    A leader entry and a follower entry with the same name form one team.
    """

    name: Name = Field(description="name of the team")
    role: Literal["leader", "follower"] = Field(
        "leader", description="metrics are reported for each role separately"
    )
    count: Count = Field(1.0, description="number of agents")
    robot: (
        Annotated[
            RobotChoice, BeforeValidator(_named_robot, json_schema_input_type=str | RobotChoice)
        ]
        | None
    ) = label_field(
        description="name of a robot, which gives the keys of the body and its limits; keys beside"
        " it replace those of the robot"
    )
    radius: PositiveScalar | None = Field(
        None, description="radius [m] of a body that is a disc; else give `footprint`"
    )
    footprint: Footprint | None = added_field(
        None, "0.3.0", description="shape of the body along its heading; default: a disc"
    )
    max_speed: PositiveScalar = Field(
        description="largest speed [m/s]; must be given, unless a `robot` gives it"
    )
    preferred_speed: PositiveScalar | None = Field(
        None, description="desired speed [m/s]; default: `max_speed`"
    )
    max_turn_rate: PositiveScalar = Field(
        2.5, description="largest turn rate [rad/s] of bodies that turn"
    )
    max_acceleration: PositiveScalar | None = added_field(
        None, "0.3.0", description="largest increase of speed per time [m/s²]; default: no limit"
    )
    max_deceleration: PositiveScalar | None = added_field(
        None,
        "0.3.0",
        description="largest decrease of speed per time [m/s²]; default: `max_acceleration`",
    )
    max_turn_acceleration: PositiveScalar | None = added_field(
        None,
        "0.3.0",
        description="largest change of the turn rate per time [rad/s²]; default: no limit",
    )
    dynamics: DynamicsSpec = Field(
        Holonomic(type="holonomic"), description="the motions that a body can make"
    )
    start: Start = Field(description="rule that places the agents")
    goal: Goal = Field(description="rule that sets the goals")
    heading: Literal["goal"] | Scalar = Field(
        "goal", description="heading [rad] at the start; `goal`: towards the goal"
    )
    enters: Entry = added_field(
        0.0,
        "0.3.0",
        description="time [s] at which background agents enter the arena: one for all, or a"
        " distribution, a list with a time for each agent, or a stream. An agent whose start is"
        " occupied waits until it is free",
    )
    driver: Annotated[
        NavigatorChoice, BeforeValidator(named, json_schema_input_type=str | NavigatorChoice)
    ] = Field(
        NavigatorChoice(type="evaluated"),
        description="navigator of background agents, which are not scored; `evaluated`: the"
        " navigator under test",
    )
    ignores: tuple[str, ...] = Field(
        (), description="names of teams that these agents do not sense"
    )

    @property
    def evaluated(self) -> bool:
        """Whether the evaluated navigator drives this team."""
        return self.driver.type == "evaluated"

    @property
    def disc_radius(self) -> Scalar | None:
        """Return the radius [m] of bodies that are discs; None for other shapes."""
        shape = self.footprint
        return shape.radius if isinstance(shape, DiscFootprint) else self.radius

    @property
    def outer_radius(self) -> Range:
        """Return the least and the largest radius [m] of the circle around a body."""
        if self.radius is not None:
            return support(self.radius)
        return (0.0, 0.0) if self.footprint is None else self.footprint.outer_radius

    @model_validator(mode="after")
    def _check(self) -> "Team":
        if self.radius is None and self.footprint is None:
            raise FieldError(
                ("radius",), "must be given, or `footprint` for other shapes, or `robot`"
            )
        if self.radius is not None and self.footprint is not None:
            raise FieldError(
                ("radius",), "must be left out, because it follows from `footprint`; remove one"
            )
        most = support(self.count)[1]
        for key, place in (("start", self.start), ("goal", self.goal)):
            if isinstance(place, PointsStart | PointsGoal) and len(place.points) < most:
                raise FieldError(
                    (key, "points"),
                    f"must have a point for each of up to {most:g} agents; got {len(place.points)}",
                )
        if isinstance(self.start, RecordedStart) != isinstance(self.goal, RecordedGoal):
            raise FieldError(("goal",), "must be `recorded` if and only if the start is")
        if isinstance(self.start, RecordedStart) and not (self.count == 1.0 and self.evaluated):
            raise FieldError(("start",), "must be of one evaluated agent if it is `recorded`")
        if self.preferred_speed is not None:
            preferred, top = support(self.preferred_speed), support(self.max_speed)
            if preferred[1] > top[1]:
                raise FieldError(
                    ("preferred_speed",), f"must be ≤ max_speed ({top[1]:g}); got {preferred[1]:g}"
                )
        self._check_dynamics()
        self._check_entry(most)
        if self.evaluated and self.driver.params:
            raise FieldError(("driver",), "takes no parameters if it is `evaluated`")
        return self

    def _check_entry(self, most: float) -> None:
        if self.evaluated and self.enters != 0.0:
            raise FieldError(
                ("enters",),
                "must be 0, or left out, for agents of the evaluated navigator: only agents with a"
                " `driver` can enter later",
            )
        if isinstance(self.enters, tuple) and len(self.enters) < most:
            raise FieldError(
                ("enters",),
                f"must have a time for each of up to {most:g} agents; got {len(self.enters)}",
            )

    def _check_dynamics(self) -> None:
        drive, fastest = self.dynamics, support(self.max_speed)[1]
        if isinstance(drive, DifferentialDrive):
            wheel = support(drive.max_wheel_speed)[0]
            if fastest > wheel:
                raise FieldError(
                    ("max_speed",),
                    f"must be ≤ dynamics.max_wheel_speed ({wheel:g}), the speed of both wheels"
                    f" straight ahead; got {fastest:g}",
                )
        if isinstance(drive, Ackermann) and self.max_turn_acceleration is not None:
            raise FieldError(
                ("max_turn_acceleration",),
                "does not apply to ackermann, whose turn rate follows from its speed and steering"
                " angle; give dynamics.max_steering_rate instead",
            )
