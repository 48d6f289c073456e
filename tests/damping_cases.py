"""Paths, models and a plain Kalman filter for the tests of the damping filters."""

import math

import numpy as np

from bench.earth import SPHERE
from bench.rotation import quat_from_euler
from bench.solvers.damping import DampingModel, InsSamples
from bench.solvers.damping.error_model import discretise, error_matrix
from bench.trajectory import Trajectory

G = 9.80665
KNOWN = DampingModel(reference_noise=0.05)
NAMES = ("velocity-error", "velocity-change", "double-filter", "bias-augmented")


def ship(duration, *, v_E=10.0, v_N=8.0, turn=0.0, sway=0.0, latitude=0.25 * math.pi, dt=1.0, earth=SPHERE):
    """Return true samples of a ship on a loxodrome, with a slow swing of its speed and of its attitude."""
    t = np.arange(round(duration / dt) + 1) * dt
    scale = 1.0 + turn * np.sin(2 * math.pi * t / 1800)
    v_n = np.stack([v_E * scale, v_N * scale, 0 * t], axis=1)
    R = earth.semi_major_axis
    L = latitude + v_N / R * (t + turn * (1 - np.cos(2 * math.pi * t / 1800)) * 1800 / (2 * math.pi))
    # By the trapezoidal rule: whatever these samples are, they are the truth of the filters.
    longitude = np.concatenate(
        [[0.0], np.cumsum(0.5 * dt * (v_n[1:, 0] + v_n[:-1, 0]) / R / np.cos(0.5 * (L[1:] + L[:-1])))]
    )
    q_nb = quat_from_euler(0.3 + sway * np.sin(t / 40), sway * np.sin(t / 11), sway * np.cos(t / 17))
    return InsSamples.of(Trajectory.from_geodetic(earth, t, q_nb, v_n, L, longitude, 0 * t))


def mean_step(ins, k, model):
    """Return Phi and Q_d of the step from row k - 1 to k by Van Loan, with the mean F of its ends."""

    def at(row):
        return error_matrix(
            mean(ins.v_n), [float(mean(ins.latitude)[0])], ins.q_nb[row][None], ins.f_n[k][None],
            tau_f=model.tau_f, tau_g=model.tau_g, earth=ins.earth,
        )[0]  # fmt: skip

    def mean(rows):
        return 0.5 * (rows[k - 1 : k] + rows[k : k + 1])

    return discretise(0.5 * (at(k - 1) + at(k)), np.diag(model.density), float(ins.t[k] - ins.t[k - 1]))


def plain_filter(ins, v_ref, model, *, augmented=None, T=None, r2=1e-6):
    """Return (x, P) of every row of filter 1 and, with T steps, of filter 2: textbook matrices, nothing shared."""
    n = 13 if augmented is None else 15
    std = model.initial_std if n == 13 else np.append(model.initial_std, [augmented] * 2)
    H1 = np.zeros((2, n))
    H1[:, :2] = np.eye(2)
    if n == 15:
        H1[:, 13:] = -np.eye(2)
    states = [[np.zeros(n), np.diag(std**2)], [np.zeros(13), np.diag(model.initial_std**2)]]
    rows, back, held = ([], []), np.eye(13), None
    for k in range(len(ins)):
        if k:
            Phi, Q = mean_step(ins, k, model)
            back = back @ np.linalg.inv(Phi)
            for state in states:
                size = len(state[0])
                A, B = np.eye(size), np.zeros((size, size))
                A[:13, :13], B[:13, :13] = Phi, Q
                state[0], state[1] = A @ state[0], A @ state[1] @ A.T + B
        correct(states[0], H1, ins.v_n[k, :2] - v_ref[k], model.reference_noise**2)
        if T and k % T == 0:
            if k:
                H2 = (np.eye(13) - back)[:2] / T
                correct(states[1], H2, (states[0][0][:2] - held) / T, r2)
            back, held = np.eye(13), states[0][0][:2].copy()
        for state, kept in zip(states, rows, strict=True):
            kept.append((state[0].copy(), state[1].copy()))
    return [(np.stack([x for x, _ in kept]), np.stack([P for _, P in kept])) for kept in rows]


def correct(state, H, z, variance):
    x, P = state
    S = H @ P @ H.T + variance * np.eye(2)
    K = np.linalg.solve(S, H @ P).T
    IKH = np.eye(len(x)) - K @ H
    state[0], state[1] = x + K @ (z - H @ x), IKH @ P @ IKH.T + variance * K @ K.T
