"""The record of collision events in the reference simulator."""

from dataclasses import dataclass, field

RELEASE = 0.01  # [m] a contact ends at a wider gap
MAX_HITS = 8  # after this many touches within a substep, an agent is wedged
MAX_OPEN = 8  # contacts of one agent at one time; one more closes the oldest

Partner = tuple[str, int]  # ("agent" | "solid" | "body", index)


@dataclass
class Event:
    """A contact of one agent with one partner."""

    agent: int
    partner: Partner
    start: float
    closing: float
    charged: bool
    penetration: float = 0.0
    end: float = float("nan")


@dataclass
class Ledger:
    """Open and closed events."""

    opened: dict[tuple[int, Partner], Event] = field(default_factory=dict)
    closed: list[Event] = field(default_factory=list)

    def record(
        self, agent: int, partner: Partner, time: float, closing: float, charged: bool
    ) -> None:
        """Record a touch: a new event, unless an event of the two is open."""
        if (agent, partner) in self.opened:
            return
        own = [event for event in self.opened.values() if event.agent == agent]
        if len(own) == MAX_OPEN:
            self.close(min(own, key=lambda event: event.start), time)
        self.opened[agent, partner] = Event(agent, partner, time, closing, charged)

    def close(self, event: Event, time: float) -> None:
        """Close an event."""
        event.end = time
        self.closed.append(self.opened.pop((event.agent, event.partner)))

    def close_all(self, agent: int, time: float) -> None:
        """Close all events of ``agent``, whose attempt is over."""
        for event in [event for event in self.opened.values() if event.agent == agent]:
            self.close(event, time)

    def follow_up(self, event: Event, gap: float, time: float) -> None:
        """After a substep, deepen a contact that lasts, and close one that ended."""
        if gap > RELEASE:
            self.close(event, time)
        else:
            event.penetration = max(event.penetration, -gap)
