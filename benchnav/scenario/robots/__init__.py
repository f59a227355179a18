"""Robots: named bodies with published limits, which a team takes by ``robot: NAME``."""
