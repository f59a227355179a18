"""An OMPL planner with each of two controllers, under names of their own."""

from pydantic import Field

from benchnav.navigation.hierarchy.hierarchical import Hierarchical
from benchnav.navigation.hierarchy.hierarchical_config import GuidedConfig, PartSpec

from ...controllers.orca.avoidance import OrcaConfig


class OmplPure(Hierarchical):
    """An OMPL planner, and path following alone: nothing that moves is avoided."""

    class Config(GuidedConfig):
        """Parameters."""

    def _controller(self) -> PartSpec:
        return "path-following"


class OmplOrca(Hierarchical):
    """An OMPL planner, and optimal reciprocal collision avoidance along its path."""

    class Config(GuidedConfig):
        """Parameters."""

        orca: OrcaConfig = Field(OrcaConfig(), description="parameters of the controller")

    def _controller(self) -> PartSpec:
        return {"type": "orca", **self.config.orca.model_dump()}
