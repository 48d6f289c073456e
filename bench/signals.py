"""The frozen records that cross module borders: kinematics, readings, increments, solutions.

Arrays are (n, k), time first, float64, C-contiguous, SI. Every record checks
itself when it is made, so what travels through the bench is finite and of one length.
"""

from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import ArrayLike

from bench.errors import Array, InputError, require_array, require_scalar, require_unit_quaternion


def _rows(name: str, value: ArrayLike, width: int) -> Array:
    """Check one (n, width) field; a single row stands for itself."""
    array = np.asarray(value)
    return require_array(name, array[np.newaxis] if array.ndim == 1 else array, (None, width))


def _channels(name: str, value: ArrayLike, n: int) -> Array:
    """Check one (n, m) field; a rig without accelerometers has m = 0."""
    width = np.shape(value)[1] if np.ndim(value) == 2 else None
    return require_array(name, value, (n, width))


@dataclass(frozen=True, eq=False)
class Kinematics:
    """True motion of the body frame b in the inertial frame i at n times.

    A field that does not change may be given as a single row; it is repeated.

    Attributes
    ----------
    position, velocity, acceleration : ndarray, shape (n, 3), m, m/s, m/s^2
        Of the body origin, in i.
    q_ib : ndarray, shape (n, 4)
        Attitude, b to i, wxyz, unit within 1e-9.
    omega_ib_b, alpha_ib_b : ndarray, shape (n, 3), rad/s, rad/s^2
        Angular rate and its time derivative, in b.
    gravity : ndarray, shape (n, 3), m/s^2
        Gravitational acceleration at the body origin, in i. Not optional: specific force is f = C_bi (a - g).

    Raises
    ------
    InputError
        If a field has another shape, is not finite, or a quaternion is not unit.
    """

    position: Array
    velocity: Array
    acceleration: Array
    q_ib: Array
    omega_ib_b: Array
    alpha_ib_b: Array
    gravity: Array

    def __post_init__(self) -> None:
        checked = {f.name: _rows(f.name, getattr(self, f.name), 4 if f.name == "q_ib" else 3) for f in fields(self)}
        require_unit_quaternion("q_ib", checked["q_ib"], (None, 4))
        n = max(len(array) for array in checked.values())
        for name, array in checked.items():
            if len(array) not in (1, n):
                raise InputError(f"{name} must have 1 or {n} rows like the other fields, got {len(array)}")
            full = array if len(array) == n else np.repeat(array, n, axis=0)
            object.__setattr__(self, name, full)

    def __len__(self) -> int:
        return len(self.position)

    def repeated(self, n: int) -> "Kinematics":
        """Return n rows like the only one.

        Raises
        ------
        InputError
            If there are several rows, and not n.
        """
        if len(self) == n:
            return self
        if len(self) != 1:
            raise InputError(f"kinematics must have 1 or {n} rows, got {len(self)}")
        return Kinematics(**{f.name: np.repeat(getattr(self, f.name), n, axis=0) for f in fields(self)})


@dataclass(frozen=True, eq=False)
class Accelerometers:
    """Geometry of the accelerometer channels of a rig, in the body frame.

    Attributes
    ----------
    names : tuple of str
        One per channel.
    position : ndarray, shape (m, 3), m
    direction : ndarray, shape (m, 3), unit
        Sensing axis of each channel.
    """

    names: tuple[str, ...]
    position: Array
    direction: Array

    def __post_init__(self) -> None:
        names = tuple(self.names)
        position = require_array("position", self.position, (len(names), 3))
        direction = require_array("direction", self.direction, (len(names), 3))
        norm = np.linalg.norm(direction, axis=1)
        if (np.abs(norm - 1) > 1e-9).any():
            k = int(np.argmax(np.abs(norm - 1)))
            raise InputError(f"direction must hold unit vectors, got norm {float(norm[k])!r} for {names[k]!r}")
        for name, value in (("names", names), ("position", position), ("direction", direction)):
            object.__setattr__(self, name, value)

    def __len__(self) -> int:
        return len(self.names)


@dataclass(frozen=True, eq=False)
class Readings:
    """Instantaneous sensor readings (rate samples, not increments).

    Attributes
    ----------
    t : ndarray, shape (n,), s
    accelerometers : ndarray, shape (n, m), m/s^2
        Specific force along each channel's sensing axis.
    gyro : ndarray, shape (n, 3), rad/s, or None
        omega_ib_b, resolved in body axes; None for a rig without a gyro.
    """

    t: Array
    accelerometers: Array
    gyro: Array | None = None

    def __post_init__(self) -> None:
        t = require_array("t", self.t, (None,))
        object.__setattr__(self, "t", t)
        object.__setattr__(self, "accelerometers", _channels("accelerometers", self.accelerometers, len(t)))
        if self.gyro is not None:
            object.__setattr__(self, "gyro", require_array("gyro", self.gyro, (len(t), 3)))

    def __len__(self) -> int:
        return len(self.t)


@dataclass(frozen=True, eq=False)
class Increments:
    """Integrals of the readings over n equal, adjoining intervals.

    Attributes
    ----------
    dt : float, s
        Length of one interval.
    t : ndarray, shape (n,), s
        End of each interval.
    dvel : ndarray, shape (n, m), m/s
        Integral of the specific force along each channel's sensing axis.
    dtheta_b : ndarray, shape (n, 3), rad, or None
        Integral of omega_ib_b; None for a rig without a gyro.
    residual : float, rad and m/s
        Largest difference between two node counts of the quadrature over the checked intervals, gyro channels
        in rad and accelerometer channels in m/s: for smooth readings an upper estimate of the quadrature error.
    nodes : int
        Gauss-Legendre nodes used in every interval.
    """

    dt: float
    t: Array
    dvel: Array
    dtheta_b: Array | None
    residual: float
    nodes: int

    def __post_init__(self) -> None:
        require_scalar("dt", self.dt, positive=True)
        t = require_array("t", self.t, (None,))
        object.__setattr__(self, "t", t)
        object.__setattr__(self, "dvel", _channels("dvel", self.dvel, len(t)))
        if self.dtheta_b is not None:
            object.__setattr__(self, "dtheta_b", require_array("dtheta_b", self.dtheta_b, (len(t), 3)))

    def __len__(self) -> int:
        return len(self.t)


@dataclass(frozen=True, eq=False)
class Initial:
    """What a gyro-free solver must be told before the first reading; the defaults are rest at the origin.

    Attributes
    ----------
    q_ib : ndarray, shape (4,)
        Attitude, b to i, wxyz, unit.
    omega_ib_b : ndarray, shape (3,), rad/s
        Needed because an accelerometer array sees omega only through its squares and its derivative.
    velocity, position : ndarray, shape (3,), m/s, m
        In i.
    gravity : ndarray, shape (3,), m/s^2
        Gravitational acceleration that the solver adds to the specific force, in i, constant.
    """

    q_ib: Array
    omega_ib_b: Array
    velocity: Array
    position: Array
    gravity: Array

    def __init__(
        self,
        q_ib: ArrayLike = (1.0, 0.0, 0.0, 0.0),
        omega_ib_b: ArrayLike = (0.0, 0.0, 0.0),
        velocity: ArrayLike = (0.0, 0.0, 0.0),
        position: ArrayLike = (0.0, 0.0, 0.0),
        *,
        gravity: ArrayLike,
    ):
        set_field = object.__setattr__
        set_field(self, "q_ib", require_unit_quaternion("q_ib", q_ib))
        set_field(self, "omega_ib_b", require_array("omega_ib_b", omega_ib_b, (3,)))
        set_field(self, "velocity", require_array("velocity", velocity, (3,)))
        set_field(self, "position", require_array("position", position, (3,)))
        set_field(self, "gravity", require_array("gravity", gravity, (3,)))

    @classmethod
    def of(cls, truth: Kinematics, row: int = 0) -> "Initial":
        """Return the initial state that agrees with one row of the true kinematics."""
        return cls(
            truth.q_ib[row],
            truth.omega_ib_b[row],
            truth.velocity[row],
            truth.position[row],
            gravity=truth.gravity[row],
        )


@dataclass(frozen=True, eq=False)
class GyroFreeSolution:
    """What a gyro-free solver found, one row per reading.

    Attributes
    ----------
    omega_ib_b : ndarray, shape (n, 3), rad/s
    alpha_ib_b : ndarray, shape (n, 3), rad/s^2
    f_b : ndarray, shape (n, 3), m/s^2
        Specific force at the body origin.
    q_ib : ndarray, shape (n, 4)
    velocity, position : ndarray, shape (n, 3), m/s, m
        In i.
    negative_squares : int
        How many squared rates came out negative (and were taken as zero).
    """

    omega_ib_b: Array
    alpha_ib_b: Array
    f_b: Array
    q_ib: Array
    velocity: Array
    position: Array
    negative_squares: int = 0

    def __len__(self) -> int:
        return len(self.q_ib)
