"""Earth models: published derived values, and mpmath and pymap3d as independent implementations."""

import dataclasses

import numpy as np
import pymap3d
import pytest

from bench import earth_kernels
from bench.earth import SPHERE, WGS84, WGS84_NORMAL, Earth, earth, earths
from bench.errors import InputError, UnknownNameError
from bench.rotation import matrix_from_quat, quat_conjugate, quat_multiply, quat_rotate, rotvec_from_quat
from tests import earth_reference as reference
from tests.earth_reference import mp

HEIGHTS = (-10e3, 0.0, 8848.0, 400e3, 20.2e6, 35786e3, 100e6)  # m
ELLIPSOID = pymap3d.Ellipsoid(WGS84.semi_major_axis, WGS84.semi_minor_axis)
GRID = np.array([0.0, 1e-9, 0.1, np.pi / 4, 1.2, np.pi / 2 - 1e-12, np.pi / 2])  # rad
LATITUDES = np.concatenate([-GRID[:0:-1], GRID])


def points(height, n=150, seed=0):
    """Return geodetic positions all over the Earth, special latitudes and longitudes first."""
    rng = np.random.default_rng(seed)
    latitude = np.concatenate([LATITUDES, np.arcsin(rng.uniform(-1, 1, n))])
    longitude = rng.uniform(-np.pi, np.pi, len(latitude))
    longitude[:4] = 0.0, np.pi, np.pi / 2, -np.pi / 2
    return latitude, longitude, np.full(len(latitude), height)


# --- the numbers of the models


@pytest.mark.parametrize(
    ("derived", "published", "digit"),
    [
        # NIMA TR8350.2, tables 3.3 and 3.4: within a unit of the last printed digit.
        (lambda e: e.semi_minor_axis, 6356752.3142, 1e-4),
        (lambda e: e.eccentricity_squared, 6.69437999014e-3, 1e-14),
        (lambda e: np.sqrt(e.eccentricity_squared) * e.semi_major_axis, 5.2185400842339e5, 1e-8),
        (lambda e: e.radii(np.pi / 2)[0], 6399593.6258, 1e-4),
        (lambda e: (2 * e.semi_major_axis + e.semi_minor_axis) / 3, 6371008.7714, 1e-4),
        (lambda e: np.cbrt(e.semi_major_axis**2 * e.semi_minor_axis), 6371000.7900, 1e-4),
        (lambda e: e.normal_gravity(0.0), 9.7803253359, 1e-10),
        (lambda e: e.normal_gravity(np.pi / 2), 9.8321849378, 1e-10),
        (lambda e: e.rate**2 * e.semi_major_axis**2 * e.semi_minor_axis / e.GM, 0.00344978650684, 1e-14),
        (lambda e: e.J2 / np.sqrt(5), 0.484166774985e-3, 1e-15),
    ],
)
@pytest.mark.parametrize("model", [WGS84, WGS84_NORMAL])
def test_wgs84_gives_the_published_derived_values(model, derived, published, digit):
    assert abs(float(derived(model)) - published) <= digit


def test_mean_normal_gravity_is_the_published_one():
    # Weighted by the area of the ellipsoid, 32 Gauss-Legendre nodes in sin L; TR8350.2 table 3.4: 9.7976432222.
    sine, weight = np.polynomial.legendre.leggauss(32)
    area = weight / (1 - WGS84.eccentricity_squared * sine**2) ** 2
    assert abs((area * WGS84.normal_gravity(np.arcsin(sine))).sum() / area.sum() - 9.7976432222) < 1e-10


@pytest.mark.parametrize("model", [WGS84, WGS84_NORMAL])
def test_j2_follows_from_the_defining_parameters(model):
    a, e2, GM, rate, J2 = reference.numbers(model)
    second = mp.sqrt(e2 / (1 - e2))
    m = rate**2 * a**3 * mp.sqrt(1 - e2) / GM
    derived = e2 / 3 * (1 - 2 * m * second / (15 * reference.q_function(1 / second)))  # Heiskanen, Moritz, Eq. 2-90
    assert abs(float(J2 / derived) - 1) < 1e-12  # 13 digits are written down


def test_models_are_found_by_name_frozen_and_sourced():
    assert set(earths()) == {"wgs84", "wgs84-normal", "sphere"}
    for name, model in earths().items():
        assert earth(name) is model
        assert str(model.source)
        with pytest.raises(dataclasses.FrozenInstanceError):
            model.GM = 1.0
    with pytest.raises(UnknownNameError, match=r"unknown Earth model 'wgs48' \(did you mean 'wgs84'\?\)"):
        earth("wgs48")


# --- gravity


@pytest.mark.parametrize(("model", "potential"), [(WGS84, "j2"), (WGS84_NORMAL, "normal"), (SPHERE, "j2")])
def test_gravitation_is_the_gradient_of_the_potential(model, potential):
    potential = {"j2": reference.j2_potential, "normal": reference.normal_potential}[potential]
    for height in (-10e3, 0.0, 1e6, 1e8):
        r = model.position(np.array([0.0, 0.7, -1.3, np.pi / 2]), np.array([0.3, 2.0, -2.5, 0.0]), height)
        r[-1, :2] = 0.0  # the axis itself
        for row, found in zip(r, model.gravitation(r), strict=True):
            truth = np.array([float(value) for value in reference.gradient(potential, model, row)])
            # A few roundings.
            np.testing.assert_allclose(found, truth, rtol=0, atol=1e-15 * np.linalg.norm(truth))


def test_normal_gravity_on_the_ellipsoid_is_somiglianas():
    # Somigliana's closed formula with the published constants of TR8350.2 (11 digits).
    sine2 = np.sin(LATITUDES) ** 2
    published = 9.7803253359 * (1 + 0.00193185265241 * sine2) / np.sqrt(1 - 6.69437999014e-3 * sine2)
    np.testing.assert_allclose(WGS84.normal_gravity(LATITUDES), published, rtol=0, atol=1e-10)


def test_the_ellipsoid_is_a_level_surface_of_normal_gravity_and_nearly_of_j2():
    g_n = WGS84_NORMAL.gravity_n(LATITUDES, 0.0)
    np.testing.assert_allclose(g_n[:, :2], 0.0, rtol=0, atol=1e-14)  # a rounding of g
    np.testing.assert_allclose(-g_n[:, 2], WGS84_NORMAL.normal_gravity(LATITUDES), rtol=1e-15, atol=0)
    # J2 lacks the fourth harmonic: it tilts the plumb line by some 5e-6 rad at middle latitudes.
    tilt = np.abs(WGS84.gravity_n(LATITUDES, 0.0)[:, 1]).max() / 9.8
    assert 1e-6 < tilt < 1e-5
    # Above the ellipsoid the normal plumb line is curved: by the textbook's 8.3e-7 sin 2L a kilometre.
    g_n = WGS84_NORMAL.gravity_n(np.pi / 4, 1000.0)
    assert g_n[1] / g_n[2] == pytest.approx(8.3e-7, rel=0.02)


def test_height_dependence_agrees_with_the_free_air_expansion():
    # Heiskanen and Moritz, Eq. 2-123: second order in h/a, so at 10 km the rest is 4 (h/a)^3 = 1.5e-8.
    a, f = WGS84.semi_major_axis, WGS84.flattening
    m = 0.00344978650684
    sine2, h = np.sin(LATITUDES) ** 2, 10e3
    expansion = 1 - 2 / a * (1 + f + m - 2 * f * sine2) * h + 3 / a**2 * h**2
    ratio = WGS84.normal_gravity(LATITUDES, h) / WGS84.normal_gravity(LATITUDES)
    np.testing.assert_allclose(ratio, expansion, rtol=0, atol=1e-7)  # f^2 (h/a) is 2e-8 as well


@pytest.mark.parametrize("height", [0.0, 1e6, 2e7])
def test_the_two_fields_differ_by_the_higher_harmonics_only(height):
    # J4 = -2.3709e-6 of the level ellipsoid (Heiskanen, Moritz, Eq. 2-92); largest at the poles, 5 |J4| GM/r^2 (a/r)^4.
    e2, J2, a = WGS84.eccentricity_squared, WGS84.J2, WGS84.semi_major_axis
    J4 = -3 * e2**2 / 35 * (-1 + 10 * J2 / e2)
    assert pytest.approx(-2.37091e-6, rel=1e-5) == J4
    latitude, longitude, height = points(height)
    r = WGS84.position(latitude, longitude, height)
    difference = np.linalg.norm(WGS84_NORMAL.gravitation(r) - WGS84.gravitation(r), axis=1)
    distance = np.linalg.norm(r, axis=1)
    bound = 5 * abs(J4) * WGS84.GM / distance**2 * (a / distance) ** 4
    assert (difference <= 1.02 * bound).all()  # J6 is 6e-9
    assert (difference / bound).max() > 0.98


@pytest.mark.parametrize("model", [WGS84, WGS84_NORMAL, SPHERE])
def test_fields_are_harmonic(model):
    # Trace of the gradient by central differences: rounding 1e-15 r/step, and truncation (step/r)^2, of each term.
    r, step = model.position(np.array([0.2, 0.9]), np.array([0.5, -2.0]), 1e4), 2e3
    parts = [
        (model.gravitation(r + step * axis)[:, k] - model.gravitation(r - step * axis)[:, k]) / (2 * step)
        for k, axis in enumerate(np.eye(3))
    ]
    assert (np.abs(sum(parts)) < 2e-6 * np.abs(parts).max(axis=0)).all()


def test_sphere_attracts_like_a_point():
    r = np.array([[7e6, 0, 0], [0, -1e7, 1e6]])
    square = (r * r).sum(axis=1, keepdims=True)
    np.testing.assert_allclose(SPHERE.gravitation(r), -SPHERE.GM * r / square**1.5, rtol=1e-15)
    np.testing.assert_allclose(
        SPHERE.gravity(r) - SPHERE.gravitation(r), SPHERE.rate**2 * r * [1, 1, 0], rtol=0, atol=2e-15
    )


# --- geodetic conversions


def test_published_example_of_a_conversion():
    # IOGP Guidance Note 373-7-2 (EPSG 9602), printed to 1 mm and 0.001 arcsec (31 mm).
    latitude, longitude = np.radians([53 + 48 / 60 + 33.820 / 3600, 2 + 7 / 60 + 46.380 / 3600])
    r = WGS84.position(latitude, longitude, 73.0)
    np.testing.assert_allclose(r, [3771793.968, 140253.342, 5124304.349], rtol=0, atol=0.016)


@pytest.mark.parametrize("height", HEIGHTS)
@pytest.mark.parametrize("model", [WGS84, SPHERE])
def test_position_is_right_to_its_rounding(model, height):
    latitude, longitude, h = points(height)
    ulp = np.spacing(model.semi_major_axis + height)
    for *where, found in zip(latitude, longitude, h, model.position(latitude, longitude, h), strict=True):
        error = [abs(float(mp.mpf(f) - t)) for f, t in zip(found, reference.position(model, *where), strict=True)]
        assert max(error) <= 0.53 * ulp  # at the ground 5e-10 m, at 100 000 km 8e-9 m: half a unit is the rounding


@pytest.mark.parametrize("height", [*HEIGHTS, -5e6])
@pytest.mark.parametrize("model", [WGS84, SPHERE])
def test_geodetic_is_right_to_the_rounding_of_its_results(model, height):
    latitude, longitude, h = points(height)
    r = model.position(latitude, longitude, h)
    r[0], r[1] = [0.0, 0.0, r[0, 2]], [0.0, 0.0, -r[0, 2]]  # the axis itself
    distance = np.linalg.norm(r, axis=1)
    for row, far, *found in zip(r, distance, *model.geodetic(r), strict=True):
        error = [abs(float(mp.mpf(f) - t)) for f, t in zip(found, reference.geodetic(model, row), strict=True)]
        # Half a unit of the last place of each result, and 2e-11 m (2e-18 of the distance) for the computation.
        assert error[0] * far <= 0.5 * np.spacing(abs(found[0])) * far + 2e-11
        assert error[1] <= 0.53 * np.spacing(abs(found[1]))
        assert error[2] <= 0.51 * np.spacing(abs(found[2])) + 2e-11


@pytest.mark.parametrize("height", HEIGHTS)
def test_round_trip_gives_the_position_back(height):
    r = WGS84.position(*points(height, 20000, seed=1))
    back = WGS84.position(*WGS84.geodetic(r))
    # Half a unit of the angles and of the height, then of the result: at the ground 1.5e-9 m, of which the longitude
    # (up to pi, unit 4.4e-16 rad) has the most.
    bound = 1.2e-9 + 2.4e-16 * (6.4e6 + height)
    assert np.linalg.norm(back - r, axis=1).max() <= bound


@pytest.mark.parametrize("height", HEIGHTS)
def test_position_agrees_with_pymap3d(height):
    latitude, longitude, h = points(height)
    theirs = np.stack(pymap3d.geodetic2ecef(latitude, longitude, h, ell=ELLIPSOID, deg=False), axis=-1)
    # They sum up some roundings.
    np.testing.assert_allclose(WGS84.position(latitude, longitude, h), theirs, rtol=0, atol=1e-15 * (6.4e6 + height))


@pytest.mark.parametrize("height", [-10e3, 0.0, 8848.0])
def test_geodetic_agrees_with_pymap3d(height):
    # Their one step (You, 2000) is 4e-11 rad off at 400 km and 1e-6 rad at 20 000 km, and loses digits at the poles.
    latitude, longitude, h = points(height)
    away = np.abs(latitude) < 1.57
    r = WGS84.position(latitude, longitude, h)[away]
    theirs = pymap3d.ecef2geodetic(*r.T, ell=ELLIPSOID, deg=False)
    for ours, other, atol in zip(WGS84.geodetic(r), theirs, (2e-14, 1e-15, 1e-8), strict=True):
        np.testing.assert_allclose(ours, other, rtol=0, atol=atol)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_axis_poles_equator_and_date_line_are_ordinary_points(sign):
    a, b = WGS84.semi_major_axis, WGS84.semi_minor_axis
    assert WGS84.geodetic([0.0, 0.0, sign * (b + 5.0)]) == (sign * np.pi / 2, 0.0, pytest.approx(5.0, abs=1e-9))
    assert WGS84.geodetic([-0.0, -0.0, sign * b])[1] == 0.0
    assert WGS84.geodetic([a + 7.0, 0.0, sign * 0.0]) == (0.0, 0.0, 7.0)
    assert WGS84.geodetic([-a, sign * 0.0, 0.0]) == (0.0, np.pi, 0.0)
    # A nanometre from the axis the longitude is still known.
    assert WGS84.geodetic([0.0, sign * 1e-9, b])[1] == sign * np.pi / 2
    # The double next to pi/2 keeps the longitude in a position 0.4 nm from the axis.
    assert WGS84.geodetic(WGS84.position(sign * np.pi / 2, 2.0, 0.0))[1] == pytest.approx(2.0, abs=1e-15)


def test_kernels_are_the_methods():
    latitude, longitude, h = points(400.0)
    r = WGS84.position(latitude, longitude, h)
    radii, geodetic = np.stack(WGS84.radii(latitude), axis=-1), np.stack(WGS84.geodetic(r), axis=-1)
    for k in range(len(r)):
        p = WGS84.parameters
        np.testing.assert_allclose(earth_kernels.radii(p, latitude[k]), radii[k], rtol=4e-16, atol=0)
        assert earth_kernels.geodetic_position(p, latitude[k], longitude[k], h[k]) == tuple(r[k])
        assert earth_kernels.geodetic(p, *r[k]) == tuple(geodetic[k])
    shaped = WGS84.position(latitude[:4].reshape(2, 2), longitude[0], 0.0)
    assert shaped.shape == (2, 2, 3)
    assert WGS84.geodetic(shaped)[2].shape == WGS84.gravity(shaped).shape[:-1] == (2, 2)


def test_radii_are_those_of_the_position():
    # |d r / d L| = R_M + h, |d r / d lambda| = (R_N + h) cos L.
    def speed(latitude, longitude, height, axis):
        rates = [
            mp.diff(lambda *where, k=k: reference.position(WGS84, *where)[k], (latitude, longitude, height), axis)
            for k in range(3)
        ]
        return float(mp.norm(rates))

    for where in ((0.3, 1.0, 100.0), (-1.2, -2.0, 1e5)):
        R_M, R_N = WGS84.radii(where[0])
        assert speed(*where, (1, 0, 0)) == pytest.approx(R_M + where[2], rel=1e-15)
        assert speed(*where, (0, 1, 0)) == pytest.approx((R_N + where[2]) * np.cos(where[0]), rel=1e-15)


# --- frames


def test_navigation_frame_is_east_north_up():
    latitude, longitude, _ = points(0.0)
    C_en = matrix_from_quat(WGS84.q_en(latitude, longitude))
    for k, unit in enumerate(np.eye(3)):
        theirs = np.stack(pymap3d.enu2uvw(*unit, latitude, longitude, deg=False), axis=-1)
        np.testing.assert_allclose(C_en[..., k], theirs, rtol=0, atol=1e-15)


def test_rates_of_the_frames():
    latitude, longitude, _ = points(0.0)
    q_ne = quat_conjugate(WGS84.q_en(latitude, longitude))
    np.testing.assert_allclose(
        WGS84.omega_ie_n(latitude), quat_rotate(q_ne, WGS84.omega_ie), rtol=0, atol=1e-15 * WGS84.rate
    )
    # In t = 1000 s the Earth turns by omega_ie t about z, from the frame it agrees with.
    np.testing.assert_allclose(rotvec_from_quat(WGS84.q_ie(1000.0)), [0, 0, 7.292115e-2], rtol=1e-15)
    assert WGS84.q_ie(0.0).tolist() == [1.0, 0.0, 0.0, 0.0]
    # omega_en carries q_en along a short way: a quotient of the rotation over 2 s, second order in 1e-6 rad.
    L, h, v_n = 0.8, 1e4, np.array([300.0, -200.0, 50.0])
    R_M, R_N = WGS84.radii(L)
    dL, dlon = v_n[1] / (R_M + h), v_n[0] / ((R_N + h) * np.cos(L))
    before, after = WGS84.q_en([L - dL, L + dL], [-dlon, dlon])
    turned = rotvec_from_quat(quat_multiply(quat_conjugate(before), after)) / 2
    np.testing.assert_allclose(WGS84.omega_en_n(L, h, v_n), turned, rtol=0, atol=1e-12)


# --- bad input


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"semi_major_axis": 0.0}, "semi_major_axis must be a positive number, got 0.0"),
        ({"flattening": -0.1}, "flattening must be a number >= 0, got -0.1"),
        ({"flattening": 298.257}, "flattening must be below 0.01, .* got 298.257"),
        ({"GM": np.nan}, "GM must be finite, a positive number, got nan"),
        ({"rate": "fast"}, "rate must be a number, got 'fast'"),
        ({"J2": np.inf}, "J2 must be finite"),
        ({"field": "egm96"}, "unknown field 'egm96'.*valid: j2, normal"),
    ],
)
def test_bad_models_are_refused(change, message):
    with pytest.raises(InputError, match=message):
        dataclasses.replace(WGS84, **change)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: WGS84.position(45.0, 0.0, 0.0), r"latitude must be within \+-pi/2 rad, got 45 \(degrees\?\)"),
        (lambda: WGS84.position(0.1, np.nan, 0.0), "longitude must be finite"),
        (lambda: WGS84.position(0.1, 0.0, "high"), "height must be an array of real numbers"),
        (lambda: WGS84.radii([0.1, -2.0]), r"latitude must be within \+-pi/2 rad, got 2 "),
        (lambda: WGS84.q_en(2.0, 0.0), "latitude must be within"),
        (lambda: WGS84.omega_ie_n(2.0), "latitude must be within"),
        (lambda: WGS84.geodetic([1.0, 2.0]), r"r_e must have shape \(..., 3\), got \(2,\)"),
        (lambda: WGS84.geodetic([np.nan, 0.0, 7e6]), "r_e must be finite"),
        (lambda: WGS84.geodetic([6378.0, 0.0, 0.0]), "r_e must be at least 637814 m from the Earth's centre, got 6378"),
        (lambda: WGS84.gravitation([0.0, 0.0, 0.0]), "r_e must be at least 637814 m"),
        (lambda: Earth("x", 1.0, 0.0, 1.0, 0.0, 0.0, "J2", WGS84.source), "unknown field 'J2'"),
    ],
)
def test_bad_arguments_are_refused(call, message):
    with pytest.raises(InputError, match=message):
        call()
