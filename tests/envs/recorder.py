"""What attempts there really were, read off a batch beside the environment that shows it."""

from dataclasses import dataclass


@dataclass
class Attempt:
    row: int
    agent: int
    length: int
    reward: float
    success: bool


class Recorder:
    """Records every attempt that ends in ``batch``, whatever an environment makes of it."""

    def __init__(self, batch):
        self.attempts, self._going = [], {}
        self._step = batch.step
        batch.step = self.step

    def step(self, action, instead=None):
        step = self._step(action, instead)
        for row, agent in zip(*step.acted.nonzero(), strict=True):
            at = (int(row), int(agent))
            length, reward = self._going.get(at, (0, 0.0))
            length, reward = length + 1, reward + float(step.reward[at])
            self._going[at] = (length, reward)
            if step.over[at]:
                del self._going[at]
                self.attempts.append(Attempt(*at, length, reward, bool(step.arrived[at])))
        return step

    @property
    def lengths(self):
        return sorted(attempt.length for attempt in self.attempts)

    @property
    def rewards(self):
        return sorted(attempt.reward for attempt in self.attempts)
