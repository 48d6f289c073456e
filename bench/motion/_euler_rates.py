"""Euler angles and their derivatives to attitude, body rate and its derivative, in closed form."""

from typing import Protocol

import numpy as np

from bench.errors import Array
from bench.motion._options import Vector, as_vector, set_options
from bench.motion._waves import columns, sincos
from bench.rotation import quat_from_euler

Jet = tuple[Array, Array, Array]  # value, first and second derivative in time, each shape (n,)


class Swinging(Protocol):
    """Options of a motion whose psi, P and R are attitude + swing sin(swing_frequency t + swing_phase)."""

    @property
    def attitude(self) -> Vector: ...
    @property
    def swing(self) -> Vector: ...
    @property
    def swing_frequency(self) -> Vector: ...
    @property
    def swing_phase(self) -> Vector: ...


SWING_OPTIONS = ("attitude", "swing", "swing_frequency", "swing_phase")


def set_vectors(motion: object, *names: str) -> None:
    """Check options of three numbers in a frozen dataclass that is being made, and store them as tuples."""
    set_options(motion, **{name: as_vector(name, getattr(motion, name)) for name in names})


def swing_rates(motion: Swinging, t: Array) -> tuple[Array, Array, Array]:
    """Return q (n, 4), omega_b and alpha_b (n, 3) of the swing at times t."""
    options = (getattr(motion, name) for name in SWING_OPTIONS)
    angles = zip(*options, strict=True)
    return euler_rates(*(harmonic(swing, w, phase, t, mean) for mean, swing, w, phase in angles))


def harmonic(amplitude: float, w: float, phase: float, t: Array, offset: float = 0.0) -> Jet:
    """Return offset + amplitude sin(w t + phase) with its derivatives; right to rounding for any t."""
    sine, cosine = sincos(w, t, phase)
    return offset + amplitude * sine, (amplitude * w) * cosine, (-amplitude * w * w) * sine


def euler_rates(yaw: Jet, pitch: Jet, roll: Jet) -> tuple[Array, Array, Array]:
    """Return q (n, 4), omega_b (n, 3) and alpha_b (n, 3) of C = Rz(psi) Rx(P) Ry(R).

    omega = (cR P' - sR cP psi', R' + sP psi', sR P' + cR cP psi'). Nothing is singular at P = 90 deg: the
    angles are prescribed, not found.
    """
    (psi, dpsi, ddpsi), (P, dP, ddP), (R, dR, ddR) = yaw, pitch, roll
    sP, cP, sR, cR = np.sin(P), np.cos(P), np.sin(R), np.cos(R)
    level = cP * dpsi  # rate of the yaw axis across the roll axis, and its derivative
    dlevel = cP * ddpsi - sP * dP * dpsi
    wx, wz = cR * dP - sR * level, sR * dP + cR * level
    omega = columns(wx, dR + sP * dpsi, wz)
    alpha = columns(
        cR * ddP - sR * dlevel - dR * wz,
        ddR + sP * ddpsi + cP * dP * dpsi,
        sR * ddP + cR * dlevel + dR * wx,
    )
    return quat_from_euler(psi, P, R), omega, alpha
