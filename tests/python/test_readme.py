"""The Python of README.md runs as it stands."""
import pathlib
import re

import numpy

import layouts
from test_tools import block

README = pathlib.Path(__file__).parents[2] / "README.md"


def test_its_lines_run(tmp_path, monkeypatch):
    layouts.plain(tmp_path)[0].rename(tmp_path / "press.csv")
    monkeypatch.chdir(tmp_path)
    vertices, triangles = block()
    top = vertices[:, 2].max()
    names = {"vertices": vertices, "triangles": triangles, "position": [0.0, 0.0, top + 0.003],
             "box": [[-1.0, -1.0, -1.0], [1.0, 1.0, vertices[:, 2].min() + 1e-6]],
             "positions": [[0.0, 0.0, top + 0.003], [0.0, 0.0, top + 0.02]]}
    lines, = re.findall(r"```python\n(.*?)```", README.read_text(), re.S)
    first, second = lines.split("with palpate.Renderer", 1)
    exec(first, names)
    assert names["force"].shape == (2, 3) and names["force"][0, 2] > 0.0
    assert numpy.all(names["force"][1] == 0.0)
    exec("with palpate.Renderer" + second, names)
    assert names["fit"].youngs_modulus_pa > 0.0
