"""Force-deflection responses of soft bodies. Lengths in m, forces in N.

    db = palpate.open("liver.h5")
    db.tool("fingertip").force(positions)      # (n, 3) -> (n, 3)
"""
from ._palpate import (Database, Error, FormatError, InputError, NumericalError, Tool,
                       __version__, from_curves, open)


def _force(self, positions, tool=""):
    """Force (n, 3) [N] on the named tool, or the only one, at positions (n, 3) [m]: Tool.force."""
    return self.tool(tool).force(positions)


def _stiffness(self, depth, tool=""):
    """Slope (n,) [N/m] of each node's curve at depth [m]: Tool.stiffness."""
    return self.tool(tool).stiffness(depth)


Database.force = _force
Database.stiffness = _stiffness

__all__ = ["Database", "Error", "FormatError", "InputError", "NumericalError", "Tool",
           "__version__", "from_curves", "open"]
