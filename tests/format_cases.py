"""What the tests of the file formats share: a simulated recording, its truth, and options for every format."""

from functools import cache

import numpy as np

import bench
from bench.motion.fast_vehicle import FastVehicle
from bench.recording import Recording

MOTION = FastVehicle()
RATE = 100.0
CSV = {
    "axes": "FLU",
    "columns": "t,gx,gy,gz,ax,ay,az",
    "time_unit": "s",
    "angular_unit": "rad",
    "specific_unit": "m/s",
    "reference_columns": "t,lat,lon,h,vn,ve,vd,roll,pitch,heading",
    "angle_unit": "rad",
}
PLACE = {"origin_latitude_deg": 45.0, "origin_longitude_deg": 126.0, "origin_height": 2e4, "x_azimuth_deg": 30.0}
OPTIONS = {
    "csv": CSV,
    "euroc": {"axes": "FLU", **PLACE},
    "kf-gins": {},
    "psins-imu": {},
    "psins-mat": {"imu": "imu", "avp": "avp", "kind": "increments"},
}
RATES = {  # the same formats for rates, where there is a difference
    "csv": {**CSV, "angular_unit": "rad/s", "specific_unit": "m/s^2"},
    "psins-mat": {**OPTIONS["psins-mat"], "kind": "rates"},
}


@cache
def simulated():
    """One second of a fast vehicle as MuJoCo senses it: a recording of increments."""
    return Recording.from_increments(bench.Rig.load("imu", threads=1).increments(MOTION, RATE, 1.0))


@cache
def truth():
    return MOTION.trajectory(simulated().t)


def increments_through(name):
    """What is written in a format, and what turns it back into increments."""
    recording = simulated()
    if name == "euroc":
        return recording.as_mean_rates(), "average"
    return recording, None


def rows(n=40, start=100.0, rate=100.0):
    """Cells of a KF-GINS file: a vehicle at rest that turns a little; z points down."""
    t = start + np.arange(n) / rate
    return [[repr(float(stamp)), "1e-3", "2e-3", "-3e-3", "0.01", "0.02", "-0.0981"] for stamp in t]


def write_rows(path, cells, delimiter=" ", head=()):
    path.write_text("".join(line + "\n" for line in (*head, *map(delimiter.join, cells))))
    return path
