"""The instrument of an MJCF model as Rerun geometry."""

from typing import Any

import numpy as np
import rerun as rr

from bench.record.drawing import Shape, mesh_triangles
from bench.record.stream import xyzw
from bench.rotation import quat_rotate


def log_shapes(rec: rr.RecordingStream, parent: str, model: Any, shapes: tuple[Shape, ...]) -> None:
    """Log the shapes of a model below an entity: one entity per kind, one per mesh and colour."""
    groups: dict[tuple[Any, ...], list[Shape]] = {}
    for shape in shapes:
        groups.setdefault((shape.kind, shape.mesh, shape.rgba if shape.kind == "mesh" else None), []).append(shape)
    for k, ((kind, mesh, rgba), group) in enumerate(groups.items()):
        if kind == "mesh":
            corners, normals = mesh_triangles(model, mesh)
            archetypes = [
                rr.Mesh3D(vertex_positions=corners, vertex_normals=normals, albedo_factor=rgba),
                rr.InstancePoses3D(translations=[s.position for s in group], quaternions=[xyzw(s.quat) for s in group]),
            ]
        else:
            archetypes = [_primitives(kind, group)]
        rec.log(f"{parent}/{kind}_{k}", *archetypes, static=True)


def _primitives(kind: str, group: list[Shape]) -> Any:
    size = np.array([s.size for s in group])
    position, quat = np.array([s.position for s in group]), np.array([s.quat for s in group])
    look = {"quaternions": xyzw(quat), "colors": [s.rgba for s in group]}
    solid = rr.components.FillMode.Solid
    if kind == "box":
        return rr.Boxes3D(half_sizes=size, centers=position, fill_mode=solid, **look)
    if kind == "ellipsoid":
        return rr.Ellipsoids3D(half_sizes=size, centers=position, fill_mode=solid, **look)
    if kind == "cylinder":
        return rr.Cylinders3D(radii=size[:, 0], lengths=2 * size[:, 1], centers=position, fill_mode=solid, **look)
    # Rerun's capsule begins at its origin, MuJoCo's is centred.
    start = position - quat_rotate(quat, size[:, 1:] * [0.0, 0.0, 1.0])
    return rr.Capsules3D(radii=size[:, 0], lengths=2 * size[:, 1], translations=start, fill_mode=solid, **look)
