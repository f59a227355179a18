"""An OMPL planner with each of two controllers, under separate names."""

from pydantic import Field

from benchnav.navigation import Hierarchical
from benchnav.navigation.hierarchy.hierarchical_config import GuidedConfig, PartSpec

from ...controllers.orca.avoidance import OrcaConfig


class OmplConfig(GuidedConfig):
    """Parameters, among them which of OMPL's planners plans."""

    planner: PartSpec = Field(
        "ompl.rrt-connect", validate_default=True, description="a planner: name or {type: name, …}"
    )


class OmplPure(Hierarchical):
    """An OMPL planner with path following only: moving obstacles are not avoided."""

    class Config(OmplConfig):
        """Parameters."""

    def _controller(self) -> PartSpec:
        return "path-following"


class OmplOrca(Hierarchical):
    """An OMPL planner with optimal reciprocal collision avoidance along its path."""

    class Config(OmplConfig):
        """Parameters."""

        orca: OrcaConfig = Field(OrcaConfig(), description="parameters of the controller")

    def _controller(self) -> PartSpec:
        return {"type": "orca", **self.config.orca.model_dump()}
