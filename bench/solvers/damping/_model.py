"""What a damping filter believes: initial errors, noises of the sensors and of the external reference velocity."""

from dataclasses import dataclass

import numpy as np

from bench.errors import Array, require_choice, require_scalar
from bench.references import ZHAO, Source
from bench.units import ARCMIN, ARCSEC, DEG_PER_H, STANDARD_GRAVITY

Q_READINGS = ("markov", "printed")
SOURCE: Source = ZHAO.at("section 3.1")


@dataclass(frozen=True)
class DampingModel:
    """Noise model of the 13 error states; the defaults are the published conditions with tau = 3600 s.

    The errors of accelerometers and gyros are first-order Markov processes, b' = -b/tau + w, that start with the
    standard deviation `accelerometer_bias` or `gyro_bias` and are driven towards `accelerometer_drift` or
    `gyro_drift`: the two-sided density of w is 2 drift^2/tau.

    Parameters
    ----------
    velocity : float, m/s
        Initial standard deviation east and north.
    position : float, rad
        Initial standard deviation of latitude and of longitude.
    tilt, heading : float, rad
        Initial standard deviations of phi_E and phi_N, and of phi_U.
    accelerometer_bias : float, m/s^2
    gyro_bias : float, rad/s
    accelerometer_drift : float, m/s^2
    gyro_drift : float, rad/s
    tau_f, tau_g : float, s
        Correlation times of the accelerometers' and the gyros' errors.
    velocity_noise : float, (m/s^2)/sqrt(Hz)
        White noise on the derivative of the velocity.
    attitude_noise : float, (rad/s)/sqrt(Hz)
        White noise on the derivative of phi.
    reference_noise : float, m/s
        Standard deviation of each reference velocity, east and north: R1 is its square.

    Raises
    ------
    InputError
        If a value is negative, or a correlation time or `reference_noise` is not positive.
    """

    velocity: float = 0.1
    position: float = 2 * ARCSEC
    tilt: float = 0.7 * ARCMIN
    heading: float = 7.7 * ARCMIN
    accelerometer_bias: float = 5e-5 * STANDARD_GRAVITY
    gyro_bias: float = 0.005 * DEG_PER_H
    accelerometer_drift: float = 1e-5 * STANDARD_GRAVITY
    gyro_drift: float = 0.001 * DEG_PER_H
    tau_f: float = 3600.0
    tau_g: float = 3600.0
    velocity_noise: float = 1e-4 * STANDARD_GRAVITY * (2 / 3600.0) ** 0.5
    attitude_noise: float = 0.01 * DEG_PER_H * (2 / 3600.0) ** 0.5
    reference_noise: float = 0.05

    def __post_init__(self) -> None:
        positive = ("tau_f", "tau_g", "reference_noise")
        for name, value in vars(self).items():
            require_scalar(name, value, positive=name in positive, minimum=0.0)

    @classmethod
    def published(cls, tau: float = 3600.0, q_reading: str = "markov", reference_noise: float = 0.05) -> "DampingModel":
        """Return the model of [Zhao] section 3.1, with what it does not state.

        Parameters
        ----------
        tau : float, s
            Correlation time of all errors; assumed between 1000 and 3600 s.
        q_reading : {"markov", "printed"}
            Q as printed, 2 diag(sigma^2), has the unit of sigma^2, not that of a density. "markov" divides it by
            tau, as for first-order Markov errors of that sigma; "printed" takes it as a density per Hz.
        reference_noise : float, m/s
            0.05, of the printed R1.

        Raises
        ------
        InputError
            If tau is not positive or q_reading is unknown.
        """
        tau = require_scalar("tau", tau, positive=True)
        span = tau if require_choice("q_reading", q_reading, Q_READINGS) == "markov" else 1.0
        white, drift = (2 / span) ** 0.5, (tau / span) ** 0.5
        return cls(
            accelerometer_drift=1e-5 * STANDARD_GRAVITY * drift,
            gyro_drift=0.001 * DEG_PER_H * drift,
            tau_f=tau,
            tau_g=tau,
            velocity_noise=1e-4 * STANDARD_GRAVITY * white,
            attitude_noise=0.01 * DEG_PER_H * white,
            reference_noise=reference_noise,
        )

    @property
    def initial_std(self) -> Array:
        """Standard deviations of the 13 states at the start, shape (13,)."""
        tilt, position, velocity = [self.tilt] * 2, [self.position] * 2, [self.velocity] * 2
        biases = [self.accelerometer_bias] * 3 + [self.gyro_bias] * 3
        return np.array([*velocity, *position, *tilt, self.heading, *biases])

    @property
    def density(self) -> Array:
        """Diagonal of Q, the two-sided densities of the noise on the derivatives of the 13 states, shape (13,)."""
        drive = [2 * self.accelerometer_drift**2 / self.tau_f] * 3 + [2 * self.gyro_drift**2 / self.tau_g] * 3
        white = [self.velocity_noise**2] * 2 + [0.0] * 2 + [self.attitude_noise**2] * 3
        return np.array([*white, *drive])


PUBLISHED = DampingModel()
