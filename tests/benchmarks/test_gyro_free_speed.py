"""Speed of the gyro-free solvers, compiled, everything included: checks, omega, q, v, p, memory for the result."""

import time

import numpy as np
import pytest

import bench

N = 200_000
TRIES = 40


def readings(position, direction, n):
    """A body that turns at a varying rate, in the order of the channels given."""
    t = 0.01 * np.arange(n)[:, None]
    phase, rate = np.array([0.3, 1.1, 2.0]), np.array([0.7, 1.1, 0.9])
    omega, alpha = 2 + np.sin(rate * t + phase), rate * np.cos(rate * t + phase)
    f = np.array([0.1, -0.2, 9.8]) + np.sin(t)
    r, w = position[None], omega[:, None]
    return ((f[:, None] + np.cross(alpha[:, None], r) + np.cross(w, np.cross(w, r))) * direction).sum(axis=2), omega[0]


def nine():
    e = np.eye(3)
    position = 0.1 * np.array([*e, *-e, [1, -1, 0], [1, 0, -1], [0, 1, -1]])
    direction = np.array([*e, *-e, *(np.array([[1, 1, 0], [1, 0, 1], [0, 1, 1]]) / np.sqrt(2))])
    return bench.Accelerometers(tuple("123456789"), position, direction)


def tetrahedron():
    corners = 0.1 * np.array([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]])
    return bench.Accelerometers(
        tuple(f"A{k}" for k in range(12)), np.repeat(corners, 3, axis=0), np.tile(np.eye(3), (4, 1))
    )


def best_rate(name, there):
    """Samples a second, best of several: what the code needs, whatever else the machine does."""
    A, omega = readings(there.position, there.direction, N)
    solver, initial = bench.solver("gyro-free", name), bench.Initial(omega_ib_b=omega, gravity=(0, 0, -9.8))
    solver.solve(there, A[:1000], 0.01, initial)  # compiles
    best = np.inf
    for _ in range(TRIES):
        begin = time.perf_counter()
        solver.solve(there, A, 0.01, initial)
        best = min(best, time.perf_counter() - begin)
    return N / best


@pytest.mark.parametrize(
    ("name", "make", "floor"),
    [("nine-accelerometer", nine, 10e6), ("array-least-squares", tetrahedron, 1e6)],
)
def test_samples_per_second(name, make, floor):
    rate = best_rate(name, make())
    print(f"{name}: {rate / 1e6:.1f} M samples/s")
    assert rate > floor
