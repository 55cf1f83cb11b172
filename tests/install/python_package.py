"""python_package.py FOLDER: the package found there, used as a newcomer would. Without the tools it says so."""
import sys
import tempfile

import numpy

import palpate

assert palpate.__file__.startswith(sys.argv[1]), palpate.__file__
depth = numpy.linspace(0.0, 0.004, 9)
db = palpate.from_curves([[0, 0, 0], [0.1, 0, 0], [0.1, 0.1, 0], [0, 0.1, 0]], [[0, 1, 2], [0, 2, 3]],
                         [(depth, 200.0 * depth)] * 4, radius_m=0.005)
with tempfile.NamedTemporaryFile(suffix=".h5") as file:
    db.save(file.name)
    db = palpate.open(file.name)
at = [0.06, 0.03, 0.005 - 0.002]
assert numpy.allclose(db.force(at), [0, 0, 0.4], atol=1e-12)
renderer = palpate.Renderer(db)
for z in numpy.linspace(0.006, at[2], 400):
    force = renderer.step([*at[:2], z], 0.001)
    renderer.slow_step()
assert numpy.allclose(force, [0, 0, 0.4], atol=1e-6)
x = numpy.linspace(0.0, 4e-3, 200)
f = 6000.0 * numpy.maximum(0.0, x - 1e-3) ** 1.5 + numpy.random.default_rng(1).normal(0.0, 0.003, 200)
assert abs(palpate.fit((x, f), tool="sphere", radius_m=0.002).contact_point_m - 1e-3) < 1e-4
try:
    palpate.check(db.vertices, db.triangles)
    print("tools are there")
except palpate.ToolsMissing as missing:
    assert "\n" not in str(missing)
    print(missing)
except palpate.InputError:
    print("tools are there")
print(f"palpate {palpate.__version__} works from {palpate.__file__}")
