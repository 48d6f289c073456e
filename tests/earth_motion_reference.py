"""Motion on the rotating Earth in mpmath, from angles and lengths as functions of time alone; nothing of bench is used.

Every derivative is taken of the closed form in 40 digits, so the results are right far beyond double precision.
"""

import mpmath as mp
import numpy as np

DIGITS = 40
A, F = mp.mpf("6378137"), 1 / mp.mpf("298.257223563")
E2 = F * (2 - F)
GM, RATE, J2 = mp.mpf("3.986004418e14"), mp.mpf("7.292115e-5"), mp.mpf("1.082629821313e-3")


def exact(number):
    """The double as it is."""
    return mp.mpf(float(number))


def sine(offset, rate, amplitude, w, phase):
    """offset + rate t + amplitude sin(w t + phase) as a function of time, of the very doubles given."""
    offset, rate, amplitude, w, phase = map(exact, (offset, rate, amplitude, w, phase))
    return lambda t: offset + rate * t + amplitude * mp.sin(w * t + phase)


def about(axis, angle):
    """Right-handed rotation matrix about x, y or z."""
    c, s = mp.cos(angle), mp.sin(angle)
    rows = {
        "x": [[1, 0, 0], [0, c, -s], [0, s, c]],
        "y": [[c, 0, s], [0, 1, 0], [-s, 0, c]],
        "z": [[c, -s, 0], [s, c, 0], [0, 0, 1]],
    }
    return mp.matrix(rows[axis])


def position_e(L, lon, h):
    N = A / mp.sqrt(1 - E2 * mp.sin(L) ** 2)
    across = (N + h) * mp.cos(L)
    return mp.matrix([across * mp.cos(lon), across * mp.sin(lon), (N * (1 - E2) + h) * mp.sin(L)])


def C_en(L, lon):
    """Columns east, north, up."""
    return mp.matrix(
        [
            [-mp.sin(lon), -mp.sin(L) * mp.cos(lon), mp.cos(L) * mp.cos(lon)],
            [mp.cos(lon), -mp.sin(L) * mp.sin(lon), mp.cos(L) * mp.sin(lon)],
            [0, mp.cos(L), mp.sin(L)],
        ]
    )


def C_nb(psi, P, R):
    return about("z", psi) * about("x", P) * about("y", R)


def gravitation(r):
    """Gradient of GM/r (1 - J2 (a/r)^2 P2(z/r))."""
    x, y, z = r
    r2 = x * x + y * y + z * z
    k, ratio = mp.mpf(3) / 2 * J2 * A * A / r2, z * z / r2
    scale = -GM / r2 ** mp.mpf("1.5")
    return (
        mp.matrix([x * (1 + k * (1 - 5 * ratio)), y * (1 + k * (1 - 5 * ratio)), z * (1 + k * (3 - 5 * ratio))]) * scale
    )


def derivative(function, t, order):
    """Derivative of a matrix-valued function of time."""
    rows, columns = function(t).rows, function(t).cols
    out = mp.matrix(rows, columns)
    for i in range(rows):
        for j in range(columns):
            out[i, j] = mp.diff(lambda x, i=i, j=j: function(x)[i, j], t, order)
    return out


def floats(matrix):
    return np.array(matrix.tolist(), dtype=float).squeeze()


def inertial(r_e, C_eb, t):
    """Position, velocity, acceleration, C_ib, omega, alpha, gravitation in i and f_b at time t, as arrays.

    r_e and C_eb are functions of time that return matrices; i agrees with e at t = 0.
    """
    with mp.workdps(DIGITS):
        t = exact(t)

        def r_i(x):
            return about("z", RATE * x) * r_e(x)

        def C_ib(x):
            return about("z", RATE * x) * C_eb(x)

        C, dC, ddC = (derivative(C_ib, t, order) for order in (0, 1, 2))
        W, dW = C.T * dC, C.T * ddC + dC.T * dC
        acceleration = derivative(r_i, t, 2)
        G = about("z", RATE * t) * gravitation(r_e(t))
        return {
            "position": floats(r_i(t)),
            "velocity": floats(derivative(r_i, t, 1)),
            "acceleration": floats(acceleration),
            "C_ib": floats(C),
            "omega_ib_b": np.array([float(W[2, 1]), float(W[0, 2]), float(W[1, 0])]),
            "alpha_ib_b": np.array([float(dW[2, 1]), float(dW[0, 2]), float(dW[1, 0])]),
            "gravity": floats(G),
            "f_b": floats(C.T * (acceleration - G)),
        }
