"""Force-deflection responses of soft bodies. Lengths in m, forces in N, times in s.

    db = palpate.open("liver.h5")                       # or build(), precompute(), from_curves(), fit_surface()
    db.tool("fingertip").force(positions)               # (n, 3) -> (n, 3), the stored field
    db.pressure_law(node)(depths)                       # (n,) [m] -> (n,) [Pa], for hydroelastic contact
    with palpate.Renderer(db) as renderer:              # passive, for loops at 1 kHz
        force = renderer.step(position, dt)
    palpate.fit(palpate.load("hayes.txt")[0], tool="sphere", radius_m=0.003).to_dict()

Errors are palpate.Error: InputError, FormatError, NumericalError, RenderingFault, ToolsMissing.
"""
from ._curves import Curve, SurfaceFit, fit, fit_surface, load, table
from ._palpate import (Database, Error, Fit, FormatError, InputError, NumericalError, PressureLaw, Renderer,
                       RenderingFault, Tool, __version__, fit_session, from_curves, open, read_mesh, step_many)
from ._scenes import build, check, precompute, remesh, repair
from ._tools import ToolsMissing, find_tool


def _force(self, positions, tool="", *, threads=0, out=None):
    """Force (n, 3) [N] on the named tool, or the only one, at positions (n, 3) [m]: Tool.force."""
    return self.tool(tool).force(positions, threads=threads, out=out)


def _stiffness(self, depth, tool=""):
    """Slope (n,) [N/m] of each node's curve at depth [m]: Tool.stiffness."""
    return self.tool(tool).stiffness(depth)


def _pressure(self, position, grid, tool=""):
    """Pressure under the tool at a position (3,) [m] over (rows, columns, pitch_m) taxels: Tool.pressure."""
    return self.tool(tool).pressure(position, grid)


def _pressure_law(self, place, tool=""):
    """PressureLaw of a node (index), or of the place nearest to (3,) [m]: Tool.pressure_law."""
    return self.tool(tool).pressure_law(place)


def _pressure_laws(self, n, tool=""):
    """Pressures of all nodes at n depths, and their linear fits, a dict: Tool.pressure_laws."""
    return self.tool(tool).pressure_laws(n)


for _type in (Error, FormatError, InputError, NumericalError, RenderingFault, Database, Fit, PressureLaw, Renderer, Tool,
              ToolsMissing, Curve, SurfaceFit):
    _type.__module__ = "palpate"  # where users find it
Database.force = _force
Database.stiffness = _stiffness
Database.pressure = _pressure
Database.pressure_law = _pressure_law
Database.pressure_laws = _pressure_laws

__all__ = ["Curve", "Database", "Error", "Fit", "FormatError", "InputError", "NumericalError", "PressureLaw",
           "Renderer", "RenderingFault", "SurfaceFit", "Tool", "ToolsMissing", "__version__", "build", "check",
           "find_tool", "fit", "fit_session", "fit_surface", "from_curves", "load", "open", "precompute", "read_mesh",
           "remesh", "repair", "step_many", "table"]
