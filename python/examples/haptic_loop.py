#!/usr/bin/env python3
"""A hand that presses a body at 1 kHz, and its energy: haptic_loop.py [PICTURE [DATABASE [SECONDS]]]

The hand is a mass on a spring and a damper that follows a path; a device would give positions instead. Without a
database, a sheet that is stiffer towards +x. With a picture, matplotlib draws the account.
"""
import sys
import time

import numpy

import palpate

TICK_S = 0.001
MASS_KG, SPRING_N_PER_M, DAMPER_N_S_PER_M = 0.1, 300.0, 6.0


def sheet(cells=8, cell_m=0.01, radius_m=0.005):
    line = numpy.arange(cells + 1) * cell_m
    y, x = numpy.meshgrid(line, line, indexing="ij")
    vertices = numpy.column_stack([x.ravel(), y.ravel(), numpy.zeros(x.size)])
    a = (numpy.arange(cells)[:, None] * (cells + 1) + numpy.arange(cells)).ravel()
    triangles = numpy.vstack([numpy.column_stack([a, a + 1, a + cells + 2]),
                              numpy.column_stack([a, a + cells + 2, a + cells + 1])])
    depth = numpy.linspace(0.0, 0.004, 9)
    return palpate.from_curves(vertices, triangles, [(depth, (4000 + 2e5 * x) * depth ** 1.5) for x, _, _ in vertices],
                               radius_m=radius_m)


class Hand:
    """Is drawn to a path over the top of the body, 2 mm deep."""

    def __init__(self, db):
        height = db.vertices[:, 2]
        self._top = height.max() + db.tool(db.tools[0]).radius_m
        self._middle = db.vertices[height > height.max() - 0.001, :2].mean(axis=0)
        self.position = numpy.array([*self._middle, self._top + 0.005])
        self._speed = numpy.zeros(3)

    def move(self, force, t):
        turn = 2.0 * numpy.pi * 0.5 * t
        goal = numpy.array([*(self._middle + 0.008 * numpy.array([numpy.sin(turn), numpy.cos(turn) - 1.0])),
                            self._top - min(0.002, 0.01 * t - 0.005)])
        pull = SPRING_N_PER_M * (goal - self.position) - DAMPER_N_S_PER_M * self._speed + force
        self._speed = self._speed + pull / MASS_KG * TICK_S
        self.position = self.position + self._speed * TICK_S


def run(db, seconds):
    """Rows of time, work, stored, dissipated; how many ticks were late by a tick or more."""
    hand, rows, late = Hand(db), [], 0
    with palpate.Renderer(db, db.tools[0]) as renderer:
        force, begin = numpy.zeros(3), time.perf_counter()
        for i in range(int(seconds / TICK_S)):
            hand.move(force, i * TICK_S)
            force = renderer.step(hand.position, TICK_S)
            rows.append((i * TICK_S, renderer.work_j, renderer.stored_j, renderer.dissipated_j))
            left = begin + (i + 1) * TICK_S - time.perf_counter()
            if left > 0:
                time.sleep(left)
            late += left < -TICK_S
        assert renderer.work_j >= -1e-12  # never more than the hand put in
    return numpy.array(rows), late


def main():
    db = palpate.open(sys.argv[2]) if len(sys.argv) > 2 else sheet()
    rows, late = run(db, float(sys.argv[3]) if len(sys.argv) > 3 else 2.0)
    print(f"{len(rows)} ticks, {late} late; work {1e3 * rows[-1, 1]:.3g} mJ, at most {1e3 * rows[:, 1].max():.3g} mJ")
    if len(sys.argv) > 1:
        import matplotlib
        matplotlib.use("Agg")
        import matplotlib.pyplot as plt
        for column, name in ((1, "work of the hand"), (2, "stored"), (3, "dissipated")):
            plt.plot(rows[:, 0], 1e3 * rows[:, column], label=name)
        plt.xlabel("time [s]"), plt.ylabel("energy [mJ]"), plt.legend()
        plt.savefig(sys.argv[1])


if __name__ == "__main__":
    main()
