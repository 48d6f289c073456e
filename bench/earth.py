"""Earth models: ellipsoid, rotation rate and gravitation, each frozen and with its source.

Frames: e is Earth-fixed (x through latitude 0, longitude 0; z along the axis), n is east-north-up at a geodetic
position, i does not turn and agrees with e at t = 0. Gravitation G is the attraction alone; gravity
g = G - omega_ie x (omega_ie x r) is what a plumb line feels. Kernels on scalars are in ``bench.earth_kernels``.

References
----------
[WGS84] NIMA TR8350.2, Department of Defense World Geodetic System 1984, 3rd edition, 2000.
[HM] Heiskanen, Moritz: Physical Geodesy, 1967, sections 2-7 to 2-10.
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from bench.errors import Array, InputError, require_array, require_choice, require_scalar
from bench.references import WGS84_REPORT, ZHAO, Source
from bench.rotation import quat_multiply

FIELDS = ("j2", "normal")


def _require_real(name: str, value: ArrayLike) -> Array:
    """Return finite numbers of any shape."""
    return require_array(name, np.reshape(value, -1), (None,)).reshape(np.shape(value))


def require_latitude(latitude: ArrayLike) -> Array:
    """Return latitudes of any shape, rad.

    Raises
    ------
    InputError
        If one is not finite or exceeds pi/2.
    """
    array = _require_real("latitude", latitude)
    if (largest := np.abs(array).max()) > np.pi / 2:
        raise InputError(f"latitude must be within +-pi/2 rad, got {largest:.6g} (degrees?)")
    return array


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
        if require_scalar("flattening", self.flattening, minimum=0.0) >= 0.01:
            raise InputError(
                f"flattening must be below 0.01, where the series in use converge, got {self.flattening!r}"
            )
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
        """Polar radius b = a (1 - f), m."""
        return self.semi_major_axis * (1.0 - self.flattening)

    @cached_property
    def parameters(self) -> Array:
        """What kernels need: a, e^2, GM, omega_ie, J2, field (0 J2, 1 normal); do not write into it."""
        field = float(FIELDS.index(self.field))
        return np.array([self.semi_major_axis, self.eccentricity_squared, self.GM, self.rate, self.J2, field])

    def radii(self, latitude: ArrayLike) -> tuple[Array, Array]:
        """Return the radii of curvature R_M (meridian) and R_N (prime vertical) at geodetic latitudes, m."""
        w2 = 1.0 - self.eccentricity_squared * np.sin(require_latitude(latitude)) ** 2
        R_N = self.semi_major_axis / np.sqrt(w2)
        return R_N * (1.0 - self.eccentricity_squared) / w2, R_N

    def position(self, latitude: ArrayLike, longitude: ArrayLike, height: ArrayLike) -> Array:
        """Return r_e, shape (..., 3), m, of geodetic positions, rad and m.

        Little is lost but the rounding of the result: 5e-10 m a coordinate at the ground, 8e-9 m at 100 000 km.
        """
        from bench.earth_kernels import geodetic_positions

        values = (require_latitude(latitude), _require_real("longitude", longitude), _require_real("height", height))
        rows = np.stack(np.broadcast_arrays(*values), axis=-1)
        return np.asarray(geodetic_positions(self.parameters, rows.reshape(-1, 3))).reshape(rows.shape)

    def geodetic(self, r_e: ArrayLike) -> tuple[Array, Array, Array]:
        """Return latitude, longitude (rad) and height (m) of r_e, shape (..., 3), m.

        Longitude is in (-pi, pi], and 0 on the axis. From 5000 km below the ellipsoid upwards, poles and axis
        included, little is lost but the rounding of the results: at the ground 2e-11 m of height, 1e-9 m sideways; the
        same angles at 100 000 km mean 1e-8 m.

        Raises
        ------
        InputError
            If r_e has another shape, is not finite, or within a tenth of the semi-major axis of the centre.
        """
        from bench.earth_kernels import geodetics

        rows = self._require_positions(r_e)
        found = np.asarray(geodetics(self.parameters, rows)).reshape(np.shape(r_e))
        return found[..., 0], found[..., 1], found[..., 2]

    def _require_positions(self, r_e: ArrayLike) -> Array:
        """Return r_e as rows, shape (n, 3)."""
        if np.shape(r_e)[-1:] != (3,):
            raise InputError(f"r_e must have shape (..., 3), got {np.shape(r_e)}")
        rows = require_array("r_e", np.reshape(r_e, (-1, 3)), (None, 3))
        least = np.sqrt((rows * rows).sum(axis=1).min())
        if least < 0.1 * self.semi_major_axis:
            raise InputError(
                f"r_e must be at least {0.1 * self.semi_major_axis:g} m from the Earth's centre, got {least:g} m "
                "(kilometres, or a position relative to the ground?)"
            )
        return rows

    def q_en(self, latitude: ArrayLike, longitude: ArrayLike) -> Array:
        """Return the attitude of n (east-north-up) in e, shape (..., 4): q_z(lambda + pi/2) o q_x(pi/2 - L)."""
        latitude, longitude = np.broadcast_arrays(require_latitude(latitude), _require_real("longitude", longitude))
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
        latitude = require_latitude(latitude)
        return np.stack([np.zeros(latitude.shape), self.rate * np.cos(latitude), self.rate * np.sin(latitude)], axis=-1)

    def omega_en_n(self, latitude: ArrayLike, height: ArrayLike, v_n: ArrayLike) -> Array:
        """Return the rate of n in e caused by v_n (east, north, up), shape (..., 3), rad/s; infinite at the poles."""
        height = np.asarray(height, dtype=float)
        east, north, _ = np.moveaxis(np.asarray(v_n, dtype=float), -1, 0)
        R_M, R_N = self.radii(latitude)
        rho = east / (R_N + height)
        return np.stack([-north / (R_M + height), rho, rho * np.tan(latitude)], axis=-1)

    def gravitation(self, r_e: ArrayLike) -> Array:
        """Return the gravitation G in e at positions r_e, shape (..., 3), m/s^2.

        Raises
        ------
        InputError
            As `geodetic`.
        """
        from bench.earth_kernels import gravitations

        return np.asarray(gravitations(self.parameters, self._require_positions(r_e))).reshape(np.shape(r_e))

    def gravity(self, r_e: ArrayLike) -> Array:
        """Return gravity g = G - omega_ie x (omega_ie x r) in e, shape (..., 3), m/s^2."""
        return self.gravitation(r_e) + self.rate**2 * np.asarray(r_e, dtype=float) * np.array([1.0, 1.0, 0.0])

    def gravity_n(self, latitude: ArrayLike, height: ArrayLike) -> Array:
        """Return gravity in n (east, north, up) at geodetic positions, shape (..., 3), m/s^2; east is 0."""
        g_e = self.gravity(self.position(latitude, 0.0, height))
        sine, cosine = np.sin(latitude), np.cos(latitude)
        north = g_e[..., 2] * cosine - g_e[..., 0] * sine
        return np.stack([np.zeros(north.shape), north, g_e[..., 0] * cosine + g_e[..., 2] * sine], axis=-1)

    def normal_gravity(self, latitude: ArrayLike, height: ArrayLike = 0.0) -> Array:
        """Return the magnitude of normal gravity, m/s^2, whatever `field` is.

        The exact one, closed in the height; Somigliana's formula at height 0 ([HM], Eq. 2-78).
        """
        return np.asarray(np.linalg.norm(replace(self, field="normal").gravity_n(latitude, height), axis=-1))


# J2 follows from the four defining parameters of the level ellipsoid ([HM], Eq. 2-90).
WGS84 = Earth("wgs84", 6378137.0, 1 / 298.257223563, 3.986004418e14, 7.292115e-5, 1.082629821313e-3, "j2", WGS84_REPORT)
WGS84_NORMAL = Earth(
    "wgs84-normal", 6378137.0, 1 / 298.257223563, 3.986004418e14, 7.292115e-5, 1.082629821313e-3, "normal", WGS84_REPORT
)
# The error model of [Zhao] is of a sphere; its radius is not stated: the mean one, and GM and rate as above.
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
