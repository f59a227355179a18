"""Wrong bodies, limits, robots and noise, as a user meets them: `benchnav validate FILE`.

Each mistake draws one sentence: file, line and key, what it must be, what it is, and the cure.
"""

import re

import pytest

from benchnav.cli.main import status
from benchnav.scenario.load import scenario_from_text
from benchnav.scenario.sampling.sampler import support
from tests.plain_scenario import PLAIN

BODY = "radius: 0.2\n    max_speed: 1"
AT = "f.yaml:7: teams[0]."
CAR = "dynamics: {type: ackermann, wheelbase: 0.3, max_steering_angle: 0.5}"
WHEELS = "dynamics: {type: differential-drive, track_width: 0.3, max_wheel_speed: 1}"
CAPSULE = "footprint: {type: capsule, length: 1, width: 0.5}"
BOX = "footprint: {type: rounded-box, length: 1, width: 0.5, corner_radius: 0.1}"


@pytest.fixture
def said(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)

    def validate(text):
        (tmp_path / "f.yaml").write_text(text)
        assert status(["validate", "--no-draw", "f.yaml"]) == 2
        out, err = capsys.readouterr()
        assert out == ""
        (line,) = err.removeprefix("benchnav: ").splitlines()
        assert re.match(r"f\.yaml:\d+: \S+ (must|is not)", line), line
        return line

    return validate


def test_right_ones_may_be_drawn():
    key = CAR.replace("wheelbase: 0.3", "wheelbase: {uniform: [0.3, 0.4]}")
    body = CAPSULE.replace("length: 1", "length: {choice: [0.8, 1]}")
    (team,) = scenario_from_text(
        PLAIN.replace(BODY, f"{body}\n    max_speed: 1\n    {key}"), "f"
    ).teams
    assert (support(team.dynamics.wheelbase), team.outer_radius) == ((0.3, 0.4), (0.4, 0.5))


@pytest.mark.parametrize(
    ("key", "message"),
    [
        ("max_acceleration: 0", "max_acceleration must be > 0; got 0."),
        ("max_acceleration: -1", "max_acceleration must be > 0; got -1."),
        ("max_acceleration: fast", "max_acceleration must be a number; got 'fast'."),
        ("max_acceleration: true", "max_acceleration must be a number; got true."),
        ("max_acceleration: {uniform: [0, 1]}", "max_acceleration must be > 0; got a range from 0"
         " to 1."),
        ("max_deceleration: 0", "max_deceleration must be > 0; got 0."),
        ("max_turn_acceleration: -2", "max_turn_acceleration must be > 0; got -2."),
        ("max_accelleration: 1", "max_accelleration is not a known key. Did you mean"
         " 'max_acceleration' or 'max_deceleration'?"),
        ("dynamics: akerman", "dynamics must have one of the types 'holonomic', 'unicycle',"
         " 'differential-drive', 'ackermann'; got 'akerman'. Did you mean 'ackermann'?"),
        ("dynamics: 3", "dynamics must be the name of a type, or a mapping with `type`; got 3."),
        (CAR.replace("0.3", "0"), "dynamics.wheelbase must be > 0; got 0."),
        (CAR.replace("wheelbase: 0.3, ", ""), "dynamics.wheelbase must be given."),
        (CAR.replace("0.5", "30"), "dynamics.max_steering_angle must be > 0 and < 1.571 rad, a"
         " right angle; got 30."),
        (CAR.replace("0.5", "0.5, max_steering_rate: 0"), "dynamics.max_steering_rate must be > 0;"
         " got 0."),
        (CAR.replace("0.5", "0.5, reverse: 1"), "dynamics.reverse must be true or false; got 1."),
        (WHEELS.replace("0.3", "0"), "dynamics.track_width must be > 0; got 0."),
        (WHEELS.replace("speed: 1", "speed: fast"), "dynamics.max_wheel_speed must be a number; got"
         " 'fast'."),
        (WHEELS.replace("track_width", "wheelbase: 0.3, track_width"), "dynamics.wheelbase is not a"
         " known key. Known keys: max_wheel_speed, reverse, track_width, type."),
        ("dynamics: {type: holonomic, reverse: true}", "dynamics.reverse is not a known key. Known"
         " keys: type."),
    ],
)  # fmt: skip
def test_motion(said, key, message):
    assert said(PLAIN.replace(BODY, f"{BODY}\n    {key}")) == AT + message


@pytest.mark.parametrize(
    ("body", "message"),
    [
        (CAPSULE.replace("capsule", "elipse"), "footprint must have one of the types 'disc',"
         " 'capsule', 'rounded-box'; got 'elipse'."),
        (CAPSULE.replace("type: capsule, ", ""), "footprint must have the key `type`; got a mapping"
         " (length, width)."),
        ("footprint: capsule", "footprint must be a mapping such as {type: capsule, length: 0.8,"
         " width: 0.4}; got capsule."),
        (CAPSULE.replace("1", "0.3"), "footprint.length must be ≥ width (0.5); got 0.3. Use `type:"
         " rounded-box` for a body that is wider than long."),
        (CAPSULE.replace("0.5", "0"), "footprint.width must be > 0; got 0."),
        (CAPSULE.replace(", width: 0.5", ""), "footprint.width must be given."),
        (CAPSULE.replace("0.5", "0.5, radius: 1"), "footprint.radius is not a known key. Known"
         " keys: length, type, width."),
        (BOX.replace("0.1", "0.3"), "footprint.corner_radius must be ≤ half of width (0.25); got"
         " 0.3."),
        (BOX.replace(", corner_radius: 0.1", ""), "footprint.corner_radius must be given."),
    ],
)  # fmt: skip
def test_footprints(said, body, message):
    text = PLAIN.replace(BODY, f"{body}\n    max_speed: 1")
    assert said(text) == f"f.yaml:5: teams[0].{message}"


def test_a_body_is_given_once(said):
    both = PLAIN.replace(BODY, f"{BODY}\n    {CAPSULE}")
    assert said(both) == (
        "f.yaml:5: teams[0].radius must be left out, because it follows from `footprint`; remove"
        " one."
    )
    assert said(PLAIN.replace(BODY, "max_speed: 1")) == (
        "f.yaml:4: teams[0].radius must be given, or `footprint` for other shapes, or `robot`."
    )


def test_a_footprint_larger_than_its_start_region(said):
    start = "{type: points, points: [[-4, 0]]}"
    region = "{type: region, region: {type: rectangle, bounds: [-5, -1, -4, 1]}}"
    text = PLAIN.replace(BODY, f"{CAPSULE.replace('1', '3')}\n    max_speed: 1")
    assert said(text.replace(start, region)) == (
        "f.yaml:7: teams[0].start must have room for all of 'one', up to 1 agent; no circle of"
        " radius 1.5 m fits into the region and the bounds. Enlarge the region, or shrink the"
        " footprint."
    )


@pytest.mark.parametrize(
    ("noise", "message"),
    [
        ("{rays: {noise: -0.1}}", "rays.noise must be ≥ 0; got -0.1."),
        ("{rays: {dropout: 1.5}}", "rays.dropout must be ≤ 1; got 1.5."),
        ("{rays: {noise: low}}", "rays.noise must be a number; got 'low'."),
        ("{rays: {sensor: lidr}}", "rays.sensor must be 'exact', 'lidar' or 'depth-camera'; got"
         " 'lidr'. Did you mean 'lidar'?"),
        ("{ray: {noise: 0.1}}", "ray is not a known key. Did you mean 'rays'?"),
        ("{neighbours: {field_of_view: 360}}", "neighbours.field_of_view must be ≤ 6.28319; got"
         " 360."),
        ("{odometry: {correction_period: 0}}", "odometry.correction_period must be > 0; got 0."),
        ("{delay: 500}", "delay must be shorter than the horizon, which is 250 decisions; got"
         " 500."),
        ("{delay: -1}", "delay must be ≥ 0; got -1."),
        ("{delay: 0.5}", "delay must be a whole number; got 0.5."),
        ("lidar", " must be a mapping; got 'lidar'."),
    ],
)  # fmt: skip
def test_noise(said, noise, message):
    assert said(f"{PLAIN}noise: {noise}\n") == f"f.yaml:9: noise.{message}".replace(". m", " m", 1)


@pytest.mark.parametrize(
    ("robot", "message"),
    [
        ("turtelbot4", "f.yaml:5: teams[0].robot must be the name of a robot, or a file that ends"
         " in .yaml; got 'turtelbot4'. Did you mean 'turtlebot4'? 'benchnav list robots' shows all"
         " robots."),
        ("cart.yaml", "f.yaml:5: teams[0].robot must name a robot's file, relative to the"
         " scenario's own; cart.yaml is not a file."),
        ("4", "f.yaml:5: teams[0].robot must be the name of a robot, or a mapping with its `type`;"
         " got 4."),
        ("{type: jackal, speed: 3}", "f.yaml:5: teams[0].robot.speed is not a known key. Known"
         " keys: acceleration_limits, type."),
        ("jackal\n    preferred_speed: 3", "f.yaml:6: teams[0].preferred_speed must be ≤ max_speed"
         " (2); got 3."),
        ("jackal\n    radius: 0.3\n    " + CAPSULE, "f.yaml:6: teams[0].radius must be left out,"
         " because it follows from `footprint`; remove one."),
    ],
)  # fmt: skip
def test_robots(said, robot, message):
    assert said(PLAIN.replace(BODY, f"robot: {robot}")) == message
