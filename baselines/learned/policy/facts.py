"""The YAML file beside a policy: what the file of the policy does not hold."""

from pathlib import Path
from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field

from benchnav.config.yaml_reader import read_yaml, validate

Box = Annotated[tuple[float, float], Field()]


class PolicyFacts(BaseModel):
    """Content of ``NAME.yaml`` beside ``NAME.zip`` or ``NAME.onnx``."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    encoder: str = Field("", description="encoder of the environment in which it was trained")
    activation: str = Field("", description="activation of the dense layers")
    low: Box | None = Field(None, description="lower limits of its actions")
    high: Box | None = Field(None, description="upper limits of its actions")
    decisions: int = Field(0, ge=0, description="cost of the training, which tables show")
    seconds: float = Field(0.0, ge=0, description="[s] the same")
    training: dict[str, Any] = Field({}, description="remarks for readers, such as the recipe")


def facts_beside(policy: Path) -> tuple[PolicyFacts, bytes]:
    """Return the facts about a policy and the bytes of their file; defaults if there is none.

    Raises ScenarioError for a mistake in the file.
    """
    path = policy.with_suffix(".yaml")
    if not path.is_file():
        return PolicyFacts(), b""
    return validate(PolicyFacts, read_yaml(path)), path.read_bytes()
