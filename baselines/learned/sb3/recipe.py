"""The recipe file: an algorithm with its hyperparameters, and the worlds in which it learns."""

from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, StrictBool, StrictInt, model_validator

from benchnav.config.validation import FieldError
from benchnav.envs import ENCODERS, RewardWeights
from benchnav.errors import did_you_mean

ALGORITHMS = ("A2C", "DDPG", "PPO", "RecurrentPPO", "SAC", "TD3", "TQC", "TRPO")
RECURRENT = "RecurrentPPO"
Scenario = Annotated[str, Field(min_length=1, max_length=200)]
Width = Annotated[int, Field(ge=1, le=4096)]
Value = StrictBool | StrictInt | float | str | tuple[float, float] | None


class _Part(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)


class Course(_Part):
    """A training scenario, and its number of worlds."""

    scenario: Scenario
    worlds: int = Field(500, ge=1, le=100_000, description="seeds 0 … worlds-1 of `train`")
    rows: int = Field(16, ge=1, le=4096, description="number of simultaneous worlds")


class Network(_Part):
    """The layers of actor and critic; a value that is not given is the algorithm's default."""

    dense: tuple[Width, ...] | None = Field(None, max_length=6, description="sizes of the layers")
    activation: Literal["tanh", "relu", "leaky-relu", "elu", "silu"] | None = None
    lstm_size: int | None = Field(None, ge=1, le=1024, description="for RecurrentPPO")
    lstm_layers: int | None = Field(None, ge=1, le=4, description="for RecurrentPPO")


class Validation(_Part):
    """Success is measured at every checkpoint, deterministically, on the split `validation`."""

    scenarios: tuple[Scenario, ...] = Field((), description="none: those of the courses")
    worlds: int = Field(25, ge=1, le=10_000, description="of each scenario")


class Recipe(_Part):
    """Validated YAML of `benchnav train`."""

    name: Annotated[str, Field(pattern=r"^[a-z0-9][a-z0-9-]*$", max_length=60)]
    trainer: Literal["sb3-algorithm"]
    description: str = Field("", max_length=5000)
    algorithm: str = Field(description=f"one of {', '.join(ALGORITHMS)}")
    hyperparameters: dict[str, Value] = Field(
        {}, description="of the algorithm, by the names that its library gives them"
    )
    network: Network = Network()
    encoder: str = Field("ego", description=f"one of {', '.join(ENCODERS)}")
    perception: Literal["exact", "noisy"] = "exact"
    courses: tuple[Course, ...] = Field(min_length=1, max_length=100)
    reward: RewardWeights = RewardWeights()
    decisions: int = Field(ge=1, le=10**10, description="of agents in attempts")
    checkpoint: int = Field(100_000, ge=1, description="decisions between checkpoints")
    validation: Validation = Validation()

    @model_validator(mode="after")
    def _check(self) -> "Recipe":
        for key, allowed in (("algorithm", ALGORITHMS), ("encoder", ENCODERS)):
            given = getattr(self, key)
            if given not in allowed:
                raise FieldError(
                    (key,),
                    f"must be one of {', '.join(allowed)}; got {given!r}."
                    f"{did_you_mean(given, allowed)}",
                )
        for key in ("lstm_size", "lstm_layers"):
            if getattr(self.network, key) is not None and self.algorithm != RECURRENT:
                raise FieldError(
                    ("network", key), f"is for {RECURRENT}; {self.algorithm} has no memory"
                )
        return self
