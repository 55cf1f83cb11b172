"""Triangle surfaces of others, by their arrays."""
import numpy

from . import _palpate


def _faces_of(mesh):
    if hasattr(mesh, "cells_dict"):  # meshio
        return mesh.cells_dict.get("triangle")
    if hasattr(mesh, "regular_faces"):  # pyvista
        return mesh.regular_faces
    faces = getattr(mesh, "faces", None)  # trimesh; older pyvista: 3, a, b, c, 3, ...
    if faces is not None and numpy.ndim(faces) == 1:
        faces = numpy.reshape(faces, (-1, 4))[:, 1:] if numpy.size(faces) % 4 == 0 else None
    return faces


def arrays_of(mesh, faces=None):
    """Vertices (n, 3) float and triangles (t, 3) int of two arrays, a pair, or a mesh of meshio, trimesh, pyvista."""
    if faces is None:
        if isinstance(mesh, (tuple, list)) and len(mesh) == 2:
            mesh, faces = mesh
        else:
            mesh, faces = getattr(mesh, "points", getattr(mesh, "vertices", None)), _faces_of(mesh)
    try:
        vertices, triangles = numpy.asarray(mesh, float), numpy.asarray(faces)
    except (TypeError, ValueError):
        raise _palpate.InputError("the mesh has no arrays of vertices (n, 3) and triangles (t, 3)") from None
    if vertices.ndim != 2 or vertices.shape[1] != 3 or not numpy.isfinite(vertices).all():
        raise _palpate.InputError(f"vertices have shape {vertices.shape}, must be (n, 3) and finite")
    if triangles.ndim != 2 or triangles.shape[1] != 3 or triangles.dtype.kind not in "iu":
        raise _palpate.InputError(f"triangles have shape {triangles.shape} of {triangles.dtype}, must be (t, 3) integers")
    if triangles.size and not (0 <= triangles.min() and triangles.max() < len(vertices)):
        raise _palpate.InputError(f"triangles have nodes from {triangles.min()} to {triangles.max()}, "
                                  f"must lie in [0, {len(vertices) - 1}]")
    return vertices, triangles


def write_obj(file, vertices, triangles):
    """Every coordinate with all of its digits."""
    lines = ["v " + " ".join(map(repr, row)) for row in vertices.tolist()]
    lines += ["f {} {} {}".format(*(node + 1 for node in row)) for row in triangles.tolist()]
    with open(file, "w") as out:
        out.write("\n".join(lines) + "\n")
