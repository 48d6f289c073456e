"""The ellipsoid and its potentials in mpmath, at 40 digits, from the textbook formulas: truth for the Earth models."""

import mpmath

mp = mpmath.MPContext()  # its own precision: others keep theirs
mp.dps = 40


def numbers(earth):
    """Return a, e^2, GM, omega_ie, J2 of the model as they are, in mp."""
    return [mp.mpf(value) for value in earth.parameters[:5]]


def position(earth, latitude, longitude, height):
    """Return r_e of a geodetic position."""
    a, e2, *_ = numbers(earth)
    L, lon, h = map(mp.mpf, (latitude, longitude, height))
    R_N = a / mp.sqrt(1 - e2 * mp.sin(L) ** 2)
    across = (R_N + h) * mp.cos(L)
    return across * mp.cos(lon), across * mp.sin(lon), (R_N * (1 - e2) + h) * mp.sin(L)


def geodetic(earth, r_e):
    """Return latitude, longitude, height: the fixed point tan L = (z + e^2 R_N sin L) / rho, to 30 digits."""
    a, e2, *_ = numbers(earth)
    x, y, z = map(mp.mpf, r_e)
    rho = mp.hypot(x, y)
    L = mp.atan2(z, rho * (1 - e2))
    for _ in range(40):  # each step gains a factor of e^2 at least
        sine = mp.sin(L)
        L = mp.atan2(z + e2 * a / mp.sqrt(1 - e2 * sine**2) * sine, rho)
    sine = mp.sin(L)
    return L, mp.atan2(y, x), rho * mp.cos(L) + z * sine - a * mp.sqrt(1 - e2 * sine**2)


def q_function(ratio):
    """Return q of Heiskanen and Moritz, Eq. 2-57, for ratio = u / E."""
    return ((1 + 3 * ratio**2) * mp.atan(1 / ratio) - 3 * ratio) / 2


def normal_potential(earth, x, y, z):
    """Return the gravitational potential of the level ellipsoid (Heiskanen and Moritz, Eq. 2-62, gravitation only)."""
    a, e2, GM, rate, _ = numbers(earth)
    b, E = a * mp.sqrt(1 - e2), a * mp.sqrt(e2)
    difference = x * x + y * y + z * z - E**2
    u = mp.sqrt(difference / 2 * (1 + mp.sqrt(1 + 4 * E**2 * z**2 / difference**2)))
    level = rate**2 * a**2 / 2 * q_function(u / E) / q_function(b / E) * ((z / u) ** 2 - mp.mpf(1) / 3)
    return GM / E * mp.atan(E / u) + level


def j2_potential(earth, x, y, z):
    """Return GM/r (1 - J2 (a/r)^2 P2(sin of the geocentric latitude))."""
    a, _, GM, _, J2 = numbers(earth)
    r = mp.sqrt(x * x + y * y + z * z)
    return GM / r * (1 - J2 * (a / r) ** 2 * (3 * (z / r) ** 2 - 1) / 2)


def gradient(potential, earth, r_e):
    """Return the gradient of a potential at r_e, differentiated by mpmath."""
    at = tuple(map(mp.mpf, r_e))
    return [mp.diff(lambda *r: potential(earth, *r), at, tuple(int(k == i) for k in range(3))) for i in range(3)]
