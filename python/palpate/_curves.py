"""Measured curves and their fits."""
import collections.abc
import os
import pathlib
import tempfile
import warnings

import numpy

from . import _palpate
from ._mesh import arrays_of, write_obj
from ._toml import toml


class Curve(collections.abc.Mapping):
    """One press: arrays depth_m (n,) [m], force_n (n,) [N], time_s (n,) [s] or None, and metadata.

    A mapping of these arrays, so that pandas.DataFrame(dict(curve)) is a table. Signs are those of the file.
    """

    def __init__(self, depth_m, force_n, time_s=None, metadata=None):
        self.depth_m, self.force_n, self.time_s = depth_m, force_n, time_s
        self.metadata = dict(metadata or {})

    def _arrays(self):
        arrays = {"depth_m": self.depth_m, "force_n": self.force_n}
        return arrays if self.time_s is None else {**arrays, "time_s": self.time_s}

    def __getitem__(self, name):
        return self._arrays()[name]

    def __iter__(self):
        return iter(self._arrays())

    def __len__(self):
        return len(self._arrays())

    def __repr__(self):
        return f"Curve({len(self.depth_m)} samples of {self.metadata.get('file', 'memory')})"


def load(file, *, depth_column="", depth_unit="", force_column="", force_unit="", time_column="",
         time_unit="", time=True, ignore_header_units=False):
    """All presses of a file, as a list of Curve, in SI units.

    What testing machines and instruments write is recognised by what it holds: text, workbooks (xlsx), Mach-1,
    Optics11, JPK, afmformats. Columns and units are those that the file tells, unless they are given here. Presses
    that follow one another in one table are parted. A press that cannot be read is left out with a warning, unless
    it is the only one. time=False: leave the times out, where the file has any.

    metadata: file, layout, number, press of presses, kind, position_m, normal, tip_radius_m, ..., notes.
    InputError, FormatError: what is wrong, with the line.
    """
    layout, left_out, presses = _palpate._load(
        file, (depth_column, depth_unit), (force_column, force_unit), (time_column, time_unit),
        time, ignore_header_units)
    curves = []
    for press in presses:
        if press["broken"]:
            warnings.warn(f"{os.fspath(file)}: left out: {press['broken']}", stacklevel=2)
            continue
        metadata = {"file": os.fspath(file), "layout": layout, "left_out": left_out, **press["metadata"]}
        times = press["time_s"]
        curves.append(Curve(press["depth_m"], press["force_n"], times if time and times.size else None, metadata))
    if not curves:
        raise _palpate.InputError(f"{os.fspath(file)}: no press can be read: {presses[0]['broken']}")
    return curves


def _samples(curve, drift=True):
    """(depth, force, time or None) of a Curve, another mapping, or a pair or triple of arrays."""
    if isinstance(curve, collections.abc.Mapping):
        try:
            parts = (curve["depth_m"], curve["force_n"], curve.get("time_s"))
        except KeyError as missing:
            raise _palpate.InputError(f"the curve has no {missing}, must have depth_m and force_n") from None
    elif isinstance(curve, (tuple, list)) and len(curve) in (2, 3):
        parts = (*curve, None)[:3]
    else:
        raise _palpate.InputError("a curve is a Curve, a mapping, or (depth_m, force_n) with or without time_s")
    return parts if drift else (*parts[:2], None)


def fit(curve, *, tool="", drift=True, frame_run=None, **options):
    """Contact point, law and modulus of one press: a Fit, with the numbers of `palpate-fit curve`.

    curve: a Curve of load(), or (depth_m (n,), force_n (n,)[, time_s (n,)]). tool: "sphere", "flat-punch", "cone" or
    "plate", with radius_m, half_angle_deg, height_m, thickness_m, poissons_ratio (0.5) and their standard deviations
    radius_sd_m, ...; a sphere takes the radius that the file states. from_m, to_m: displacements that are fitted;
    baseline_m: (from, to) that are surely before contact.
    drift: look for a drift with time where there are times. frame_stiffness_n_per_m, frame_stiffness_sd_n_per_m, or
    frame_run, a curve on a rigid plate: the machine's deflection is taken off.
    Several ramps with a hold after each (stepwise relaxation), with times: Fit.relaxation["press_and_hold"] is one law
    over all of them, terms g [-] and tau_s [s]; the modulus is of the whole approach: to_m ends it before the first hold.

    InputError: what is wrong with the curve. NumericalError: the fit did not converge.
    """
    metadata = curve.metadata if isinstance(curve, Curve) else {}
    stated = metadata.get("tip_radius_m")
    given = any(options.get(name) is not None for name in ("radius_m", "half_angle_deg", "height_m"))
    if stated is not None and not given and tool in ("", "sphere"):
        tool, options["radius_m"] = "sphere", stated
    run = None if frame_run is None else _samples(frame_run, drift)
    return _palpate._fit(_samples(curve), drift, run, tool=tool, **options)


def table(fits):
    """Numbers of some fits (Fit or their dicts), a dict of arrays, one entry a fit, for pandas.DataFrame().

    Numbers that are not known are NaN; texts and flags are objects.
    """
    rows = [fit if isinstance(fit, dict) else fit.to_dict() for fit in fits]
    columns = {}
    for name in rows[0] if rows else ():
        values = [row.get(name) for row in rows]
        if any(isinstance(value, dict) for value in values):
            continue
        if all(value is None or isinstance(value, (int, float)) for value in values):
            columns[name] = numpy.array([numpy.nan if value is None else value for value in values], float)
        elif all(value is None or isinstance(value, str) for value in values):
            columns[name] = numpy.array(values, object)
        elif name == "flags":
            columns[name] = numpy.array([" ".join(value) for value in values], object)
    return columns


class SurfaceFit:
    """database: responses at every node; to_dict(): what `palpate-fit surface --json` says."""

    def __init__(self, database, report):
        self.database, self._report = database, report

    def to_dict(self):
        return self._report

    def table(self):
        """Prediction of places left out, by depth: a dict of arrays for pandas.DataFrame()."""
        rows = self._report["left_one_out"]
        return {name: numpy.array([numpy.nan if row[name] is None else row[name] for row in rows], float)
                for name in (rows[0] if rows else ())}


def fit_surface(session, *, positions=None, mesh=None, normals=None, tool="sphere", radius_m=None,
                cycle="", **indenter):
    """From presses at scattered places to a response at every node: a SurfaceFit.

    session: a session file (TOML, fitting/session/SESSION.md). Or curves as fit() takes them, with positions (n, 3)
    [m], mesh: (vertices (v, 3) [m], triangles (t, 3)) or an object of meshio, trimesh or pyvista, optionally normals
    (n, 3), and of the tool radius_m, half_angle_deg or poissons_ratio. cycle: "first", "last" or a number, the
    press taken of each. As `palpate-fit surface`.
    """
    if isinstance(session, (str, os.PathLike)):
        return SurfaceFit(*_palpate._fit_surface(session, str(cycle)))
    if positions is None or mesh is None:
        raise _palpate.InputError("curves need positions (n, 3) and a mesh")
    with tempfile.TemporaryDirectory(prefix="palpate-") as folder:
        file = _write_session(pathlib.Path(folder), list(session), positions, mesh, normals,
                              {"shape": tool, "radius_m": radius_m, **indenter})
        return SurfaceFit(*_palpate._fit_surface(file, str(cycle)))


def _rows(values, count, what):
    try:
        rows = numpy.asarray(values, float)
    except (TypeError, ValueError):
        raise _palpate.InputError(f"{what} are not numbers, must have shape (n, 3)") from None
    if rows.shape != (count, 3):
        raise _palpate.InputError(f"{what} have shape {rows.shape}, must have ({count}, 3): one for each curve")
    return rows.tolist()


def _write_session(folder, curves, positions, mesh, normals, indenter):
    """The files of a session in which every number stands with all of its digits."""
    write_obj(folder / "body.obj", *arrays_of(mesh))
    places = _rows(positions, len(curves), "positions")
    outward = _rows(normals, len(curves), "normals") if normals is not None else None
    samples = [_samples(curve) for curve in curves]
    timed = all(time is not None for _, _, time in samples)
    read = {"depth_column": "depth", "depth_unit": "m", "force_column": "force", "force_unit": "N"}
    if timed:
        read.update(time_column="time", time_unit="s")
    runs = []
    for i, parts in enumerate(samples):
        name = f"curve-{i}.csv"
        _write_curve(folder / name, parts if timed else parts[:2], i)
        runs.append({"file": name, "position_m": places[i]})
        if outward:
            runs[-1]["normal"] = outward[i]
    scene = {"read": read, "indenter": {k: v for k, v in indenter.items() if v is not None},
             "body": {"mesh": "body.obj", "length_unit": "m"}, "run": runs}
    file = folder / "session.toml"
    file.write_text(toml(scene))
    return file


def _write_curve(file, parts, number):
    columns = [numpy.asarray(part, float) for part in parts]
    if any(column.ndim != 1 or len(column) != len(columns[0]) for column in columns):
        raise _palpate.InputError(f"curve {number}: depth, force and time must be as many, in one dimension")
    lines = [",".join(["depth", "force", "time"][:len(columns)])]
    lines += [",".join(map(repr, row)) for row in zip(*(column.tolist() for column in columns))]
    file.write_text("\n".join(lines) + "\n")
