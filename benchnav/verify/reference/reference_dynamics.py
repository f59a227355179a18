"""Commands within the limits of a body, slowly: the reference of `benchnav.world.motion_limits`."""

import math
from dataclasses import dataclass

import numpy as np

from benchnav.arena.agents import Agents, Dynamics
from benchnav.arrays import FloatArray

_ROUNDING = 1e-9  # [rad] of the direction of a velocity


@dataclass
class Drive:
    """One body: its limits, and the motion that it was last commanded to make."""

    agents: Agents
    index: int
    dt: float
    command: FloatArray  # (2,) executed last: a planar velocity, or a twist if it turns
    steering: float = 0.0  # [rad]
    doubtful: bool = False  # rounding decides to which side the body turns

    def limit(self, name: str) -> float:
        """Return the body's value of a column of `Agents`."""
        return float(getattr(self.agents, name)[self.index])

    @property
    def dynamics(self) -> Dynamics:
        """The kind of body."""
        return Dynamics(int(self.agents.dynamics[self.index]))

    def executed(self, command: FloatArray, twist: bool, heading: float) -> FloatArray:
        """Return the command (2,) that is executed where ``command`` (2,) is requested."""
        self.doubtful = False
        if self.dynamics is Dynamics.HOLONOMIC and not twist:
            self.command = self._planar(np.asarray(command, float))
            return self.command
        v, w = command if twist else self._tracking(command, heading)
        if not self.limit("reverse"):
            v = max(v, 0.0)
        follow = self._bicycle if self.dynamics is Dynamics.ACKERMANN else self._wheels
        self.command = np.array(follow(float(v), float(w)))
        return self.command

    def follow(self, executed: FloatArray) -> None:
        """Continue from a stored command (2,), so that rounding does not accumulate."""
        self.command = executed.copy()
        v, w = executed
        if self.dynamics is Dynamics.ACKERMANN and v != 0.0:
            self.steering = math.atan(self.limit("wheelbase") * w / v)

    def _planar(self, wanted: FloatArray) -> FloatArray:
        speed, top = math.hypot(*wanted), self.limit("max_speed")
        wanted = wanted * (min(1.0, top / speed) if speed > 0.0 else 1.0)
        way = wanted - self.command
        length = math.hypot(*way)
        if length == 0.0:
            return wanted
        nearest = -float(self.command @ (way / length)) / length
        share = self._share(length, min(max(nearest, 0.0), 1.0))
        return wanted if share >= 1.0 else self.command + share * way

    def _share(self, length: float, falling: float) -> float:
        """Return the share of a change by ``length`` [m/s] that is made within the step.

        The speed falls during the first share ``falling``, and then rises.
        """
        faster, slower = self.limit("max_acceleration"), self.limit("max_deceleration")
        braking = falling * length / slower  # [s]
        if braking >= self.dt:
            return falling * self.dt / braking
        rising = (1.0 - falling) * length / faster
        if rising <= self.dt - braking:
            return 1.0
        return falling + (1.0 - falling) * (self.dt - braking) / rising

    def _speed(self, wanted: float) -> float:
        """Return the speed that is reached from the last one."""
        now = float(self.command[0])
        change = wanted - now
        if change == 0.0:
            return wanted
        share = self._share(abs(change), min(max(-now / change, 0.0), 1.0))
        return now + share * change

    def _tracking(self, velocity: FloatArray, heading: float) -> tuple[float, float]:
        speed = math.hypot(*velocity)
        if speed == 0.0:
            return 0.0, 0.0
        aim = math.remainder(math.atan2(velocity[1], velocity[0]) - heading, 2.0 * math.pi)
        way, acceleration = 1.0, self.limit("max_turn_acceleration")
        farthest = 0.5 * math.pi if self.limit("reverse") else math.pi
        self.doubtful = abs(abs(aim) - farthest) < _ROUNDING
        if abs(aim) > farthest:
            way, aim = -1.0, aim - math.copysign(math.pi, aim)
        forward = max(speed * math.cos(aim), 0.0)
        if self.dynamics is Dynamics.ACKERMANN:
            forward = max(forward, 0.5 * speed)
            acceleration = self.limit("max_steering_rate") / self.limit("wheelbase")
            acceleration *= min(forward, self.limit("max_speed"))
        rate = abs(aim) / self.dt
        if math.isfinite(acceleration):
            half = 0.5 * self.dt
            root = math.sqrt(half * half + 2.0 * abs(aim) / acceleration)
            rate = min(rate, acceleration * (root - half))
        return way * forward, math.copysign(rate, aim)

    def _wheels(self, v: float, w: float) -> tuple[float, float]:
        v = float(np.clip(v, -self.limit("max_speed"), self.limit("max_speed")))
        w = float(np.clip(w, -self.limit("max_turn_rate"), self.limit("max_turn_rate")))
        half, top = 0.5 * self.limit("track_width"), self.limit("max_wheel_speed")
        fastest = max(abs(v - half * w), abs(v + half * w))
        if fastest > top:
            v, w = v * top / fastest, w * top / fastest
        change = self.limit("max_turn_acceleration") * self.dt
        now_v, now_w = self.command
        new_v, new_w = self._speed(v), float(np.clip(w, now_w - change, now_w + change))
        if max(abs(new_v - half * new_w), abs(new_v + half * new_w)) > top:
            made_v = (new_v - now_v) / (v - now_v) if v != now_v else 0.0
            made_w = (new_w - now_w) / (w - now_w) if w != now_w else 0.0
            if made_v > made_w:
                new_v = math.copysign(top - half * abs(new_w), new_v)
            else:
                new_w = math.copysign((top - abs(new_v)) / half, new_w)
        return new_v, new_w

    def _bicycle(self, v: float, w: float) -> tuple[float, float]:
        base, fastest = self.limit("wheelbase"), self.limit("max_turn_rate")
        steepest, before = self.limit("max_steering_angle"), self.steering
        if v != 0.0:
            wanted = math.atan(base * w / v)
        else:
            wanted = math.copysign(0.5 * math.pi, w) if w else before
        wanted = float(np.clip(wanted, -steepest, steepest))
        top = self.limit("max_speed")
        if wanted:
            top = min(top, fastest * base / math.tan(abs(wanted)))
        v = self._speed(float(np.clip(v, -top, top)))
        change = self.limit("max_steering_rate") * self.dt
        angle = float(np.clip(wanted, before - change, before + change))
        if abs(v) * math.tan(abs(angle)) > fastest * base:
            slowest = math.atan(fastest * base / abs(v))  # the angle that this speed allows
            kept = abs(before) if before * angle > 0.0 else 0.0
            angle = math.copysign(min(abs(angle), max(slowest, kept)), angle)
            top = fastest * base / math.tan(abs(angle)) if angle else math.inf
            v = float(np.clip(v, -top, top))
        self.steering = angle
        return v, v * math.tan(angle) / base
