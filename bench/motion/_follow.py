"""Attitude that follows the direction of travel: y forward along the velocity, x to the right and level, z up."""

import numpy as np

from bench.earth import Earth
from bench.errors import Array, InputError

Turning = tuple[Array, Array, Array]  # attitude (n, 4), body rate and its derivative (n, 3)


def follow_in_n(t: Array, v_n: Array, dv_n: Array, ddv_n: Array) -> Turning:
    """Return q_nf, omega_nf_f, alpha_nf_f of the frame f that follows v_n and its derivatives (components in n).

    Raises
    ------
    InputError
        Naming the time, if the velocity vanishes or is vertical.
    """
    from bench.motion._follow_kernels import follow

    still = np.zeros(v_n.shape)
    up = still + np.array([0.0, 0.0, 1.0])
    return _checked(t, follow(v_n, dv_n, ddv_n, up, still, still))


def follow_in_e(t: Array, earth: Earth, r_e: Array, v_e: Array, a_e: Array, j_e: Array) -> Turning:
    """Return q_ef, omega_ef_f, alpha_ef_f of the frame f that follows v_e, level with the ellipsoid.

    Poles are ordinary points.

    Raises
    ------
    InputError
        Naming the time, if the velocity vanishes or is vertical.
    """
    from bench.motion._follow_kernels import follow, vertical

    return _checked(t, follow(v_e, a_e, j_e, *vertical(earth.parameters, *earth.geodetic(r_e), v_e, a_e)))


def compose(first: Turning, second: Turning) -> Turning:
    """Return the motion of c in a from those of b in a and of c in b."""
    from bench.motion._follow_kernels import compose

    return compose(*first, *second)


def _checked(t: Array, following: Turning) -> Turning:
    lost = ~np.isfinite(following[0]).all(axis=1)
    if lost.any():
        raise InputError(
            "attitude cannot follow a velocity that vanishes or is vertical, as it does at "
            f"t = {t[np.argmax(lost)]} s; give the attitude itself (follow=False)"
        )
    return following
