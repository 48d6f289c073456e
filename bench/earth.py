"""Earth models: ellipsoid, rotation rate and gravitation, each frozen and with its source.

Frames: e is Earth-fixed (x through latitude 0, longitude 0; z along the axis), n is east-north-up at a geodetic
position, i does not turn and agrees with e at t = 0. Gravitation G is the attraction alone; gravity
g = G - omega_ie x (omega_ie x r) is what a plumb line feels. Kernels on scalars are in ``bench.earth_kernels``.

References
----------
[WGS84] NIMA TR8350.2, Department of Defense World Geodetic System 1984, 3rd edition, 2000.
[HM] Heiskanen, Moritz: Physical Geodesy, 1967, sections 2-7 to 2-10.
[Bowring] Bowring: The accuracy of geodetic latitude and height equations, Survey Review 28, 1985.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from bench.errors import Array, InputError, require_array, require_choice, require_scalar
from bench.references import WGS84_REPORT, ZHAO, Source
from bench.rotation import quat_multiply

FIELDS = ("j2", "normal")


@dataclass(frozen=True)
class Earth:
    """An ellipsoid of revolution that turns and attracts.

    Attributes
    ----------
    name : str
    semi_major_axis : float, m
    flattening : float
        0 is a sphere.
    GM : float, m^3/s^2
    rate : float, rad/s
        omega_ie.
    J2 : float
        Second zonal harmonic of the gravitation; 0 is a point mass.
    field : {"j2", "normal"}
        Gravitation of truth and solvers: point mass and J2, or the exact normal (Somigliana) field of the
        ellipsoid, closed form in the height.
    source : Source

    Raises
    ------
    InputError
        If a number is not finite or out of range.
    """

    name: str
    semi_major_axis: float
    flattening: float
    GM: float
    rate: float
    J2: float
    field: str
    source: Source

    def __post_init__(self) -> None:
        require_scalar("semi_major_axis", self.semi_major_axis, positive=True)
        if require_scalar("flattening", self.flattening, minimum=0.0) >= 1:
            raise InputError(f"flattening must be below 1, got {self.flattening!r}")
        require_scalar("GM", self.GM, positive=True)
        require_scalar("rate", self.rate)
        require_scalar("J2", self.J2)
        require_choice("field", self.field, FIELDS)

    @property
    def eccentricity_squared(self) -> float:
        """First eccentricity e^2 = f (2 - f)."""
        return self.flattening * (2.0 - self.flattening)

    @property
    def semi_minor_axis(self) -> float:
        """b = a (1 - f), m."""
        return self.semi_major_axis * (1.0 - self.flattening)

    @cached_property
    def parameters(self) -> Array:
        """What kernels need: a, e^2, GM, omega_ie, J2, field (0 J2, 1 normal); do not write into it."""
        field = float(FIELDS.index(self.field))
        return np.array([self.semi_major_axis, self.eccentricity_squared, self.GM, self.rate, self.J2, field])

    def radii(self, latitude: ArrayLike) -> tuple[Array, Array]:
        """Return the radii of curvature R_M (meridian) and R_N (prime vertical) at geodetic latitudes, m."""
        w2 = 1.0 - self.eccentricity_squared * np.sin(latitude) ** 2
        R_N = self.semi_major_axis / np.sqrt(w2)
        return R_N * (1.0 - self.eccentricity_squared) / w2, R_N

    def position(self, latitude: ArrayLike, longitude: ArrayLike, height: ArrayLike) -> Array:
        """Return r_e, shape (..., 3), m, of geodetic positions, rad and m."""
        sine, cosine = np.sin(latitude), np.cos(latitude)
        R_N = self.radii(latitude)[1]
        across = (R_N + height) * cosine
        z = (R_N * (1.0 - self.eccentricity_squared) + height) * sine
        x, y, z = np.broadcast_arrays(across * np.cos(longitude), across * np.sin(longitude), z)
        return np.stack([x, y, z], axis=-1)

    def geodetic(self, r_e: ArrayLike) -> tuple[Array, Array, Array]:
        """Return latitude, longitude (rad) and height (m) of r_e, shape (..., 3), m.

        Bowring's iteration on the reduced latitude, in a form without division, so that the poles are ordinary
        points. At the axis the longitude is that of atan2(0, 0) = 0.
        """
        x, y, z = np.moveaxis(np.asarray(r_e, dtype=float), -1, 0)
        a, b, e2 = self.semi_major_axis, self.semi_minor_axis, self.eccentricity_squared
        p = np.hypot(x, y)
        s, c = z * a, p * b
        for _ in range(4):
            norm = np.hypot(s, c)
            s, c = s / norm, c / norm  # of the reduced latitude
            sine, cosine = z + e2 / (1.0 - e2) * b * s**3, p - e2 * a * c**3
            s, c = (1.0 - self.flattening) * sine, cosine
        latitude = np.arctan2(sine, cosine)
        norm = np.hypot(sine, cosine)
        sine, cosine = sine / norm, cosine / norm
        height = p * cosine + z * sine - a * np.sqrt(1.0 - e2 * sine**2)
        return latitude, np.arctan2(y, x), height

    def q_en(self, latitude: ArrayLike, longitude: ArrayLike) -> Array:
        """Return the attitude of n (east-north-up) in e, shape (..., 4): q_z(lambda + pi/2) o q_x(pi/2 - L)."""
        latitude, longitude = np.broadcast_arrays(latitude, longitude)
        zero = np.zeros(latitude.shape)
        half = 0.5 * longitude + np.pi / 4
        tilt = np.pi / 4 - 0.5 * latitude
        q_z = np.stack([np.cos(half), zero, zero, np.sin(half)], axis=-1)
        return quat_multiply(q_z, np.stack([np.cos(tilt), np.sin(tilt), zero, zero], axis=-1))

    def q_ie(self, t: ArrayLike) -> Array:
        """Return the attitude of e in i at times t, shape (..., 4); the frames agree at t = 0."""
        half = 0.5 * self.rate * np.asarray(t, dtype=float)
        zero = np.zeros(half.shape)
        return np.stack([np.cos(half), zero, zero, np.sin(half)], axis=-1)

    @property
    def omega_ie(self) -> Array:
        """omega_ie in e (and in i), shape (3,), rad/s."""
        return np.array([0.0, 0.0, self.rate])

    def omega_ie_n(self, latitude: ArrayLike) -> Array:
        """Return omega_ie in n, shape (..., 3), rad/s."""
        latitude = np.asarray(latitude, dtype=float)
        return np.stack([np.zeros(latitude.shape), self.rate * np.cos(latitude), self.rate * np.sin(latitude)], axis=-1)

    def omega_en_n(self, latitude: ArrayLike, height: ArrayLike, v_n: ArrayLike) -> Array:
        """Return the rate of n in e caused by v_n (east, north, up), shape (..., 3), rad/s; not defined at the poles."""
        east, north, _ = np.moveaxis(np.asarray(v_n, dtype=float), -1, 0)
        R_M, R_N = self.radii(latitude)
        rho = east / (R_N + height)
        return np.stack([-north / (R_M + height), rho, rho * np.tan(latitude)], axis=-1)

    def gravitation(self, r_e: ArrayLike) -> Array:
        """Return the gravitation G in e at positions r_e, shape (..., 3), m/s^2."""
        from bench.earth_kernels import gravitations

        r_e = np.asarray(r_e, dtype=float)
        rows = require_array("r_e", r_e.reshape(-1, 3), (None, 3))
        return np.asarray(gravitations(self.parameters, rows.copy())).reshape(r_e.shape)

    def gravity(self, r_e: ArrayLike) -> Array:
        """Return gravity g = G - omega_ie x (omega_ie x r) in e, shape (..., 3), m/s^2."""
        r_e = np.asarray(r_e, dtype=float)
        return self.gravitation(r_e) + self.rate**2 * r_e * np.array([1.0, 1.0, 0.0])


# GM and J2: J2 follows from the four defining parameters of the ellipsoid ([HM], Eq. 2-90).
WGS84 = Earth("wgs84", 6378137.0, 1 / 298.257223563, 3.986004418e14, 7.292115e-5, 1.082629821313e-3, "j2", WGS84_REPORT)
WGS84_NORMAL = Earth(
    "wgs84-normal", 6378137.0, 1 / 298.257223563, 3.986004418e14, 7.292115e-5, 1.082629821313e-3, "normal", WGS84_REPORT
)
SPHERE = Earth("sphere", 6371000.0, 0.0, 3.986004418e14, 7.292115e-5, 0.0, "j2", ZHAO)

_ALL = {earth.name: earth for earth in (WGS84, WGS84_NORMAL, SPHERE)}


def earths() -> dict[str, Earth]:
    """Return the Earth models that come with the package, by name."""
    return dict(_ALL)


def earth(name: str) -> Earth:
    """Return an Earth model by name.

    Raises
    ------
    UnknownNameError
        If there is none of that name; it lists the names.
    """
    return _ALL[require_choice("Earth model", name, _ALL)]
