"""The key `noise`: presets, defaults that stay, hashes, and errors for people."""

import math
from dataclasses import asdict

import pytest

from benchnav.errors import ScenarioError
from benchnav.generation.build import noise_of
from benchnav.scenario.load import scenario_from_text
from tests.scenario.files import SMALL

DEFAULTS = {  # not part of the hash of a scenario: a change of them needs a new name
    "rays": {
        "noise": 0.005, "relative_noise": 0.01, "quadratic_noise": 0.0, "dropout": 0.05,
        "approach_noise": 0.1, "field_of_view": 2 * math.pi,
    },
    "neighbours": {
        "position_noise": 0.1, "velocity_noise": 0.15, "missed": 0.1, "false_alarms": 0.05,
        "field_of_view": 2 * math.pi,
    },
    "edges": {"offset_noise": 0.01, "missed": 0.02, "field_of_view": 2 * math.pi},
    "odometry": {
        "distance_noise": 0.03, "heading_noise": 0.02, "turning_noise": 0.02,
        "correction_period": 5.0, "correction_position_noise": 0.05,
        "correction_heading_noise": 0.02,
    },
    "delay": 1,
}  # fmt: skip


def with_noise(text):
    return scenario_from_text(SMALL + f"noise:\n{text}", "s.yaml")


def test_the_defaults_stay_what_they_are():
    assert asdict(noise_of(scenario_from_text(SMALL, "s.yaml"))) == DEFAULTS


def test_only_another_noise_changes_the_hash():
    plain = scenario_from_text(SMALL, "s.yaml").hash
    assert with_noise("  delay: 1\n").hash == plain
    assert with_noise("  rays: {sensor: lidar, dropout: 0.05}\n").hash == plain
    assert with_noise("  delay: 2\n").hash != plain
    assert with_noise("  rays: {sensor: depth-camera}\n").hash != plain


def test_a_preset_gives_what_is_left_out():
    noise = noise_of(with_noise("  rays: {sensor: depth-camera, dropout: 0.2}\n"))
    assert noise.rays.dropout == 0.2
    assert noise.rays.quadratic_noise == 0.0036
    assert noise.rays.field_of_view == pytest.approx(math.radians(87))
    assert noise.neighbours == noise_of(scenario_from_text(SMALL, "s.yaml")).neighbours
    lost = noise_of(with_noise("  odometry: {sensor: dead-reckoning}\n")).odometry
    assert lost.correction_period is None
    assert lost.heading_noise == 0.02


def test_an_exact_sensor_has_no_errors():
    exact = "".join(
        f"  {sensor}: {{sensor: exact}}\n" for sensor in ("rays", "neighbours", "edges", "odometry")
    )
    noise = noise_of(with_noise(exact + "  delay: 0\n"))
    parts = [part for part in asdict(noise).values() if isinstance(part, dict)]
    numbers = [
        value for part in parts for key, value in part.items()
        if not key.startswith(("field", "correction"))
    ]  # fmt: skip
    assert set(numbers) == {0.0}
    assert noise.odometry.correction_period is None


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            "  rays: {noise: -0.1}",
            "s.yaml:30: noise.rays.noise must be ≥ 0; got -0.1.",
        ),
        (
            "  neighbours: {missed: 1.5}",
            "s.yaml:30: noise.neighbours.missed must be ≤ 1; got 1.5.",
        ),
        (
            "  rays: {field_of_view: 0}",
            "s.yaml:30: noise.rays.field_of_view must be > 0; got 0.",
        ),
        (
            "  rays: {sensor: lidr}",
            "s.yaml:30: noise.rays.sensor must be 'exact', 'lidar' or 'depth-camera';"
            " got 'lidr'. Did you mean 'lidar'?",
        ),
        (
            "  delay: 250",
            "s.yaml:30: noise.delay must be shorter than the horizon, which is 250 decisions;"
            " got 250.",
        ),
        (
            "  delay: 0.5",
            "s.yaml:30: noise.delay must be a whole number; got 0.5.",
        ),
        (
            "  odometry: {correction_period: 0}",
            "s.yaml:30: noise.odometry.correction_period must be > 0; got 0.",
        ),
        (
            "  neighbours: {false_alarm: 0.1}",
            "s.yaml:30: noise.neighbours.false_alarm is not a known key."
            " Did you mean 'false_alarms'?",
        ),
    ],
)  # fmt: skip
def test_errors_name_file_line_key_and_cure(text, message):
    with pytest.raises(ScenarioError) as raised:
        with_noise(text + "\n")
    assert str(raised.value) == message
