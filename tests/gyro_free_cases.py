"""Arrays and motions for the gyro-free tests, written down here by hand and not taken from the package."""

import numpy as np

import bench

E = np.eye(3)
GRAVITY = np.array([0.3, -0.2, -9.7])


def array(position, direction):
    direction = np.array(direction, dtype=float)
    direction /= np.linalg.norm(direction, axis=1)[:, None]
    names = tuple(f"A{k + 1}" for k in range(len(direction)))
    return bench.Accelerometers(names, np.array(position, dtype=float), direction)


def nine(arm=0.1):
    """Qin, Xu, Li, figure 1."""
    position = [*E, *-E, [1, -1, 0], [1, 0, -1], [0, 1, -1]]
    return array(arm * np.array(position), [*E, *-E, [1, 1, 0], [1, 0, 1], [0, 1, 1]])


def cube(p=1, arm=0.1):
    """Chen, Lee, DeBra: faces +x, -x, +y, -y, +z, -z."""
    position = [s * arm * E[k] for k in range(3) for s in (1, -1)]
    direction = [E[(k + 1) % 3] + s * p * E[(k + 2) % 3] for k in range(3) for s in (1, -1)]
    return array(position, direction)


def triads(points):
    return array(np.repeat(points, 3, axis=0), np.tile(E, (len(points), 1)))


def tetrahedron(arm=0.1):
    return triads(arm * np.array([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]]))


def padgaonkar(arm=0.1):
    x, y, z = E
    return array(arm * np.array([0 * x, 0 * x, 0 * x, x, x, y, y, z, z]), [x, y, z, y, z, x, z, x, y])


def rotated(accelerometers, C):
    return array(accelerometers.position @ C.T, accelerometers.direction @ C.T)


FITTING = {"nine-accelerometer": nine, "six-accelerometer": cube}


def fitting(name):
    """An array that the solver takes; a new solver is tried on the tetrahedron."""
    return FITTING.get(name, tetrahedron)()


def readings(accelerometers, omega, alpha, f):
    """A = d . (f + alpha x r + omega x (omega x r)) with numpy.cross, shape (n, m)."""
    r, w = accelerometers.position[None], omega[:, None]
    at_sensor = f[:, None] + np.cross(alpha[:, None], r) + np.cross(w, np.cross(w, r))
    return (at_sensor * accelerometers.direction).sum(axis=2)


class Wave:
    """Smooth motion: each component of omega and f a constant plus two sines; exact derivatives."""

    def __init__(self, seed, mean=1.0, swing=0.5, frequency=4.0):
        rng = np.random.default_rng(seed)
        self.mean = mean * rng.choice([-1.0, 1.0], 3)
        self.amplitude = swing * rng.uniform(0.4, 1.0, (2, 3))
        self.rate = frequency * rng.uniform(0.3, 1.0, (2, 3))
        self.phase = rng.uniform(0, 2 * np.pi, (2, 3))
        self.f_mean, self.f_amplitude = rng.uniform(-5, 10, 3), rng.uniform(1, 3, 3)

    def _angle(self, t):
        return self.rate * np.asarray(t)[..., None, None] + self.phase

    def omega(self, t):
        return self.mean + (self.amplitude * np.sin(self._angle(t))).sum(axis=-2)

    def alpha(self, t):
        return (self.amplitude * self.rate * np.cos(self._angle(t))).sum(axis=-2)

    def f(self, t):
        return self.f_mean + self.f_amplitude * np.cos(self._angle(t)[..., 0, :])

    def readings(self, accelerometers, t):
        return readings(accelerometers, self.omega(t), self.alpha(t), self.f(t))

    def initial(self, **change):
        state = {"q_ib": [0.5, 0.5, -0.5, 0.5], "velocity": [1, -2, 3], "position": [10, 20, -30], "gravity": GRAVITY}
        return bench.Initial(omega_ib_b=self.omega(0.0), **{**state, **change})
