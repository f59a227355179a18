"""The recipe of a Q-learning training: scenarios, duration, exploration and rates."""

from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field

from .practice import Reward

Share = Annotated[float, Field(ge=0, le=1)]


class Recipe(BaseModel):
    """Validated YAML of `benchnav train`."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    name: Annotated[str, Field(pattern=r"^[a-z0-9][a-z0-9-]*$", max_length=60)]
    trainer: Literal["q-learning"]
    description: str = Field("", max_length=5000)
    scenarios: tuple[Annotated[str, Field(min_length=1, max_length=200)], ...] = Field(
        ("leaders/static", "leaders/dynamic"), min_length=1, description="the worlds take turns"
    )
    rounds: int = Field(700, ge=1, le=10**6)
    decisions: int = Field(8, ge=1, le=10**4, description="per round, in every world")
    worlds: int = Field(1024, ge=1, le=10**5, description="number of simultaneous worlds")
    patience: int = Field(100, ge=1, description="decisions after which a world starts over")
    discount: Share = Field(0.96, description="per decision")
    explore: tuple[Share, Share] = Field(
        (0.3, 0.02), description="share of random moves, at first and last"
    )
    rate: tuple[Share, Share] = Field((0.1, 0.003), description="step size, at first and last")
    reward: Reward = Reward()

    def at(self, ends: tuple[float, float], k: int) -> float:
        """Return the value in round k: geometric between the two ends."""
        share = min(1.0, k / max(0.85 * self.rounds, 1.0))
        return float(ends[0] * (ends[1] / ends[0]) ** share)
