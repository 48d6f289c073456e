"""How the error states of a damping filter are shown: units of tables, titles and scales of figures; arrays only."""

from dataclasses import dataclass

from bench.units import ARCMIN, DEG_PER_H, MICRO_G


@dataclass(frozen=True)
class ShownState:
    """One state: its unit in a table's column, its title with the unit in which it is drawn, and that unit in SI."""

    column: str
    title: str
    scale: float


SHOWN = (
    *(ShownState(f"dv_{k}_m_per_s", f"velocity error {name}, m/s", 1.0) for k, name in (("E", "east"), ("N", "north"))),
    ShownState("dL_rad", "latitude error, arcmin", ARCMIN),
    ShownState("dlambda_rad", "longitude error, arcmin", ARCMIN),
    *(
        ShownState(f"phi_{k}_rad", f"phi about {name}, arcmin", ARCMIN)
        for k, name in (("E", "east"), ("N", "north"), ("U", "up"))
    ),
    *(ShownState(f"nabla_{k}_m_per_s2", f"accelerometer error {k}, micro-g", MICRO_G) for k in "xyz"),
    *(ShownState(f"eps_{k}_rad_per_s", f"eps {k} (minus the gyro's error), deg/h", DEG_PER_H) for k in "xyz"),
    *(
        ShownState(f"reference_{k}_m_per_s", f"error of the reference {name}, m/s", 1.0)
        for k, name in (("E", "east"), ("N", "north"))
    ),
)

SHARES = {  # of the fusion: states by group and name
    "position": {"latitude": 2, "longitude": 3},
    "velocity": {"east": 0, "north": 1},
    "attitude": {"phi_E": 4, "phi_N": 5, "phi_U": 6},
    "accelerometer errors": {"nabla_x": 7, "nabla_y": 8, "nabla_z": 9},
    "gyro errors": {"eps_x": 10, "eps_y": 11, "eps_z": 12},
}
