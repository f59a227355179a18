"""The senses of some agents in the perception track `noisy`.

Rays, neighbours and edges are sensed exactly, and errors are added to the copies. Random numbers
are a hash of the world's key, the agent, the decision and the channel, so all navigators meet the
same noise at the same decision. The memory is the error of each pose, and late readings.
"""

import numpy as np

from benchnav.arena.noise import Noise
from benchnav.arrays import AnyArray, BoolArray, FloatArray, IntArray
from benchnav.geometry.rotation import cos_sin
from benchnav.sensors.noise.delay import Delay
from benchnav.sensors.noise.edge_noise import disturb_edges
from benchnav.sensors.noise.neighbour_noise import disturb_neighbours
from benchnav.sensors.noise.odometry import drift, estimate_own_state, turn_back
from benchnav.sensors.noise.ray_noise import disturb_rays
from benchnav.sensors.readings import Edges, Neighbours, Rays
from benchnav.sensors.sense import EDGES, LEAST, NEIGHBOURS, ray_angles, sense
from benchnav.threads import run_rows
from benchnav.world.simulation import Simulation


class NoisySenses:
    """The noise of the senses of the agents ``chosen`` (B, An) of a simulation, and its memory.

    `begin` starts a world; then `sense` must be called at every decision, and may be called more
    than once.

    Args:
        simulation: B worlds with one sensing and one clock.
        chosen: (B, An) indices of agents, -1: padding.
        noise: the errors.
    """

    def __init__(self, simulation: Simulation, chosen: IntArray, noise: Noise) -> None:
        self._simulation = simulation
        self._chosen = np.array(chosen, np.int64)
        self.noise = noise
        self._keys = np.zeros((simulation.B, 2), np.uint64)
        self.pose_error = np.zeros((*chosen.shape, 3))  # (B, An, 3) x, y [m], heading [rad]
        self._last = np.zeros((*chosen.shape, 3))
        self._done = np.full(simulation.B, -1)  # decisions at the last call; -1: not started
        self._delay = Delay(noise.delay)
        sensor = simulation.worlds[0].sensing.rays
        angles = np.zeros(0) if sensor is None else ray_angles(sensor)
        self._fan = np.array([cos_sin(angle) for angle in angles]).reshape(-1, 2).T.copy()

    def begin(self, rows: IntArray, keys: AnyArray) -> None:
        """Start the worlds in ``rows`` (N,) with the noise of ``keys`` (N, 2) of uint64."""
        self._keys[rows] = keys
        self._done[rows] = -1

    def sense(
        self, active: BoolArray, needs: frozenset[str]
    ) -> tuple[Rays | None, Neighbours | None, Edges | None]:
        """Return the readings of the agents that are ``active`` (B, An); blank for others.

        Raises RuntimeError if decisions were taken without a call.
        """
        s = self._simulation
        self._drift()
        chosen, identities = np.where(active, self._chosen, -1), dict[str, IntArray]()
        rays, neighbours, edges = sense(s, chosen, needs, identities)
        if rays is not None:
            self._disturb_rays(chosen, rays)
        if neighbours is not None:
            self._disturb_neighbours(chosen, neighbours, identities[NEIGHBOURS])
        if edges is not None:
            self._disturb_edges(chosen, edges, identities[EDGES])
        for readings in (rays, neighbours, edges):
            if readings is not None:
                self._delay.exchange(readings, active, s.steps_done)
        return rays, neighbours, edges

    def localise(self, position: FloatArray, heading: FloatArray, velocity: FloatArray) -> None:
        """Replace true own states (B, An, …) by their estimates."""
        rows = self._simulation.B
        estimate_own_state(0, rows, self._chosen, self.pose_error, position, heading, velocity)

    def in_world_frame(self, rows: IntArray, velocity: FloatArray) -> FloatArray:
        """Return planar velocities (N, An, 2) [m/s] of the worlds ``rows`` in the world frame.

        A body that believes its heading to be θ + φ drives a velocity turned by -φ.
        """
        turned = velocity.copy()
        turn_back(0, len(rows), rows, self.pose_error, turned)
        return turned

    def _drift(self) -> None:
        s, n = self._simulation, self.noise.odometry
        if ((self._done >= 0) & (s.steps_done > self._done + 1)).any():
            raise RuntimeError("Noisy senses must sense at every decision; some were left out.")
        period = 0
        if n.correction_period is not None:
            period = max(round(n.correction_period / s.worlds[0].clock.dt), 1)
        run_rows(
            drift, s.B, self._chosen, s.records, s.agents, self._keys, n.distance_noise,
            n.heading_noise, n.turning_noise, period, n.correction_position_noise,
            n.correction_heading_noise, self.pose_error, self._last, self._done, least=64,
        )  # fmt: skip

    def _disturb_rays(self, chosen: IntArray, out: Rays) -> None:
        s, n = self._simulation, self.noise.rays
        sensor = s.worlds[0].sensing.rays
        assert sensor is not None  # noqa: S101 - there are readings
        fan_x, fan_y = self._fan
        run_rows(
            disturb_rays, chosen.size, chosen, out.angle, fan_x, fan_y, float(sensor.range),
            int(sensor.circle), n.noise, n.relative_noise, n.quadratic_noise, n.dropout,
            n.approach_noise, n.field_of_view, s.records, s.agents, self._keys, self.pose_error,
            out.distance, out.kind, out.approach, out.across, out.goal, least=LEAST,
        )  # fmt: skip

    def _disturb_neighbours(self, chosen: IntArray, out: Neighbours, identity: IntArray) -> None:
        s, n = self._simulation, self.noise.neighbours
        sensor = s.worlds[0].sensing.neighbours
        assert sensor is not None  # noqa: S101 - there are readings
        run_rows(
            disturb_neighbours, chosen.size, chosen, float(sensor.range), n.position_noise,
            n.velocity_noise, n.missed, n.false_alarms, n.field_of_view, s.records, s.agents,
            self._keys, self.pose_error, identity, out.position, out.velocity, out.radius,
            out.kind, out.heading, out.half_length, out.half_width, out.rounding, out.count,
            least=LEAST,
        )  # fmt: skip

    def _disturb_edges(self, chosen: IntArray, out: Edges, identity: IntArray) -> None:
        s, n = self._simulation, self.noise.edges
        run_rows(
            disturb_edges, chosen.size, chosen, n.offset_noise, n.missed, n.field_of_view,
            s.records, s.agents, self._keys, self.pose_error, identity, out.start, out.end,
            out.before, out.after, out.start_convex, out.end_convex, out.count, least=LEAST,
        )  # fmt: skip
