import numpy
import pytest

import palpate

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
