"""What the filters share: the carry of the serial kernel, and its call on a chunk."""

from typing import NamedTuple

import numpy as np

from bench.errors import Array
from bench.solvers.damping import DampingFilter, DampingState
from bench.solvers.damping._model import DampingModel
from bench.solvers.damping._samples import InsSamples, deflection
from bench.solvers.damping._solution import DampingSolution

EMPTY = np.empty((0, 0))


class Carry(NamedTuple):
    """Running arrays of the kernel: estimate and covariance of filters 1 and 2, and what filter 2 accumulates.

    rate and q (n,) are 1/tau and the noise densities of the states.
    """

    x1: Array
    P1: Array
    x2: Array
    P2: Array
    r: Array
    held: Array
    rate: Array
    q: Array


def rates(model: DampingModel) -> Array:
    """Return 1/tau of the 13 states, 0 for those that do not decay by themselves, 1/s."""
    return np.repeat([0.0, 1 / model.tau_f, 1 / model.tau_g], [7, 3, 3])


def start(model: DampingModel, extra: tuple[float, float] | None = None) -> Carry:
    """Return the carry before the first sample; extra is standard deviation and 1/tau of the reference's error."""
    std, q, rate = model.initial_std, model.density, rates(model)
    if extra is not None:
        spread, decay = extra
        std, rate = np.append(std, [spread] * 2), np.append(rate, [decay] * 2)
        q = np.append(q, [2 * decay * spread**2] * 2)
    P = np.diag(std**2)
    r = np.eye(2, 13)
    return Carry(np.zeros(len(std)), P, np.zeros(13), P[:13, :13].copy(), r, np.zeros(2), rate, q)


def run(
    damping: DampingFilter, state: DampingState, ins: InsSamples, v_ref: Array, steps: int = 0, variance2: float = 1.0
) -> tuple[Carry, DampingSolution, DampingSolution | None]:
    """Return the next carry and the solutions of filter 1 and, if steps > 0, filter 2 at the rows of a chunk."""
    from bench.solvers.damping._filter_kernels import run as kernel

    carry: Carry = state.carry
    x1, P1, x2, P2, r, held = (part.copy() for part in carry[:6])
    m, n = len(ins), len(x1)
    every = damping.covariance_every
    kept_rows = np.flatnonzero((state.rows + np.arange(m)) % every == 0) if every else np.empty(0, dtype=np.intp)
    out = [_outputs(m, n, len(kept_rows)), _outputs(m, 13, len(kept_rows)) if steps else _outputs(0, 13, 0)]
    before = ins[:1] if state.last is None else state.last
    rows = np.concatenate([path_rows(before), path_rows(ins)])
    kernel(
        *(ins.earth.parameters, deflection(ins.earth), state.dt, rows, ins.f_n, v_ref, state.rows),
        *(carry.rate, carry.q, damping.model.reference_noise**2, damping.threshold, steps, variance2),
        *(x1, P1, x2, P2, r, held, every, *out[0][:3], *out[1][:3], out[0][3], out[1][3]),
    )
    after = carry._replace(x1=x1, P1=P1, x2=x2, P2=P2, r=r, held=held)
    first, second = (_solution(ins.t, kept_rows, *arrays) if len(arrays[0]) else None for arrays in out)
    assert first is not None
    return after, first, second


def path_rows(ins: InsSamples) -> Array:
    """Return v_E, v_N, L, q_nb of samples as the kernels want them, shape (m, 7)."""
    return np.concatenate([ins.v_n[:, :2], ins.latitude[:, None], ins.q_nb], axis=1)


def _outputs(m: int, n: int, kept: int) -> tuple[Array, Array, Array, Array]:
    return np.empty((m, n)), np.empty((m, n)), np.empty((m, 4)), np.empty((kept, n, n))


def _solution(t: Array, rows: Array, x: Array, sigma: Array, found: Array, covariance: Array) -> DampingSolution:
    return DampingSolution(t, x, sigma, found[:, :2].copy(), found[:, 2].copy(), found[:, 3] > 0, covariance, rows)
