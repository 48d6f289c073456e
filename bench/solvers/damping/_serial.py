"""What the filters share: the carry of the serial kernel, and its call on a chunk."""

from typing import NamedTuple

import numpy as np

from bench.errors import Array
from bench.solvers.damping import DampingFilter, DampingState
from bench.solvers.damping._model import DampingModel
from bench.solvers.damping._samples import InsSamples, deflection
from bench.solvers.damping._solution import DampingSolution


class Carry(NamedTuple):
    """Running arrays of the kernel: estimates x (f, n) and covariances P (f, n, n) of f filters, and filter 2's sums.

    rate and q (n,) are 1/tau and the noise densities of the states.
    """

    x: Array
    P: Array
    r: Array
    held: Array
    rate: Array
    q: Array


def rates(model: DampingModel) -> Array:
    """Return 1/tau of the 13 states, 0 for those that do not decay by themselves, 1/s."""
    return np.repeat([0.0, 1 / model.tau_f, 1 / model.tau_g], [7, 3, 3])


def shares(rate: Array, dt: float) -> Array:
    """Return exp of -dt, -dt/2 and dt times the rates, shape (3, n)."""
    return np.exp(np.outer([-dt, -0.5 * dt, dt], rate))


def start(model: DampingModel, filters: int = 1, extra: tuple[float, float] | None = None) -> Carry:
    """Return the carry before the first sample; extra is standard deviation and 1/tau of the reference's error."""
    std, q, rate = model.initial_std, model.density, rates(model)
    if extra is not None:
        spread, decay = extra
        std, rate = np.append(std, [spread] * 2), np.append(rate, [decay] * 2)
        q = np.append(q, [2 * decay * spread**2] * 2)
    P = np.tile(np.diag(std**2), (filters, 1, 1))
    return Carry(np.zeros((filters, len(std))), P, np.eye(2, 13), np.zeros(2), rate, q)


def run(
    damping: DampingFilter,
    state: DampingState,
    carry: Carry,
    ins: InsSamples,
    v_ref: Array,
    steps: int = 1,
    change_variance: float = 1.0,
) -> tuple[Carry, list[DampingSolution]]:
    """Return the next carry and the solution of each filter at the rows of a chunk."""
    from bench.solvers.damping._filter_kernels import run as kernel

    x, P, r, held = (part.copy() for part in carry[:4])
    (filters, n), m, every = x.shape, len(ins), damping.covariance_every
    kept = np.flatnonzero((state.rows + np.arange(m)) % every == 0) if every else np.empty(0, dtype=np.intp)
    out_x, out_sigma, found = np.empty((filters, m, n)), np.empty((filters, m, n)), np.empty((filters, m, 4))
    covariance = np.empty((filters, len(kept), n, n))
    before = ins[:1] if state.last is None else state.last
    rows = np.concatenate([path_rows(before), path_rows(ins)])
    variances = np.array([damping.model.reference_noise**2, change_variance])
    kernel(
        *(ins.earth.parameters, deflection(ins.earth), state.dt, rows, ins.f_n, v_ref, state.rows),
        *(carry.rate, shares(carry.rate, state.dt), carry.q, variances, damping.threshold, steps, every),
        *(x, P, r, held, out_x, out_sigma, found, covariance),
    )
    solutions = [
        DampingSolution(
            ins.t,
            out_x[k],
            out_sigma[k],
            innovation=found[k, :, :2].copy(),
            nis=found[k, :, 2].copy(),
            used=found[k, :, 3] > 0,
            covariance=covariance[k],
            covariance_rows=kept,
        )
        for k in range(filters)
    ]
    return carry._replace(x=x, P=P, r=r, held=held), solutions


def path_rows(ins: InsSamples) -> Array:
    """Return v_E, v_N, L, q_nb of samples as the kernels want them, shape (m, 7)."""
    return np.concatenate([ins.v_n[:, :2], ins.latitude[:, None], ins.q_nb], axis=1)
