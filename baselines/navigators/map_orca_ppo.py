"""A hybrid for agents without a map: they build one, and two controllers share the driving."""

from pydantic import Field

from benchnav.navigation import Hierarchical
from benchnav.navigation.hierarchy.hierarchical_config import GuidedConfig, PartSpec
from benchnav.navigation.hierarchy.mapping import MappingConfig

from ..controllers.orca_ppo import OrcaPpoConfig


class MapOrcaPpo(Hierarchical):
    """``mapping+visibility+orca-ppo``, whose agents give way if they are stuck."""

    class Config(GuidedConfig):
        """Parameters."""

        planner: PartSpec = Field(
            "visibility", validate_default=True, description="a planner: name or {type: name, …}"
        )
        mapping: MappingConfig = Field(
            MappingConfig(), description="parameters of the map that the agents make"
        )
        give_way: float = Field(
            0.5,
            ge=0,
            le=1,
            description="probability that an agent whose patience ends goes back for a while",
        )
        steering: OrcaPpoConfig = Field(
            OrcaPpoConfig(), description="parameters of the controller `orca-ppo`"
        )

    def _controller(self) -> PartSpec:
        return {"type": "orca-ppo", **self.config.steering.model_dump()}
