"""Six accelerometers on the faces of a cube: alpha is linear in the readings, omega is its integral."""

import math
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from bench.errors import Array, InputError
from bench.references import CHEN, Source
from bench.signals import Accelerometers
from bench.solvers.gyro_free import GyroFreeSolver

TOLERANCE = 1e-6  # of an arm length, and of a direction: what an MJCF file with seven digits holds


@dataclass(frozen=True)
class SixAccelerometer(GyroFreeSolver):
    """Six accelerometers on the faces of a cube: omega by integrating alpha, then f.

    The face +l e_k senses along (e_i + p e_j)/sqrt(2), the face -l e_k along (e_i - p e_j)/sqrt(2), (i, j, k)
    cyclic and p = 1 or -1. With S_k and p D_k the sum and the difference of the two readings on axis k,
    alpha_i = p (D_j - S_k) / (2 sqrt(2) l) and f_i = (S_k + D_j) / (2 sqrt(2)) - p l omega_j omega_k, where j and k
    follow i. Nothing but alpha tells of the rate, so a bias makes its error grow with t.

    Notes
    -----
    Takes any arm length, either p, and the channels in any order (the source gives none). Noise s of each reading
    gives var f = s^2/2 at rest, var alpha = s^2/(2 l^2). Fourth order in dt.

    References
    ----------
    [Chen] Chen, Lee, DeBra, Gyroscope free strapdown inertial measurement unit by six linear accelerometers, 1994.
    [Tan] Tan, Park, Design of accelerometer-based inertial navigation systems, 2005.
    """

    name: ClassVar[str] = "six-accelerometer"
    source: ClassVar[Source] = CHEN

    def _constants(self, accelerometers: Accelerometers) -> tuple[Any, ...]:
        if len(accelerometers) != 6:
            raise InputError(f"{self.name} needs 6 channels, got {len(accelerometers)}; see array-least-squares")
        arm = float(np.median(np.linalg.norm(accelerometers.position, axis=1)))
        if arm == 0.0:
            raise InputError(f"{self.name} needs an arm length > 0, got {arm} m")
        faces = [(axis, sign) for axis in range(3) for sign in (1, -1)]
        channel = [self._on_face(accelerometers, arm, axis, sign) for axis, sign in faces]
        # The six products d_j * sign all have the sign of p, if the array is right.
        leaning = sum(
            sign * accelerometers.direction[c, (axis + 2) % 3] for (axis, sign), c in zip(faces, channel, strict=True)
        )
        p = 1.0 if leaning >= 0 else -1.0
        for (axis, sign), c in zip(faces, channel, strict=True):
            needed = np.zeros(3)
            needed[(axis + 1) % 3], needed[(axis + 2) % 3] = 1 / math.sqrt(2), sign * p / math.sqrt(2)
            if np.abs(accelerometers.direction[c] - needed).max() > TOLERANCE:
                raise InputError(
                    f"{self.name} needs channel {c + 1} ({accelerometers.names[c]!r}) along {needed}, "
                    f"got {accelerometers.direction[c]}; array-least-squares takes any array"
                )
        return arm, p, np.array(channel).reshape(3, 2)

    def _on_face(self, accelerometers: Accelerometers, arm: float, axis: int, sign: int) -> int:
        """Return the channel at sign * arm * e_axis."""
        face = np.zeros(3)
        face[axis] = sign * arm
        distance = np.abs(accelerometers.position - face).max(axis=1)
        c = int(np.argmin(distance))
        if distance[c] > TOLERANCE * arm:
            raise InputError(
                f"{self.name} needs a channel at {face} m; the nearest is channel {c + 1} "
                f"({accelerometers.names[c]!r}) at {accelerometers.position[c]}; array-least-squares takes any array"
            )
        return c

    def _rates(
        self,
        constants: tuple[Any, ...],
        readings: Array,
        dt: float,
        started: bool,
        carry: Array,
        omega: Array,
        alpha: Array,
        f: Array,
    ) -> int:
        from bench.solvers.gyro_free._closed_forms import six_rates

        arm, p, channel = constants
        six_rates(arm, p, channel, readings, dt, self._fourth, started, carry, omega, alpha, f)
        return 0
