"""A recording of an inertial measurement unit: rates or increments with times, checked, in right-forward-up and SI.

Readers of file formats (``bench.formats``) make recordings; solvers take their increments. Rates and increments are
different things: rates taken for increments cost a factor of hundreds to thousands in accuracy, so `kind` is always
declared and the way from one to the other is always named.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from bench._timestamps import check_times
from bench.errors import Array, InputError, require_array, require_choice, require_integer, require_scalar
from bench.signals import Increments, Readings

KINDS = ("increments", "rates")


@dataclass(frozen=True, eq=False)
class Recording:
    """What one gyro triad and one accelerometer triad reported, at regular times.

    Attributes
    ----------
    t : ndarray, shape (n,), s
        Increments: end of each interval. Rates: when each was sampled.
    angular : ndarray, shape (n, 3), rad (increments) or rad/s (rates)
        omega_ib_b or its integral, body axes right-forward-up.
    specific : ndarray, shape (n, 3), m/s (increments) or m/s^2 (rates)
        f_b or its integral.
    kind : {"increments", "rates"}
    dt : float, s
        Nominal interval: as declared, otherwise as measured from t (see `check_times`).
    source : str
        Where it is from, for messages and titles.
    epoch_ns : int, ns
        What to add to t for the time of the source: t = 0 is there. Not 0 only where the source counts nanoseconds in
        integers too long for a float.
    jitter : float
        Accepted deviation of an interval from dt, in dt.

    Raises
    ------
    InputError
        If a field has another shape or holds a NaN (which rows), or the times are not regular (what, how often, and
        where first), or do not fit the declared dt.
    """

    t: Array
    angular: Array
    specific: Array
    kind: str
    dt: float
    source: str
    epoch_ns: int
    jitter: float

    def __init__(
        self,
        t: ArrayLike,
        angular: ArrayLike,
        specific: ArrayLike,
        kind: str,
        dt: float | None = None,
        *,
        source: str = "recording",
        epoch_ns: int = 0,
        jitter: float = 0.1,
    ):
        t = require_array("t", t, (None,), finite=False)
        angular = require_array("angular", angular, (len(t), 3), finite=False)
        specific = require_array("specific", specific, (len(t), 3), finite=False)
        require_finite_rows(source, t, angular, specific)
        set_field = object.__setattr__
        set_field(self, "t", t)
        set_field(self, "angular", angular)
        set_field(self, "specific", specific)
        set_field(self, "kind", require_choice("kind", kind, KINDS))
        set_field(self, "dt", check_times(t, dt, source=source, jitter=jitter))
        set_field(self, "source", source)
        set_field(self, "epoch_ns", require_integer("epoch_ns", epoch_ns, minimum=0))
        set_field(self, "jitter", jitter)

    def __len__(self) -> int:
        return len(self.t)

    @classmethod
    def from_increments(cls, increments: Increments, source: str = "simulation") -> "Recording":
        """Return the recording of a simulated gyro and accelerometer triad; bit for bit the same increments."""
        dtheta_b, dvel_b = _triads(increments.dtheta_b, increments.dvel)
        return cls(increments.t, dtheta_b, dvel_b, "increments", increments.dt, source=source)

    @classmethod
    def from_readings(cls, readings: Readings, dt: float | None = None, source: str = "simulation") -> "Recording":
        """Return the recording of simulated rate samples of a gyro and an accelerometer triad."""
        gyro, accelerometers = _triads(readings.gyro, readings.accelerometers)
        return cls(readings.t, gyro, accelerometers, "rates", dt, source=source)

    @property
    def start(self) -> float:
        """When the first interval begins, s: t[0] for rates, t[0] - dt for increments."""
        return float(self.t[0]) - (self.dt if self.kind == "increments" else 0.0)

    def increments(self, rule: str | None = None) -> tuple[Array, Array, float]:
        """Return dtheta_b (n, 3) rad, dvel_b (n, 3) m/s and dt of `as_increments`, as solvers take them."""
        made = self.as_increments(rule)
        return made.angular, made.specific, made.dt

    def as_increments(self, rule: str | None = None) -> "Recording":
        """Return the recording as increments; rates are integrated by the named rule.

        Parameters
        ----------
        rule : {"trapezoid", "simpson", "spline", "average"}, optional
            Needed for rates and refused for increments; nothing is integrated silently. In brackets what each costs on
            5 deg, 2 Hz coning at 100 Hz: the attitude error of a two-sample solver, in that from exact increments.

            - ``trapezoid``: straight line between samples; second order in dt (320).
            - ``simpson``: parabola through three samples, intervals of 2 dt; fourth order (16). A last sample that is
              left over is not used.
            - ``spline``: cubic spline through all samples; fourth order at intervals of dt (1.1); looks ahead.
            - ``average``: each sample is the mean over the interval that ends at its time, as of a sensor that
              integrates inside and divides by dt. Exact for such a sensor; first order for others (2800).

        Raises
        ------
        InputError
            If a rule is missing or out of place, or there are too few samples for it.
        """
        if self.kind == "increments":
            if rule is not None:
                raise InputError(f"rule must not be given for {self.source}: it holds increments, got {rule!r}")
            return self
        if rule is None:
            raise InputError(
                f"rule must say how to integrate the rates of {self.source}: {', '.join(_RULES)} "
                "(average only if the sensor reports means over its intervals)"
            )
        integrate = _RULES[require_choice("rule", rule, _RULES)]
        t, values, dt = integrate(self.t, np.concatenate([self.angular, self.specific], axis=1), self.dt)
        return self._with(t, values, "increments", dt)

    def as_mean_rates(self) -> "Recording":
        """Return increments as mean rates over each interval; `as_increments("average")` is the way back.

        Raises
        ------
        InputError
            If the recording holds rates already.
        """
        if self.kind != "increments":
            raise InputError(f"kind must be 'increments' for mean rates, {self.source} holds rates")
        return self._with(self.t, np.concatenate([self.angular, self.specific], axis=1) / self.dt, "rates", self.dt)

    def between(self, start: float, stop: float) -> "Recording":
        """Return the part whose times t are in [start, stop], s.

        Raises
        ------
        InputError
            If less than two samples are there.
        """
        inside = (self.t >= require_scalar("start", start)) & (self.t <= require_scalar("stop", stop))
        if np.count_nonzero(inside) < 2:
            raise InputError(
                f"start and stop must enclose two samples of {self.source} (t from {self.t[0]} to {self.t[-1]} s), "
                f"got {start!r} and {stop!r}"
            )
        values = np.concatenate([self.angular[inside], self.specific[inside]], axis=1)
        return self._with(self.t[inside], values, self.kind, self.dt)

    def _with(self, t: Array, values: Array, kind: str, dt: float) -> "Recording":
        return Recording(
            t, values[:, :3], values[:, 3:], kind, dt, source=self.source, epoch_ns=self.epoch_ns, jitter=self.jitter
        )


def require_finite_rows(source: str, *arrays: Array, where: Callable[[int], str] = "row {}".format) -> None:
    """Check that no row of the arrays, shapes (n,) or (n, k), holds a NaN or an infinity.

    Raises
    ------
    InputError
        Otherwise; it says how many rows do and where the first ones are.
    """
    if all(np.isfinite(array).all() for array in arrays):
        return
    bad = np.any([~np.isfinite(array.reshape(len(array), -1)).all(axis=1) for array in arrays], axis=0)
    rows = np.flatnonzero(bad)
    named = ", ".join(where(int(k)) for k in rows[:5]) + (", ..." if len(rows) > 5 else "")
    raise InputError(
        f"{source}: {len(rows)} of {len(bad)} rows hold NaN or infinity ({named}); "
        "remove them, or choose a stretch without them (start, stop)"
    )


def _triads(angular: Array | None, specific: Array) -> tuple[Array, Array]:
    if angular is None or specific.shape[1] != 3:
        gyro = "no gyro" if angular is None else "a gyro"
        raise InputError(
            f"a recording needs a gyro and one accelerometer triad, got {gyro} and {specific.shape[1]} channels"
        )
    return angular, specific


Integrated = tuple[Array, Array, float]  # ends of the intervals, integrals over them, dt


def _trapezoid(t: Array, values: Array, dt: float) -> Integrated:
    _require_samples(t, 3, "trapezoid")
    return t[1:], (values[1:] + values[:-1]) * (0.5 * dt), dt


def _simpson(t: Array, values: Array, dt: float) -> Integrated:
    _require_samples(t, 5, "simpson")
    last = len(t) - (len(t) + 1) % 2
    integrals = values[0 : last - 2 : 2] + 4 * values[1 : last - 1 : 2] + values[2:last:2]
    return t[2:last:2], integrals * (dt / 3), 2 * dt


def _spline(t: Array, values: Array, dt: float) -> Integrated:
    from scipy.interpolate import CubicSpline

    _require_samples(t, 4, "spline")
    # On the nominal grid, as the other rules: jitter of the stamps is not jitter of the samples.
    c = CubicSpline(np.arange(len(t)), values).c
    return t[1:], (c[3] + c[2] / 2 + c[1] / 3 + c[0] / 4) * dt, dt


def _average(t: Array, values: Array, dt: float) -> Integrated:
    return t, values * dt, dt


def _require_samples(t: Array, least: int, rule: str) -> None:
    if len(t) < least:
        raise InputError(f"rule {rule!r} needs at least {least} samples, got {len(t)}")


_RULES = {"trapezoid": _trapezoid, "simpson": _simpson, "spline": _spline, "average": _average}
