"""How values of the bench are typed on the command line: an Earth by its name, noise models with units in the names."""

from dataclasses import replace
from typing import Any

import tyro

from bench.earth import Earth, earth, earths
from bench.solvers.damping import DampingModel
from bench.units import ARCMIN, ARCSEC, DEG_PER_H, DEG_PER_SQRT_H, MICRO_G

REGISTRY = tyro.constructors.ConstructorRegistry()
# Option, unit in its name, that unit in SI, help.
NOISES = (
    ("velocity", "m_per_s", 1.0, "Initial standard deviation, east and north."),
    ("position", "arcsec", ARCSEC, "Initial standard deviation of latitude and of longitude."),
    ("tilt", "arcmin", ARCMIN, "Initial standard deviation about east and about north."),
    ("heading", "arcmin", ARCMIN, "Initial standard deviation of the heading."),
    ("accelerometer_bias", "micro_g", MICRO_G, "Initial standard deviation of the accelerometers' errors."),
    ("gyro_bias", "deg_per_h", DEG_PER_H, "Initial standard deviation of the gyros' errors."),
    ("accelerometer_drift", "micro_g", MICRO_G, "Standard deviation to which the accelerometers' errors drift."),
    ("gyro_drift", "deg_per_h", DEG_PER_H, "Standard deviation to which the gyros' errors drift."),
    ("tau_f", "s", 1.0, "Correlation time of the accelerometers' errors."),
    ("tau_g", "s", 1.0, "Correlation time of the gyros' errors."),
    ("velocity_noise", "micro_g_per_sqrt_hz", MICRO_G, "White noise of the accelerometers."),
    ("attitude_noise", "deg_per_sqrt_h", DEG_PER_SQRT_H, "White noise of the gyros: angle random walk."),
    ("reference_noise", "m_per_s", 1.0, "Standard deviation of the external velocity, east and north."),
)


@REGISTRY.primitive_rule
def _earth_by_name(info: Any) -> Any:
    """Take an Earth model by its name."""
    if info.type is not Earth:
        return None
    return tyro.constructors.PrimitiveConstructorSpec(
        nargs=1,
        metavar="{" + ",".join(earths()) + "}",
        instance_from_str=lambda words: earth(words[0]),
        is_instance=lambda value: isinstance(value, Earth),
        str_from_instance=lambda value: [value.name],
    )


@REGISTRY.struct_rule
def _noises_with_units(info: Any) -> Any:
    """Take the noise model of a damping filter in the units of its options' names."""
    if info.type is not DampingModel:
        return None
    model = info.default if isinstance(info.default, DampingModel) else DampingModel()
    options = {f"{name}_{unit}": (name, size, text) for name, unit, size, text in NOISES}
    defaults = {option: float(f"{getattr(model, name) / size:.9g}") for option, (name, size, _) in options.items()}

    def made(**values: float) -> DampingModel:
        # What is not changed keeps all its digits.
        changed = {option: value for option, value in values.items() if value != defaults[option]}
        changed = {options[option][0]: value * options[option][1] for option, value in changed.items()}
        return replace(model, **changed)

    return tyro.constructors.StructConstructorSpec(
        instantiate=made,
        fields=tuple(
            tyro.constructors.StructFieldSpec(option, float, defaults[option], text)
            for option, (_, _, text) in options.items()
        ),
    )
