"""Manoeuvres: the segments of a `Vehicle`, each a change of its speed, yaw or path angle over some time.

Every change sets in and ends along the step whose slope is (1 - y^2)^7, so that it has seven continuous derivatives
where manoeuvres and their ramps meet. A manoeuvre of your own is a frozen dataclass that derives from `Manoeuvre`.
"""

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.polynomial import Polynomial

from bench.errors import Array, InputError, require_scalar
from bench.motion._waves import sincos

POWER = 7
BUMP = Polynomial([1.0, 0.0, -1.0]) ** POWER
SCALE = 1.0 / float(BUMP.integ(lbnd=-1.0)(1.0))
# Odd but for the 1/2, so that its terms hardly cancel; 0 at y = -1, 1 at y = 1, and its integral from -1.
STEP = SCALE * BUMP.integ() + 0.5
STEP_INTEGRAL = STEP.integ(lbnd=-1.0)

Derivatives = tuple[Array, Array, Array, Array]  # value and three derivatives in time, each (n,)


def _step(tau: Array, ramp: float) -> tuple[Array, Derivatives]:
    """Return the integral of the step from 0 at tau = 0 to 1 at tau = ramp, and the step with three derivatives."""
    y = np.clip((2 / ramp) * tau - 1.0, -1.0, 1.0)
    below, square = (1.0 - y) * (1.0 + y), y * y
    slope = SCALE * below ** (POWER - 2)
    rate = 2 / ramp
    integral = (0.5 * ramp) * STEP_INTEGRAL(y) + np.maximum(tau - ramp, 0.0)
    return integral, (
        STEP(y),
        rate * slope * below * below,
        (-2 * POWER * rate**2) * slope * below * y,
        (2 * POWER * rate**3) * slope * (2 * (POWER - 1) * square - below),
    )


def _window(tau: Array, duration: float, ramp: float) -> tuple[Array, Derivatives]:
    """Return the integral of a window that opens over the first ramp and closes over the last, and the window."""
    opened, rise = _step(tau, ramp)
    closed, fall = _step(tau - (duration - ramp), ramp)
    one, two, three, four = (up - down for up, down in zip(rise, fall, strict=True))
    return opened - closed, (one, two, three, four)


def _steady(tau: Array, total: float, duration: float, ramp: float) -> Derivatives:
    """Return a change by `total` at a rate that is constant between the ramps."""
    rate = total / (duration - ramp)
    integral, (window, slope, bend, _) = _window(tau, duration, ramp)
    return rate * integral, rate * window, rate * slope, rate * bend


def _check(manoeuvre: "Manoeuvre", *names: str) -> None:
    require_scalar("duration", manoeuvre.duration, positive=True)
    for name in names:
        require_scalar(name, getattr(manoeuvre, name))


def _check_ramp(duration: float, ramp: float) -> None:
    if 2 * require_scalar("ramp", ramp, positive=True) > duration:
        raise InputError(f"ramp must be at most half the duration of {duration!r} s, got {ramp!r}")


class Manoeuvre(ABC):
    """Base of the manoeuvres: one quantity changes, the others stay.

    Attributes
    ----------
    quantity : {"speed", "yaw", "path_angle"}
    duration : float, s
    """

    quantity: ClassVar[str]
    duration: float

    @property
    @abstractmethod
    def total(self) -> float:
        """What the quantity has changed by in the end."""

    @property
    @abstractmethod
    def corners(self) -> tuple[float, ...]:
        """Times within the manoeuvre, s, between which the change is smooth and of few waves."""

    @abstractmethod
    def change(self, tau: Array) -> Derivatives:
        """Return the change of the quantity since the start, tau s ago, with three derivatives, each (n,)."""


@dataclass(frozen=True)
class Straight(Manoeuvre):
    """Straight: speed, heading and path angle stay as they are; at speed 0 the vehicle stands.

    Parameters
    ----------
    duration : float, s
    """

    quantity: ClassVar[str] = "speed"
    total: ClassVar[float] = 0.0
    corners: ClassVar[tuple[float, ...]] = ()

    duration: float

    def __post_init__(self) -> None:
        _check(self)

    def change(self, tau: Array) -> Derivatives:
        """Return zeros."""
        zero = np.zeros(tau.shape)
        return zero, zero, zero, zero


@dataclass(frozen=True)
class Accelerate(Manoeuvre):
    """Accelerate: the speed changes, at constant acceleration between the ramps.

    Parameters
    ----------
    duration : float, s
    speed_change : float, m/s
        Negative to brake.
    ramp : float, s
        Time in which the acceleration sets in, and in which it ends.
    """

    quantity: ClassVar[str] = "speed"

    duration: float
    speed_change: float
    ramp: float = 2.0

    def __post_init__(self) -> None:
        _check(self, "speed_change")
        _check_ramp(self.duration, self.ramp)

    @property
    def total(self) -> float:
        """The change of speed, m/s."""
        return self.speed_change

    @property
    def corners(self) -> tuple[float, ...]:
        """Ends of the ramps."""
        return self.ramp, self.duration - self.ramp

    def change(self, tau: Array) -> Derivatives:
        """Return the change of speed, m/s."""
        return _steady(tau, self.speed_change, self.duration, self.ramp)


@dataclass(frozen=True)
class Turn(Manoeuvre):
    """Turn: the heading changes, at a constant rate between the ramps.

    Parameters
    ----------
    duration : float, s
    heading_change : float, rad
        Clockwise: positive is a turn to the right. More than one turn is a holding pattern.
    ramp : float, s
        Time in which the turn sets in, and in which it ends.
    """

    quantity: ClassVar[str] = "yaw"

    duration: float
    heading_change: float
    ramp: float = 2.0

    def __post_init__(self) -> None:
        _check(self, "heading_change")
        _check_ramp(self.duration, self.ramp)

    @property
    def total(self) -> float:
        """The change of yaw, rad: anticlockwise."""
        return -self.heading_change

    @property
    def corners(self) -> tuple[float, ...]:
        """Ends of the ramps."""
        return self.ramp, self.duration - self.ramp

    def change(self, tau: Array) -> Derivatives:
        """Return the change of yaw, rad."""
        return _steady(tau, -self.heading_change, self.duration, self.ramp)


@dataclass(frozen=True)
class Climb(Manoeuvre):
    """Climb: the path angle goes to a constant value between the ramps, and back.

    Parameters
    ----------
    duration : float, s
    path_angle : float, rad
        Of the velocity above the horizon; negative to descend.
    ramp : float, s
        Time in which the climb sets in, and in which it ends.
    """

    quantity: ClassVar[str] = "path_angle"
    total: ClassVar[float] = 0.0

    duration: float
    path_angle: float
    ramp: float = 2.0

    def __post_init__(self) -> None:
        _check(self, "path_angle")
        _check_ramp(self.duration, self.ramp)
        if abs(self.path_angle) > math.pi / 2:
            raise InputError(f"path_angle must be within +-pi/2 rad, got {self.path_angle!r} (degrees?)")

    @property
    def corners(self) -> tuple[float, ...]:
        """Ends of the ramps."""
        return self.ramp, self.duration - self.ramp

    def change(self, tau: Array) -> Derivatives:
        """Return the path angle, rad."""
        _, (angle, first, second, third) = _window(tau, self.duration, self.ramp)
        return self.path_angle * angle, self.path_angle * first, self.path_angle * second, self.path_angle * third


@dataclass(frozen=True)
class Weave(Manoeuvre):
    """Weave: the heading swings about its value, clockwise first, growing over one ramp and fading over another.

    Parameters
    ----------
    duration : float, s
    amplitude : float, rad
        Of the heading.
    period : float, s
    ramp : float, s
        Time in which the weave sets in, and in which it ends.
    """

    quantity: ClassVar[str] = "yaw"
    total: ClassVar[float] = 0.0

    duration: float
    amplitude: float
    period: float
    ramp: float = 2.0

    def __post_init__(self) -> None:
        _check(self, "amplitude")
        require_scalar("period", self.period, positive=True)
        _check_ramp(self.duration, self.ramp)

    @property
    def corners(self) -> tuple[float, ...]:
        """Ends of the ramps, and every full period."""
        periods = np.arange(1, math.ceil(self.duration / self.period)) * self.period
        return self.ramp, self.duration - self.ramp, *periods.tolist()

    def change(self, tau: Array) -> Derivatives:
        """Return the change of yaw, rad."""
        _, (a, da, dda, ddda) = _window(tau, self.duration, self.ramp)
        w = 2 * math.pi / self.period
        s, c = sincos(w, tau)
        s, ds, dds, ddds = (-self.amplitude * x for x in (s, w * c, -(w**2) * s, -(w**3) * c))
        return (
            a * s,
            da * s + a * ds,
            dda * s + 2 * da * ds + a * dds,
            ddda * s + 3 * dda * ds + 3 * da * dds + a * ddds,
        )
