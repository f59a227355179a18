"""A trainer of another package."""

from pathlib import Path

from pydantic import BaseModel

from benchnav.envs.trainer import Trainer


class Recipe(BaseModel):
    name: str
    trainer: str
    description: str = ""


class Teacher(Trainer[Recipe]):
    """Writes its seed down."""

    Recipe = Recipe
    recipes = Path(__file__).parent / "outside_arenas" / "_recipes"

    def train(self, recipe, seed, out, *, resume, device, report):
        out.mkdir(parents=True, exist_ok=True)
        (out / "weights.safetensors").write_text(f"{recipe.name} {seed}")
