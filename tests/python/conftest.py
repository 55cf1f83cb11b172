import os
import resource

import numpy
import pytest

import palpate

# A sanitizer that stands before this process (sanitized) has no business in the tools that tests run: they
# fork beside threads, and its allocator may then be locked in the child for ever.
_PRELOADED = os.environ.pop("LD_PRELOAD", "")

RADIUS_M = 0.005


def sheet(cells=4, cell_m=0.01):
    """A flat square in z = 0, normals along +z."""
    line = numpy.arange(cells + 1) * cell_m
    y, x = numpy.meshgrid(line, line, indexing="ij")
    vertices = numpy.column_stack([x.ravel(), y.ravel(), numpy.zeros(x.size)])
    a = (numpy.arange(cells)[:, None] * (cells + 1) + numpy.arange(cells)).ravel()
    b, c, d = a + 1, a + cells + 2, a + cells + 1
    return vertices, numpy.vstack([numpy.column_stack([a, b, c]), numpy.column_stack([a, c, d])])


@pytest.fixture
def flat():
    """Every node f = 200 d N: the field is that of one spring per place."""
    vertices, triangles = sheet()
    depth = numpy.linspace(0.0, 0.004, 9)
    return palpate.from_curves(vertices, triangles, [(depth, 200.0 * depth)] * len(vertices),
                               radius_m=RADIUS_M, tool="ball")


@pytest.fixture
def uneven():
    """Hertz-like curves that differ from node to node."""
    vertices, triangles = sheet()
    depth = numpy.linspace(0.0, 0.004, 9)
    curves = [(depth, (1.0 + i % 5) * 1000.0 * depth ** 1.5) for i in range(len(vertices))]
    return palpate.from_curves(vertices, triangles, curves, radius_m=RADIUS_M, tool="ball")


def block(cells=4, width_m=0.04, height_m=0.02):
    """A closed box, its top in z = height_m."""
    top, triangles = sheet(cells, width_m / cells)
    bottom, n = top.copy(), len(top)
    top[:, 2] = height_m
    vertices = numpy.vstack([top, bottom])
    line = numpy.arange(cells + 1)
    rim = [line[:-1], line[:-1] * (cells + 1) + cells, (n - 1) - line[:-1], (n - 1 - cells) - line[:-1] * (cells + 1)]
    ring = numpy.concatenate(rim)
    after = numpy.roll(ring, -1)
    sides = numpy.vstack([numpy.column_stack([ring + n, after + n, after]),
                          numpy.column_stack([ring + n, after, ring])])
    return vertices, numpy.vstack([triangles, triangles[:, ::-1] + n, sides])


@pytest.fixture(scope="session")
def built():
    """A soft block on a table, pressed by a ball and by two balls side by side."""
    vertices, triangles = block()
    return palpate.precompute(
        vertices, triangles, youngs_modulus_pa=5000.0, support={"box_m": [[-1, -1, -1], [1, 1, 0.001]]},
        tool=[{"name": "ball", "shape": "sphere", "radius_m": 0.01, "friction": 0.3, "presliding_m": 0.0005},
              {"name": "pads", "shape": "spheres", "centre_m": [[0.006, 0, 0], [-0.006, 0, 0]], "radius_m": 0.01}],
        depth_max_m=0.003, reach_box_m=[[0.009, 0.009, 0.019], [0.031, 0.031, 1]], force_relative=0.5,
        accuracy={"verify": 0, "depths": 3})


@pytest.fixture
def grown_kilobytes():
    """How much more memory is there after many calls than after a few."""
    def kilobytes():
        with open("/proc/self/statm") as file:
            return int(file.read().split()[1]) * resource.getpagesize() // 1024

    if "libasan" in _PRELOADED:
        pytest.skip("the sanitizer keeps what is freed")

    def grown(call, times):
        for _ in range(times // 10):
            call()
        before = kilobytes()
        for _ in range(times):
            call()
        return kilobytes() - before
    return grown
