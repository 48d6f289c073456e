"""Every navigation solver with every combination of its options, found by trying, and increments to feed them."""

import numpy as np
from scipy.spatial.transform import Rotation

from bench.earth import WGS84
from bench.solvers import solvers
from bench.trajectory import NavigationInitial
from tests.solver_cases import option_sets

# Options that cannot be found by trying; a solver without an entry is tested all the same.
MORE = {
    "navigation-frame": [{"compensate_every": 4}, {"compensate_every": 3, "azimuth": "wander"}],
    "polynomial-exact": [{"window": 8}],
}

CRUDE = {"first-order-quaternion"}  # on purpose: in latitude and longitude, and gravity does not turn with n


def variants(name, sizes=(1, 2, 8)):
    """Return the solvers of a name: all its numbers of samples among the sizes, times its options."""
    return option_sets("navigation", name, sizes, MORE.get(name, []))


def all_variants(sizes=(1, 2, 8)):
    """Return the variants of all solvers."""
    return [solver for name in sorted(solvers("navigation")) for solver in variants(name, sizes)]


def goes_over_poles(solver):
    """Return whether a solver works at a pole: all but those whose axes point north."""
    return solver.name not in CRUDE and getattr(solver, "azimuth", None) != "north"


def is_late(solver):
    """Return whether a solver's attitude lags behind on purpose."""
    return getattr(solver, "compensate_every", 1) > 1


def initial(latitude=0.7, longitude=-2.0, height=500.0, v_n=(30.0, -20.0, 1.0), q_nb=None):
    """Return an initial state; the attitude is oblique unless it is given."""
    q_nb = Rotation.from_rotvec([0.4, -0.9, 1.3]).as_quat(scalar_first=True) if q_nb is None else q_nb
    return NavigationInitial(q_nb, v_n, latitude=latitude, longitude=longitude, height=height)


def swaying(n, rate=100.0, seed=0):
    """Return n increments of a body that swings by about 1 rad/s and is carried by about 1 g, from their integrals."""
    rng = np.random.default_rng(seed)
    t = np.arange(n + 1)[:, None, None] / rate
    frequency, phase = rng.uniform(1.0, 5.0, (2, 3, 3)), rng.uniform(0, 2 * np.pi, (2, 3, 3))
    angle, velocity = (np.sin(w * t + p).sum(axis=2) for w, p in zip(frequency, phase, strict=True))
    gravity = np.array([3.0, -4.0, 8.4]) * t[:, :, 0]
    return np.diff(0.2 * angle, axis=0), np.diff(0.5 * velocity + gravity, axis=0)


def at_rest(n, dt, latitude, height, q_nb, earth=WGS84):
    """Return the increments of a body at rest on the Earth, at longitude 0: of two constants, resolved by SciPy."""
    position = earth.position(latitude, 0.0, height)
    C_en = np.array([[0, -np.sin(latitude), np.cos(latitude)], [1, 0, 0], [0, np.cos(latitude), np.sin(latitude)]])
    to_body = Rotation.from_quat(q_nb, scalar_first=True).inv() * Rotation.from_matrix(C_en).inv()
    rate, force = to_body.apply(earth.omega_ie), to_body.apply(-earth.gravity(position))
    return np.tile(rate * dt, (n, 1)), np.tile(force * dt, (n, 1))
