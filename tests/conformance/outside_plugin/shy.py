"""Walks to its goal and shies away from whoever is near."""

from pydantic import Field

from benchnav.navigation.navigator import AgentNavigator, Need, PluginConfig


class Shy(AgentNavigator):
    class Config(PluginConfig):
        fear: float = Field(0.5, ge=0, description="[m²/s] push of a neighbour at 1 m")

    needs = frozenset({Need.NEIGHBOURS})

    def act_agent(self, view, briefing):
        away = [
            (view.position - p) / ((view.position - p) @ (view.position - p))
            for p, _, _ in view.neighbours
        ]
        return view.goal - view.position + self.config.fear * sum(away)
