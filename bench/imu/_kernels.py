"""Sequential kernels of the error models; the same bits for any chunking."""

import numpy as np

from bench.jit import njit


@njit
def correlated(z, b, decay, gain, mean, ahead, own):
    """Return the readings of a drifting bias, shape (n, k), and leave its next value in b.

    z (n, m, k) are unit normals. Over each step b <- decay b + gain z0. The reading is b itself (m = 1) or
    b's integral over the step, mean b + ahead z0 + own z1 (m = 2).
    """
    n, m, k = z.shape
    reading = np.empty((n, k))
    for i in range(n):
        for j in range(k):
            if m == 1:
                reading[i, j] = b[j]
            else:
                reading[i, j] = mean * b[j] + ahead[j] * z[i, 0, j] + own[j] * z[i, 1, j]
            b[j] = decay * b[j] + gain[j] * z[i, 0, j]
    return reading


@njit
def count(counts, residue):
    """Replace readings in quanta by whole counts, in place; what is left over stays in residue (within 1/2)."""
    n, k = counts.shape
    for i in range(n):
        for j in range(k):
            total = counts[i, j] + residue[j]
            whole = np.rint(total)
            residue[j] = total - whole  # exact: never grows, so precision does not degrade with time
            counts[i, j] = whole


@njit
def lag_samples(signal, lagged, previous, from_previous, from_present):
    """Lag samples of an input that is linear between them, in place."""
    n, k = signal.shape
    for i in range(n):
        for j in range(k):
            present = signal[i, j]
            # As differences, so that a constant input passes unchanged to the last bit.
            lagged[j] += from_previous * (previous[j] - lagged[j]) + from_present * (present - lagged[j])
            previous[j] = present
            signal[i, j] = lagged[j]


@njit
def lag_increments(signal, lagged, rise, mean):
    """Lag increments of an input held over each interval, in place; lagged is the output's rate times dt."""
    n, k = signal.shape
    for i in range(n):
        for j in range(k):
            held = signal[i, j]
            behind = lagged[j] - held
            signal[i, j] = held + mean * behind
            lagged[j] -= rise * behind
