"""Prescribed motions with exact derivatives: one file per kind, found by discovery.

A motion of your own is one class with one method::

    class MyMotion(bench.Motion):
        def kinematics(self, t):
            return bench.Kinematics(position=..., ..., gravity=(0, 0, -9.80665))
"""

from abc import ABC, abstractmethod
from typing import ClassVar

import numpy as np

from bench.errors import Array
from bench.registry import discover
from bench.signals import Initial, Kinematics
from bench.units import STANDARD_GRAVITY

STANDARD = (0.0, 0.0, -STANDARD_GRAVITY)  # m/s^2, in i: z up


class Motion(ABC):
    """A prescribed motion of the body frame in the inertial frame.

    `kinematics` must be a pure function of time: the rig evaluates it at any times, in any order, in blocks.
    """

    name: ClassVar[str]

    @abstractmethod
    def kinematics(self, t: Array) -> Kinematics:
        """Return the true kinematics at times t, shape (n,), s."""

    def initial(self, t0: float = 0.0) -> Initial:
        """Return the true state at t0, as solvers are told it."""
        return Initial.of(self.kinematics(np.array([float(t0)])))


def motions() -> dict[str, type[Motion]]:
    """Return the motion classes that come with the package, by name."""
    return discover("bench.motion", Motion)
