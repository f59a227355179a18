"""The recipe file: scenarios, network, stages, and everything else that determines the weights."""

import hashlib
import json
from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, model_validator

from benchnav.config.document import PathKey
from benchnav.config.validation import FieldError
from benchnav.envs import ENCODERS, RewardWeights, encoder
from benchnav.errors import did_you_mean
from benchnav.navigation import Need

from ..sightings import NEEDS

Share = Annotated[float, Field(ge=0, le=1)]
Precision = Literal["float32", "bfloat16"]
Rate = Annotated[float, Field(gt=0, le=1)]
LATER_KEYS = ("hidden_movers", "perception", "precision", "processes")  # not in older recipes
LogStd = Annotated[float, Field(ge=-5, le=2)]


class _Part(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)


class Network(_Part):
    """The shape of actor and critic, which share no weights."""

    lstm_layers: int = Field(2, ge=0, le=4, description="0: no memory")
    lstm_size: int = Field(128, ge=1, le=1024)
    dense: tuple[Annotated[int, Field(ge=1, le=4096)], ...] = Field(
        (), max_length=6, description="tanh layers after the LSTM"
    )
    log_std: float = Field(0.0, ge=-5, le=2, description="initial log standard deviation")


class Course(_Part):
    """A training scenario, and its number of worlds."""

    scenario: Annotated[str, Field(min_length=1, max_length=200)]
    worlds: int = Field(1000, ge=1, le=100_000, description="seeds 0 … worlds-1 of `train`")


class Validation(_Part):
    """Success is measured at every checkpoint, deterministically, on the split `validation`."""

    scenarios: tuple[Annotated[str, Field(min_length=1, max_length=200)], ...] = ()
    worlds: int = Field(50, ge=1, le=10_000, description="of each scenario")


class Stage(_Part):
    """A stretch of training under one reward; learning rate and noise change linearly."""

    decisions: int = Field(ge=1, le=10**10, description="of agents in attempts")
    learning_rate: tuple[Rate, Rate] = Field((3e-4, 3e-4), description="at its start and end")
    batch: int = Field(1024, ge=16, le=10**6, description="decisions of a minibatch")
    epochs: int = Field(4, ge=1, le=100)
    entropy: float = Field(0.0, ge=0, le=1, description="weight of the entropy bonus")
    gamma: Share | None = Field(None, description="discount; the recipe's, if not given")
    log_std: tuple[LogStd, LogStd] | None = Field(
        None, description="log standard deviation at its start and end; if not given, it is learned"
    )
    reward: RewardWeights = RewardWeights()
    foresight: bool = Field(
        False, description="correct commands that would collide, as `recurrent-ppo-plus` does"
    )
    courses: tuple[Course, ...] | None = Field(
        None, min_length=1, max_length=100, description="the recipe's, if not given"
    )


class Recipe(_Part):
    """Validated YAML of `benchnav train`."""

    name: Annotated[str, Field(pattern=r"^[a-z0-9][a-z0-9-]*$", max_length=60)]
    trainer: Literal["recurrent-ppo"] = "recurrent-ppo"
    description: str = Field("", max_length=5000)
    encoder: str = Field("ego", description=f"one of {', '.join(ENCODERS)}")
    hidden_movers: bool = Field(
        False,
        description="keep movers that are no longer sensed in the observations for up to 2 s, at"
        " constant velocity; needs an encoder with neighbours and edges",
    )
    perception: Literal["exact", "noisy"] = Field(
        "exact", description="perception track of all worlds"
    )
    courses: tuple[Course, ...] = Field(min_length=1, max_length=100)
    rows: int = Field(64, ge=1, le=4096, description="worlds that run side by side")
    processes: int = Field(
        1, ge=1, le=256, description="learners that share the rows and average their gradients"
    )
    rollout: int = Field(64, ge=2, le=4096, description="decisions a slot makes between updates")
    sequence: int = Field(64, ge=1, le=4096, description="longest sequence that is unrolled")
    network: Network = Network()
    precision: Literal["auto", "float32", "bfloat16"] = Field(
        "auto",
        description="of matrix products while an LSTM learns; auto: bfloat16 where it is native",
    )
    gamma: Share = 0.99
    gae_lambda: Share = 0.95
    clip: Annotated[float, Field(gt=0, lt=1)] = 0.2
    stages: tuple[Stage, ...] = Field(min_length=1, max_length=20)
    checkpoint: int = Field(
        250_000, ge=1, description="decisions between checkpoints; each starts fresh worlds"
    )
    validation: Validation = Validation()
    patience: int = Field(
        0, ge=0, description="checkpoints without better success after which a stage ends; 0: never"
    )

    @property
    def hash(self) -> str:
        """16 hex digits of everything that determines the weights, except the seed."""
        fields = self.model_dump(mode="json", exclude={"description"}, exclude_none=True)
        for name in LATER_KEYS:
            if fields[name] == Recipe.model_fields[name].default:
                del fields[name]
        return hashlib.sha256(json.dumps(fields, sort_keys=True).encode()).hexdigest()[:16]

    @property
    def decisions(self) -> int:
        """The number of decisions of all stages."""
        return sum(stage.decisions for stage in self.stages)

    @model_validator(mode="after")
    def _check(self) -> "Recipe":
        if self.encoder not in ENCODERS:
            raise FieldError(
                ("encoder",),
                f"must be one of {', '.join(ENCODERS)}; got {self.encoder!r}."
                f"{did_you_mean(self.encoder, ENCODERS)}",
            )
        needs = encoder(self.encoder).needs
        if self.hidden_movers and not needs >= NEEDS:
            raise FieldError(
                ("hidden_movers",),
                f"must be false with the encoder {self.encoder!r}, which perceives by rays only",
            )
        if self.network.lstm_layers == 0 and not self.network.dense:
            raise FieldError(("network",), "must have LSTM or dense layers; got neither")
        _refuse_twice(self.courses, ("courses",))
        if self.processes > 1 and self.network.lstm_layers == 0:
            raise FieldError(("processes",), f"must be 1 without an LSTM; got {self.processes}")
        if self.processes > self.rows:
            raise FieldError(
                ("processes",), f"must be at most rows, which is {self.rows}; got {self.processes}"
            )
        for i, stage in enumerate(self.stages):
            if stage.batch <= self.sequence:
                raise FieldError(
                    ("stages", i, "batch"),
                    f"must be > sequence, which is {self.sequence}; got {stage.batch}",
                )
            if stage.foresight and self.hidden_movers:
                raise FieldError(
                    ("stages", i, "foresight"), "must be false with hidden_movers: true"
                )
            if stage.foresight and Need.EDGES not in needs:
                raise FieldError(
                    ("stages", i, "foresight"),
                    f"must be false with the encoder {self.encoder!r}, which senses no edges",
                )
            _refuse_twice(stage.courses or (), ("stages", i, "courses"))
        return self

    def gamma_of(self, stage: Stage) -> float:
        """Return the discount of a stage."""
        return self.gamma if stage.gamma is None else stage.gamma

    def courses_of(self, stage: Stage) -> tuple[Course, ...]:
        """Return the training scenarios of a stage."""
        return stage.courses or self.courses


def _refuse_twice(courses: tuple[Course, ...], where: tuple[PathKey, ...]) -> None:
    names = [course.scenario for course in courses]
    for i, name in enumerate(names):
        if name in names[:i]:
            raise FieldError((*where, i), f"must not name a scenario twice; got {name!r}")
