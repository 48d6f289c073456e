"""Rotations of one sample for numba kernels: plain floats in, tuples out.

The conventions are those of ``bench.rotation``; a test holds the two against each other.
"""

import math

from bench.jit import njit


@njit
def multiply(pw, px, py, pz, qw, qx, qy, qz):
    """Return p o q."""
    return (
        pw * qw - px * qx - py * qy - pz * qz,
        pw * qx + px * qw + py * qz - pz * qy,
        pw * qy - px * qz + py * qw + pz * qx,
        pw * qz + px * qy - py * qx + pz * qw,
    )


@njit
def exponential(x, y, z):
    """Return exp(phi/2) of the rotation vector phi = (x, y, z)."""
    square = x * x + y * y + z * z
    if square < 0.04:  # |phi| < 0.2: the series is at rounding (next term 1e-17) and much faster than sin and cos
        c = 1.0 + square * (-1 / 8 + square * (1 / 384 + square * (-1 / 46080 + square * (1 / 10321920))))
        s = 0.5 + square * (-1 / 48 + square * (1 / 3840 + square * (-1 / 645120 + square * (1 / 185794560))))
    else:
        angle = math.sqrt(square)
        c = math.cos(0.5 * angle)
        s = math.sin(0.5 * angle) / angle
    return c, s * x, s * y, s * z


@njit
def rotate(w, x, y, z, vx, vy, vz):
    """Return C v for the unit quaternion (w, x, y, z)."""
    tx = 2.0 * (y * vz - z * vy)
    ty = 2.0 * (z * vx - x * vz)
    tz = 2.0 * (x * vy - y * vx)
    return (
        vx + w * tx + y * tz - z * ty,
        vy + w * ty + z * tx - x * tz,
        vz + w * tz + x * ty - y * tx,
    )


@njit
def normalize(w, x, y, z):
    """Return q / |q|."""
    scale = 1.0 / math.sqrt(w * w + x * x + y * y + z * z)
    return w * scale, x * scale, y * scale, z * scale
