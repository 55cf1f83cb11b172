#!/usr/bin/env python3
"""Forces of many fingers from and into tensors, no copy made: torch_batch.py [DATABASE]

Tensors of torch, and arrays of jax and warp, lie on the CPU and hold float64. Without torch a stand-in has the two
methods by which they hand over their memory. A tensor on a GPU is refused: tensor.cpu() moves it.
"""
import sys

import numpy

import palpate

try:
    import torch
    empty = torch.empty_like

    def tensor(array):
        return torch.from_dlpack(array)
except ImportError:
    class Tensor:
        def __init__(self, array):
            self.array = array

        def __dlpack__(self, stream=None):
            return self.array.__dlpack__()

        def __dlpack_device__(self):
            return self.array.__dlpack_device__()

    tensor = Tensor

    def empty(like):
        return Tensor(numpy.empty_like(like.array))


def main():
    if len(sys.argv) > 1:
        db = palpate.open(sys.argv[1])
    else:
        import haptic_loop
        db = haptic_loop.sheet()
    tool = db.tool(db.tools[0])
    random = numpy.random.default_rng(0)
    node = random.choice(numpy.flatnonzero(numpy.isfinite(tool.stiffness(0.0))), 10000)
    positions = tensor(db.vertices[node] + random.uniform(-0.002, 0.002, (10000, 3)) +
                       (tool.radius_m - 0.001) * db.normals[node])
    forces = empty(positions)
    same = tool.force(positions, out=forces)  # palpate writes into the tensor's memory
    assert same is forces
    seen = numpy.from_dlpack(forces)
    assert numpy.array_equal(seen, tool.force(numpy.from_dlpack(positions)))
    print(f"{len(seen)} fingers: {numpy.linalg.norm(seen, axis=1).mean():.4g} N in the mean")


if __name__ == "__main__":
    main()
