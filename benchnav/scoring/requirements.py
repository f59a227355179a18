"""The needs of each metric, and why it is not applicable where one of them is unknown."""

from collections.abc import Collection

from benchnav.metrics.measure import is_own
from benchnav.metrics.metric import NOT_APPLICABLE, Metric

NAMES = {
    "goals": "goals",
    "radius": "radius",
    "preferred_speed": "preferred speed",
    "walls": "walls",
    "movers": "moving obstacles",
    "obstacles": "moving obstacles",  # those of the scenario, if there is one
    "horizon": "horizon",
    "area": "measurement area",
    "teams": "teams",
    "roles": "roles",
    "timings": "times of decisions",
    "navigator": "failures of navigator",
    "common_start": "common start",
    "discs": "bodies that are discs",
    "heading": "headings",
    "people": "people",
    "undisturbed": "the same people without the evaluated agents",
}
"""Unknown quantity → its name in the reason."""
CURES = {
    "goals": "goals: columns goal_x and goal_y, the option 'goals' (last), or a scenario",
    "radius": "radius: a column or option 'radius', or a scenario",
    "preferred_speed": "preferred speed: a column preferred_speed, the option"
    " 'preferred-speed', or a scenario",
    "walls": "walls and horizon: a scenario",
    "area": "measurement area: the option 'area', or a scenario with one",
    "teams": "teams: a column team, or a scenario",
    "heading": "headings: a column heading",
    "people": "people: a scenario with people; the ids start where its agents do",
}
"""Unknown quantity → how a user adds it."""

_CONTACTS = ("radius", "discs", "obstacles")  # contacts are found between discs
_PEOPLE = ("people", "radius")
_RUN = ("goals", *_CONTACTS)
_NEEDS: dict[str, tuple[str, ...]] = {
    "success": _RUN,
    "arrival": ("goals",),
    "timeout": ("goals", "horizon"),
    "stuck": ("goals", "horizon", "radius"),
    "failed": ("navigator",),
    "collided": _CONTACTS,
    "collisions_wall": ("walls", *_CONTACTS),
    "collisions_static": ("walls", *_CONTACTS),
    "collisions_dynamic": ("movers", "radius", "discs"),
    "collisions_agent": ("radius", "discs"),
    "contact_time": _CONTACTS,
    "min_clearance": ("radius", "heading", "obstacles"),
    "min_time_to_collision": _CONTACTS,
    "personal_space_intimate": ("radius", "heading"),
    "personal_space_personal": ("radius", "heading"),
    "time_to_goal": ("goals",),
    "path_length": (),
    "geodesic_length": ("goals", "radius"),
    "efficiency": ("goals", "radius"),
    "spl": _RUN,
    "sct": (*_RUN, "preferred_speed"),
    "makespan": ("goals",),
    "turning": ("goals", "radius"),
    "log_dimensionless_jerk": ("goals", "radius"),
    "sparc": ("goals", "radius"),
    "jam": ("radius", "preferred_speed"),
    "density_mean": ("area",),
    "density_peak": ("area",),
    "flow": ("area", "goals"),
    "velocity_fluctuation": ("area",),
    "congestion_level": ("area",),
    "cohesion": ("teams", "radius"),
    "polarisation": ("teams",),
    "splits": ("teams", "radius"),
    "path_keeping": ("roles", "radius"),
    "catch_up_time": ("roles", "radius"),
    "intrusion": ("people",),
    "avoidance": _PEOPLE,
    "personal_space_approach": (*_PEOPLE, "preferred_speed"),
    "collisions_people": ("people", *_CONTACTS),
    "collisions_at_fault": ("people", *_CONTACTS),
    "people_delay": ("undisturbed",),
    "people_detour": ("undisturbed",),
}


def needs(metric: Metric) -> tuple[str, ...]:
    """Return what must be known for a metric of benchnav; of a plugin: all but the walls."""
    if metric.name in _NEEDS and is_own(metric.name):
        return _NEEDS[metric.name]
    if not metric.verifiable:
        return ("timings",)
    return ("common_start", "goals", *_CONTACTS, "heading", "preferred_speed")


def reason(metric: Metric, known: Collection[str]) -> str:
    """Return why a metric is not applicable; "" if everything that it needs is known."""
    missing = [NAMES[need] for need in needs(metric) if need not in known]
    return f"{NOT_APPLICABLE}needs {', '.join(missing)}" if missing else ""


def cures(known: Collection[str]) -> list[str]:
    """Return how to add what is unknown, a line each."""
    return [text for need, text in CURES.items() if need not in known]
