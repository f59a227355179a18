"""A training: the folder that it leaves, and its weights."""

from pathlib import Path

from benchnav.api.output.text_table import key_value_html


class Training:
    """A finished training. `benchnav.train` makes one."""

    def __init__(self, name: str, trainer: str, seed: int, folder: Path, weights: str) -> None:
        self.name = name  # of the recipe
        self.trainer = trainer
        self.seed = seed
        self.path = folder  # with the weights, the learning curve and checkpoints
        self._weights = weights

    @property
    def weights(self) -> Path:
        """The file of the weights, which the learned navigator takes as a parameter."""
        return self.path / self._weights

    def __repr__(self) -> str:
        return f"Training({self.name!r}, seed={self.seed}: {str(self.weights)!r})"

    def _repr_html_(self) -> str:
        facts = [
            ("trainer", self.trainer),
            ("seed", str(self.seed)),
            ("weights", str(self.weights)),
        ]
        return key_value_html(f"Training {self.name}", facts)
