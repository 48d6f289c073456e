"""Nine accelerometers in closed form: rates from the roots of their squares, signs from integrated alpha."""

import math
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from bench.errors import Array, InputError
from bench.references import QIN, Source
from bench.signals import Accelerometers
from bench.solvers.gyro_free import GyroFreeSolver

# Figure 1 of [Qin]; the print has sqrt(l) for l and drops the 1/sqrt(2).
POSITION = np.array(
    [[1, 0, 0], [0, 1, 0], [0, 0, 1], [-1, 0, 0], [0, -1, 0], [0, 0, -1], [1, -1, 0], [1, 0, -1], [0, 1, -1]],
    dtype=float,
)  # in arm lengths
DIRECTION = np.array(
    [[1, 0, 0], [0, 1, 0], [0, 0, 1], [-1, 0, 0], [0, -1, 0], [0, 0, -1], [1, 1, 0], [1, 0, 1], [0, 1, 1]], dtype=float
) / np.array([[1.0]] * 6 + [[math.sqrt(2)]] * 3)
TOLERANCE = 1e-6  # of an arm length, and of a direction: what an MJCF file with seven digits holds


@dataclass(frozen=True)
class NineAccelerometer(GyroFreeSolver):
    """Nine accelerometers in closed form: |omega| from the root of its square, the sign from integrated alpha.

    f, alpha and the three squares are linear in the readings (equations 3, 6 and 4 of [Qin]). A square that noise
    makes negative counts as zero, and is counted. Near zero rate the root is poor: an error e of the square
    becomes sqrt(e) of the rate; and the integral of alpha drifts, so that after long rest a sign may be wrong.

    Notes
    -----
    Takes the array of [Qin] with any arm length, channels in the order of the paper. Noise s of each reading gives
    var f = s^2/2, var omega_i^2 = (3/8) s^2/l^2, var alpha = s^2/l^2. Fourth order in dt.

    References
    ----------
    [Qin] Qin, Xu, Li, A new calculative method for gyro-free inertial navigation system using 9 accelerometers.
    """

    name: ClassVar[str] = "nine-accelerometer"
    source: ClassVar[Source] = QIN.at("equations 3, 4, 6")

    def _constants(self, accelerometers: Accelerometers) -> tuple[Any, ...]:
        if len(accelerometers) != len(POSITION):
            raise InputError(f"{self.name} needs 9 channels, got {len(accelerometers)}; see array-least-squares")
        position, direction = accelerometers.position, accelerometers.direction
        arm = float(np.median(np.linalg.norm(position[:6], axis=1)))
        if arm == 0.0:
            raise InputError(f"{self.name} needs an arm length > 0, got {arm} m")
        wrong = (np.abs(position - arm * POSITION).max(axis=1) > TOLERANCE * arm) | (
            np.abs(direction - DIRECTION).max(axis=1) > TOLERANCE
        )
        if wrong.any():
            k = int(np.argmax(wrong))
            raise InputError(
                f"{self.name} needs channel {k + 1} ({accelerometers.names[k]!r}) at {arm * POSITION[k]} m along "
                f"{DIRECTION[k]}, got {position[k]} along {direction[k]}; array-least-squares takes any array"
            )
        return (arm,)

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
        from bench.solvers.gyro_free._closed_forms import nine_rates

        (arm,) = constants
        return int(nine_rates(arm, readings, dt, self._fourth, started, carry, omega, alpha, f))
