"""What is drawn, and how large: the shapes and sites of one body of a compiled MJCF model, and sizes of a scene.

Reads the arrays of a `mujoco.MjModel` that the caller passes in; neither MuJoCo nor
a viewer is imported, so that any backend can draw the same instrument.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from bench.errors import Array, InputError
from bench.rotation import quat_multiply, quat_rotate

# MuJoCo's geom type numbers (mjtGeom); a height field cannot move with a body and is not drawn.
PLANE, SPHERE, CAPSULE, ELLIPSOID, CYLINDER, BOX, MESH = 0, 2, 3, 4, 5, 6, 7
SENSES_MOTION = (1, 3)  # mjSENS_ACCELEROMETER, mjSENS_GYRO
DEFAULT_RGBA = np.array([0.5, 0.5, 0.5, 1.0], dtype=np.float32)
SHOWN_GROUPS = 3  # MuJoCo's viewer shows the groups 0, 1 and 2
PLANE_THICKNESS = 1e-3  # m
UNBOUNDED = 1.0  # m, half size of a plane without one


@dataclass(frozen=True, eq=False)
class Shape:
    """One primitive or mesh of a body.

    Attributes
    ----------
    kind : str
        ``box``, ``ellipsoid``, ``cylinder``, ``capsule`` or ``mesh``.
    size : tuple of float, m
        box, ellipsoid: three half sizes; cylinder, capsule: radius and half length along z; mesh: empty.
    position : ndarray, shape (3,), m
    quat : ndarray, shape (4,), wxyz
        Shape to body.
    rgba : tuple of float
        Between 0 and 1.
    mesh : int
        Number of the mesh, for `mesh_triangles`; -1 for a primitive.
    """

    kind: str
    size: tuple[float, ...]
    position: Array
    quat: Array
    rgba: tuple[float, ...]
    mesh: int = -1


@dataclass(frozen=True)
class Scene:
    """Sizes that make both a small instrument and its long path visible.

    Attributes
    ----------
    arm : float, m
        Distance of the farthest part of the instrument from its origin.
    enlarged : float
        Scale of the instrument in the view of the world; at least 1.
    force_scale : float, m per m/s^2
        Length of the arrows of specific force on the instrument in true size.
    centre : tuple of float, m
        What the view of the world looks at.
    extent : float, m
        Radius around the centre that it shows.
    """

    arm: float
    enlarged: float
    force_scale: float
    centre: tuple[float, ...]
    extent: float

    @classmethod
    def of(cls, *, parts: Array, path: Array, others: Sequence[Array], strongest: float) -> "Scene":
        """Return the sizes for one run.

        Parameters
        ----------
        parts : ndarray, shape (k, 3), m
            Parts of the instrument, in its frame.
        path : ndarray, shape (n, 3), m
            The true path.
        others : sequence of ndarray, shape (n, 3), m
            Estimated paths.
        strongest : float, m/s^2
            The largest reading.
        """
        arm = max(0.05, float(np.linalg.norm(parts, axis=1).max()))
        low, high = path.min(axis=0), path.max(axis=0)
        radius = max(3.0 * arm, 0.5 * float(np.linalg.norm(high - low)))
        # Estimates that stay near are shown whole; one that runs away does not make all others small.
        near = [p[np.linalg.norm(p - 0.5 * (low + high), axis=1) < 2.0 * radius] for p in others]
        shown = np.concatenate([path, *near])
        low, high = shown.min(axis=0), shown.max(axis=0)
        return cls(
            arm=arm,
            enlarged=max(1.0, round_down(0.25 * radius / arm)),
            force_scale=round_down(1.2 * arm / max(strongest, 1e-9)),
            centre=tuple((0.5 * (low + high)).tolist()),
            extent=max(radius, 0.5 * float(np.linalg.norm(high - low))),
        )


def round_down(value: float) -> float:
    """Return the largest of 1, 2, 5 times a power of ten that does not exceed value > 0."""
    power = 10.0 ** np.floor(np.log10(value))
    return float(max(m * power for m in (1.0, 2.0, 5.0) if m * power <= value * (1 + 1e-12)))


def instrumented_body(model: Any) -> int:
    """Return the number of the body that carries the model's first accelerometer or gyro.

    Raises
    ------
    InputError
        If there is no such sensor.
    """
    sensing = np.flatnonzero(np.isin(model.sensor_type, SENSES_MOTION))
    if len(sensing) == 0:
        raise InputError("model must have an <accelerometer> or a <gyro>, got none")
    return int(model.site_bodyid[model.sensor_objid[sensing[0]]])


def body_shapes(model: Any, body: int, *, below: bool = True) -> tuple[Shape, ...]:
    """Return the visible shapes of a body and, unless told otherwise, of those below it in the model's reference pose.

    Parameters
    ----------
    model : mujoco.MjModel
    body : int
        Number of the body; its frame is that of the result.
    below : bool
        Whether the bodies below it belong to it; not if they move against it.
    """
    shapes = []
    for k in range(model.ngeom):
        if not below and model.geom_bodyid[k] != body:
            continue
        shape = _shape(model, k)
        placed = None if shape is None else _place(model, int(model.geom_bodyid[k]), body, shape)
        if placed is not None and model.geom_group[k] < SHOWN_GROUPS:
            shapes.append(placed)
    return tuple(shapes)


def body_sites(model: Any, body: int) -> tuple[tuple[str, ...], Array]:
    """Return labels and positions (s, 3), m, of a body's named sites; sites at one place share a label."""
    found: dict[tuple[float, ...], list[str]] = {}
    for k in range(model.nsite):
        if model.site_bodyid[k] == body and model.site(k).name:
            found.setdefault(tuple(model.site_pos[k].tolist()), []).append(model.site(k).name)
    return tuple(", ".join(names) for names in found.values()), np.array(list(found)).reshape(-1, 3)


def mesh_triangles(model: Any, mesh: int) -> tuple[Array, Array]:
    """Return the corners and their normals of a mesh, shape (3 f, 3) each, three rows a triangle."""
    faces = slice(model.mesh_faceadr[mesh], model.mesh_faceadr[mesh] + model.mesh_facenum[mesh])
    corners = model.mesh_face[faces].ravel() + model.mesh_vertadr[mesh]
    normals = model.mesh_facenormal[faces].ravel() + model.mesh_normaladr[mesh]
    return model.mesh_vert[corners], model.mesh_normal[normals]


def _shape(model: Any, k: int) -> Shape | None:
    """Return geom k in the frame of its own body, or None if it is of a kind that is not drawn."""
    kind, (a, b, c) = int(model.geom_type[k]), (float(s) for s in model.geom_size[k])
    mesh = int(model.geom_dataid[k])
    if kind == PLANE:
        drawn: tuple[str, tuple[float, ...]] = ("box", (a or UNBOUNDED, b or UNBOUNDED, PLANE_THICKNESS))
    elif kind == BOX:
        drawn = ("box", (a, b, c))
    elif kind == SPHERE:
        drawn = ("ellipsoid", (a, a, a))
    elif kind == ELLIPSOID:
        drawn = ("ellipsoid", (a, b, c))
    elif kind in (CYLINDER, CAPSULE):
        drawn = ("cylinder" if kind == CYLINDER else "capsule", (a, b))
    elif kind == MESH:
        drawn = ("mesh", ())
    else:
        return None
    return Shape(*drawn, model.geom_pos[k].copy(), model.geom_quat[k].copy(), _rgba(model, k), mesh)


def _rgba(model: Any, k: int) -> tuple[float, ...]:
    """Return the colour as MuJoCo's viewer shows it: the geom's own if it was set, else its material's."""
    own, material = model.geom_rgba[k], int(model.geom_matid[k])
    rgba = model.mat_rgba[material] if material >= 0 and (own == DEFAULT_RGBA).all() else own
    return tuple(float(v) for v in rgba)


def _place(model: Any, owner: int, body: int, shape: Shape) -> Shape | None:
    """Return the shape in the frame of `body`, climbing from its owner; None if `body` is not above it."""
    while owner != body:
        if owner == 0:
            return None
        quat, position = model.body_quat[owner], model.body_pos[owner]
        shape = replace(
            shape,
            position=position + quat_rotate(quat, shape.position),
            quat=quat_multiply(quat, shape.quat),
        )
        owner = int(model.body_parentid[owner])
    return shape
