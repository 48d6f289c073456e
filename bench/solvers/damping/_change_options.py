"""Options of the measurement of filter 2, shared by the filter alone and by the fusion."""

from bench.errors import InputError, require_choice, require_scalar

R2_READINGS = ("acceleration", "velocity")
LONGEST = 15.0  # s: beyond, the errors are no longer constant over the interval, as the paper supposes


def check_change(interval: float, change_noise: float, r2_reading: str) -> None:
    """Check the options; InputError names the one that breaks its rule."""
    if not 1.0 <= require_scalar("interval", interval) <= LONGEST:
        raise InputError(f"interval must be from 1 to {LONGEST:g} s, got {interval!r}")
    require_scalar("change_noise", change_noise, positive=True)
    require_choice("r2_reading", r2_reading, R2_READINGS)


def steps_of(interval: float, dt: float) -> int:
    """Return the number of samples in an interval.

    Raises
    ------
    InputError
        If it is not a whole number.
    """
    steps = round(interval / dt)
    if steps < 1 or abs(steps * dt - interval) > 1e-6 * interval:
        raise InputError(f"interval must be a whole number of samples of {dt:g} s, got {interval!r}")
    return steps


def change_variance(interval: float, change_noise: float, r2_reading: str) -> float:
    """Return the variance of Z2, an acceleration, (m/s^2)^2."""
    scale = 1.0 if r2_reading == "acceleration" else 2.0 / interval**2
    return scale * change_noise**2
