"""What a damping filter sees of the free-running INS: its own solution, sampled at equal steps."""

from dataclasses import dataclass, fields
from functools import cache
from typing import Optional

import numpy as np

from bench.earth import Earth
from bench.errors import Array, InputError, require_array, require_instance, require_times, require_unit_quaternion
from bench.rotation import cross, quat_conjugate, quat_multiply, rotvec_from_quat, wrap
from bench.trajectory import Trajectory

STEP_TOLERANCE = 1e-6  # s


@dataclass(frozen=True, eq=False)
class InsSamples:
    """A free INS of held height at m equally spaced times, usually 1 s apart.

    Attributes
    ----------
    earth : Earth
    t : ndarray, shape (m,), s
    v_n : ndarray, shape (m, 3), m/s
        East, north, up; the filters take up to be zero.
    latitude, longitude : ndarray, shape (m,), rad
    height : ndarray, shape (m,), m
    q_nb : ndarray, shape (m, 4)
    f_n : ndarray, shape (m, 3), m/s^2
        Mean specific force in n over the interval that ends at each row.

    Raises
    ------
    InputError
        If a field has another shape or is not finite, or the times are not equally spaced.
    """

    earth: Earth
    t: Array
    v_n: Array
    latitude: Array
    longitude: Array
    height: Array
    q_nb: Array
    f_n: Array

    def __post_init__(self) -> None:
        require_instance("earth", self.earth, Earth)
        t = require_times("t", self.t)
        _require_equal_steps(t)
        rows: dict[str, tuple[int, ...]] = {"v_n": (3,), "latitude": (), "longitude": (), "height": (), "f_n": (3,)}
        checked = {name: require_array(name, getattr(self, name), (len(t), *shape)) for name, shape in rows.items()}
        for name, value in {**checked, "t": t, "q_nb": require_unit_quaternion("q_nb", self.q_nb, (len(t), 4))}.items():
            object.__setattr__(self, name, value)

    def __len__(self) -> int:
        return len(self.t)

    def __getitem__(self, rows: slice) -> "InsSamples":
        """Return some of the rows, such as ``ins[:100]``."""
        return InsSamples(self.earth, *(getattr(self, field.name)[rows] for field in fields(self)[1:]))

    @classmethod
    def of(cls, trajectory: Trajectory, previous: Optional["InsSamples"] = None) -> "InsSamples":
        """Return the samples of a navigation solution at equally spaced times.

        The horizontal specific force follows from the INS's own velocity: with no upward velocity
        mean f_EN = (v(t2) - v(t1))/T + mean of the Coriolis terms - gravity's level part, the mean taken over both
        ends; the upward one is what carries the weight.

        Parameters
        ----------
        trajectory : Trajectory
            A row about every second; `bench.interpolation.sampled` thins a denser one.
        previous : InsSamples, optional
            The chunk before. Without one the first row, whose interval no filter uses, has the specific force of a
            constant velocity.

        Raises
        ------
        InputError
            If an argument is of another class, or the times are not equally spaced or do not follow those of
            `previous`.
        """
        require_instance("trajectory", trajectory, Trajectory)
        if previous is not None:
            require_instance("previous", previous, InsSamples)
        earth, t = trajectory.earth, trajectory.t
        v, L, times = trajectory.v_n, trajectory.latitude, t
        if previous is not None:
            v, L = np.concatenate([previous.v_n[-1:], v]), np.concatenate([previous.latitude[-1:], L])
            times = np.concatenate([previous.t[-1:], t])
            _require_equal_steps(np.concatenate([previous.t[-2:], t]))
        turn = _coriolis(earth, v, L)
        mean = 0.5 * (turn[:-1] + turn[1:])
        mean[:, :2] += (np.diff(v, axis=0) / np.diff(times)[:, None])[:, :2]
        if previous is None:
            mean = np.concatenate([turn[:1], mean])
        f_n = mean - earth.gravity_n(trajectory.latitude, trajectory.height)
        return cls(
            earth, t, trajectory.v_n, trajectory.latitude, trajectory.longitude, trajectory.height, trajectory.q_nb, f_n
        )

    @classmethod
    def joined(cls, *parts: "InsSamples") -> "InsSamples":
        """Return the rows of samples that follow each other.

        Raises
        ------
        InputError
            If there are none, one is none, their Earths differ, or the times are not equally spaced.
        """
        for k, part in enumerate(parts):
            require_instance(f"parts[{k}]", part, InsSamples)
        if not parts or any(part.earth != parts[0].earth for part in parts):
            raise InputError(f"parts must be samples of one Earth, got {len(parts)}")
        names = [field.name for field in fields(cls)[1:]]
        return cls(parts[0].earth, *(np.concatenate([getattr(part, name) for part in parts]) for name in names))

    def trajectory(self) -> Trajectory:
        """Return the same rows as a trajectory."""
        return Trajectory.from_geodetic(
            self.earth, self.t, self.q_nb, self.v_n, self.latitude, self.longitude, self.height
        )


def error_states(ins: InsSamples | Trajectory, truth: Trajectory) -> Array:
    """Return the true navigation errors of an INS in the filters' definition, shape (m, 7).

    dv_E, dv_N (m/s), dL, dlambda (rad) are INS minus truth, each in its own n; phi (rad) is the rotation of
    C_c = (I - [phi x]) C_nb, INS axes against true axes.

    Raises
    ------
    InputError
        If an argument is of another class, the lengths differ, or the times differ by more than 1e-6 s.
    """
    require_instance("ins", ins, (InsSamples, Trajectory))
    require_instance("truth", truth, Trajectory)
    if len(ins) != len(truth) or np.abs(ins.t - truth.t).max() > STEP_TOLERANCE:
        raise InputError(f"ins and truth must have the same times, got {len(ins)} and {len(truth)} rows")
    phi = -rotvec_from_quat(quat_multiply(ins.q_nb, quat_conjugate(truth.q_nb)))
    place = np.stack([ins.latitude - truth.latitude, wrap(ins.longitude - truth.longitude)], axis=1)
    return np.concatenate([(ins.v_n - truth.v_n)[:, :2], place, phi], axis=1)


@cache
def deflection(earth: Earth) -> float:
    """Return d(g_N)/dL at the equator, (m/s^2)/rad; at latitude L it is this times cos 2L.

    On a sphere gravity has a northward part, -omega^2 R sin L cos L; on an ellipsoid hardly any.
    """
    return 2.0 * float(earth.gravity_n(np.array(0.25 * np.pi), np.array(0.0))[1])


def _require_equal_steps(t: Array) -> None:
    step = np.diff(t)
    if len(step) > 1 and (worst := np.abs(step - step[0]).max()) > STEP_TOLERANCE:
        raise InputError(f"t must be equally spaced, steps differ by {worst:g} s from the first, {step[0]:g} s")


def _coriolis(earth: Earth, v_n: Array, latitude: Array) -> Array:
    """Return (2 omega_ie + omega_en) x v in n, shape (n, 3)."""
    return cross(2 * earth.omega_ie_n(latitude) + earth.omega_en_n(latitude, np.zeros(len(v_n)), v_n), v_n)
