"""Bodies pressed by palpate-precompute, which runs as a process."""
import contextlib
import os
import pathlib
import tempfile


from . import _palpate
from ._mesh import arrays_of, write_obj
from ._toml import toml
from ._tools import must_run, run

_TOOL = "palpate-precompute"


def _with_files(table, folder, number):
    """A scene's table whose mesh is a file: arrays are written, relative files belong to the current folder."""
    mesh = table.get("mesh")
    if mesh is None:
        return table
    if isinstance(mesh, (str, os.PathLike)):
        return {**table, "mesh": str(pathlib.Path(mesh).resolve())}
    file = folder / f"mesh-{number}.obj"
    write_obj(file, *arrays_of(mesh))
    return {**table, "mesh": str(file), "length_unit": "m"}


def _write_scene(scene, folder):
    document = {}
    for name, part in scene.items():
        tables = part if isinstance(part, (list, tuple)) else [part]
        if not all(isinstance(table, dict) for table in tables):
            raise _palpate.InputError(f"scene: {name} is {part!r}, must be a dict or a list of dicts")
        done = [_with_files(table, folder, f"{name}-{i}") for i, table in enumerate(tables)]
        document[name] = done if isinstance(part, (list, tuple)) else done[0]
    file = folder / "scene.toml"
    file.write_text(toml(document))
    return file


@contextlib.contextmanager
def _folder():
    with tempfile.TemporaryDirectory(prefix="palpate-") as folder:
        yield pathlib.Path(folder)


def build(scene, *, output=None, progress=None, workers=0, repair="off", precision=None, resume=False,
          solve_all=False, strict=False):
    """Responses at every node that a scene's tools can reach: a Database, whose report is a dict.

    scene: a file (TOML, formats/scene/SCENE.md), or its content as a dict; lists of dicts are [[..]]. A mesh may be
    (vertices (n, 3) [m], triangles (t, 3)), or an object of meshio, trimesh or pyvista. output: keep the database in
    this file as well. progress(line): called while palpate-precompute works. Ctrl-C ends it; with an output, resume
    goes on. The other options are those of `palpate-precompute build`.

    ToolsMissing: where the tool was looked for. InputError, FormatError, NumericalError: what the tool complains of.
    """
    options = ["--threads", str(workers), "--repair", repair]
    options += ["--precision", precision] if precision else []
    options += [flag for flag, on in (("--resume", resume), ("--solve-all", solve_all), ("--strict", strict)) if on]
    with _folder() as folder:
        file = scene if isinstance(scene, (str, os.PathLike)) else _write_scene(scene, folder)
        target = output if output is not None else folder / "built.h5"
        report = must_run(_TOOL, ["build", file, "-o", target, *options], progress)
        database = _palpate.open(target)
    database.report = report
    return database


def precompute(vertices, faces=None, *, youngs_modulus_pa, poissons_ratio=0.45, law="linear", support, depth_max_m,
               radius_m=None, tool=None, force_max_n=None, reach_box_m=None, force_relative=0.05, accuracy=None, **options):
    """A body of one material, pressed at every vertex: a Database.

    vertices (n, 3) [m], faces (t, 3) counter-clockwise from outside, closed; or one object of meshio, trimesh or
    pyvista. support: {"box_m": [[x, y, z], [x, y, z]]} or another of [[support]], or a list of them. radius_m: of the
    ball that presses, named "tool"; or tool: a dict or a list of them as [[tool]]. reach_box_m: only vertices in it.
    force_relative: accuracy that is aimed at; accuracy: more keys of [accuracy]. options: as build() takes them.
    """
    if tool is None:
        if radius_m is None:
            raise _palpate.InputError("radius_m or tool: one of them says what presses")
        tool = {"name": "tool", "shape": "sphere", "radius_m": radius_m}
    elif radius_m is not None:
        raise _palpate.InputError("radius_m and tool: tell one of them")
    scene = {"body": {"mesh": arrays_of(vertices, faces)},
             "material": [{"region": "body", "law": law, "youngs_modulus_pa": youngs_modulus_pa,
                           "poissons_ratio": poissons_ratio}],
             "support": [support] if isinstance(support, dict) else list(support),
             "tool": [tool] if isinstance(tool, dict) else list(tool),
             "reach": {"box_m": reach_box_m, "depth_max_m": depth_max_m, "force_max_n": force_max_n},
             "accuracy": {"force_relative": force_relative, **(accuracy or {})}}
    return build(scene, **options)


def check(vertices, faces=None):
    """Whether a surface bounds a body, and what is wrong with it where it does not: a dict with "accepted", "verdict",
    "defects", ... vertices (n, 3) [m], faces (t, 3), or an object of meshio, trimesh or pyvista."""
    with _folder() as folder:
        write_obj(folder / "surface.obj", *arrays_of(vertices, faces))
        code, report, complaint = run(_TOOL, ["check", folder / "surface.obj", "--length-unit", "m"])
    if report is None or code not in (0, 2):
        raise _palpate.InputError(complaint)
    return report["before"]


def _surface(command, mesh, options):
    with _folder() as folder:
        file, made = folder / "surface.obj", folder / "made.obj"
        write_obj(file, *mesh)
        try:
            report = must_run(_TOOL, [command, file, "--length-unit", "m", "-o", made, *options])
        except _palpate.Error as error:  # names files and flags that the caller never saw
            said = str(error).replace(f"{file}: ", "").split(": palpate-precompute ")[0].replace("--repair=", "mode ")
            raise type(error)(said) from None
        vertices, triangles = _palpate.read_mesh(made, "m")
    return vertices, triangles, report


def repair(vertices, faces=None, *, mode="safe"):
    """A surface that bounds a body: vertices (n, 3) [m], triangles (t, 3), and a report.

    mode "safe": mended, no vertex moves; "wrap": all holes closed, a new surface around. InputError: why it cannot be.
    """
    return _surface("check", arrays_of(vertices, faces), ["--repair", mode])


def remesh(vertices, faces=None, *, edge_m):
    """The surface anew, with triangles of even size and shape, edges edge_m [m] long: vertices, triangles, report."""
    return _surface("remesh", arrays_of(vertices, faces), ["--edge-m", repr(float(edge_m))])
