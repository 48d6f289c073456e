"""Hand-written rigid-body kinematics in NumPy: the independent truth against which MuJoCo's readings are held."""

import numpy as np

import bench


class Tumble(bench.Motion):
    """A rich smooth motion, not one of the package's: sums of sinusoids in rate and position.

    The attitude is exp(a t) o exp(b sin(w t)) with fixed axes, so rate and angular acceleration are closed forms.
    """

    name = "tumble"

    def __init__(self, seed=0, shift=0.0, speed=0.0, gravity=(0.1, -0.2, -9.7)):
        rng = np.random.default_rng(seed)
        self.axis = rng.normal(size=3)
        self.axis /= np.linalg.norm(self.axis)
        self.spin = rng.normal(size=3)
        self.swing, self.w = rng.uniform(0.5, 1.5), rng.uniform(3.0, 9.0)
        self.amplitude, self.frequency = rng.normal(size=3), rng.uniform(1.0, 8.0, size=3)
        self.shift = shift * np.array([0.6, 0.0, 0.8])
        self.speed = speed * np.array([0.0, 1.0, 0.0])
        self.gravity = np.array(gravity)

    def kinematics(self, t):
        t = np.asarray(t)[:, None]
        angle = self.swing * np.sin(self.w * t)
        rate = self.swing * self.w * np.cos(self.w * t)
        jerk = -(self.w**2) * angle
        # q = exp(spin t / 2) o exp(axis angle / 2); omega_b = axis rate + C(axis, angle)' spin
        spin_b = rotate(self.axis, -angle, self.spin)
        omega = self.axis * rate + spin_b
        alpha = self.axis * jerk + np.cross(spin_b, self.axis * rate)
        phase = self.frequency * t
        return bench.Kinematics(
            position=self.shift + self.speed * t + self.amplitude * np.sin(phase),
            velocity=self.speed + self.amplitude * self.frequency * np.cos(phase),
            acceleration=-self.amplitude * self.frequency**2 * np.sin(phase),
            q_ib=hamilton(exponential(self.spin * t), exponential(self.axis * angle)),
            omega_ib_b=omega,
            alpha_ib_b=alpha,
            gravity=self.gravity,
        )


def rotate(axis, angle, v):
    """Rodrigues' formula for a unit axis."""
    c, s = np.cos(angle), np.sin(angle)
    return v * c + np.cross(axis, v) * s + axis * (axis @ v) * (1 - c)


def exponential(phi):
    angle = np.linalg.norm(phi, axis=1, keepdims=True)
    return np.concatenate([np.cos(angle / 2), np.sinc(angle / (2 * np.pi)) / 2 * phi], axis=1)


def hamilton(p, q):
    w = p[:, 0] * q[:, 0] - (p[:, 1:] * q[:, 1:]).sum(1)
    v = p[:, :1] * q[:, 1:] + q[:, :1] * p[:, 1:] + np.cross(p[:, 1:], q[:, 1:])
    return np.column_stack([w, v])


def readings(truth, position, direction):
    """A = d . (C_bi (a - g) + alpha x r + omega x (omega x r)), rows of time, columns of channels."""
    w, x, y, z = truth.q_ib.T
    C_ib = np.array(
        [
            [w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z],
        ]
    )
    f_b = np.einsum("jin,nj->ni", C_ib, truth.acceleration - truth.gravity)
    omega, alpha = truth.omega_ib_b[:, None], truth.alpha_ib_b[:, None]
    field = f_b[:, None] + np.cross(alpha, position) + np.cross(omega, np.cross(omega, position))
    return np.einsum("nmi,mi->nm", field, direction)
