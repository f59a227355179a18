"""What all tests share."""

from hypothesis import HealthCheck, settings

# the first example of a test may compile a kernel
settings.register_profile(
    "benchnav", deadline=None, suppress_health_check=[HealthCheck.too_slow], print_blob=True
)
settings.load_profile("benchnav")
