#!/usr/bin/env python3
"""Steps as Gymnasium and Isaac Lab have them, without either: palpation_env.py [DATABASE]

PalpationEnv: one finger that looks for the stiffest place of a body, with history and friction (Renderer).
forces(): the same body under many fingers at once, without history: (n, 3) -> (n, 3) (Database.force).
"""
import sys

import numpy

import palpate


class PalpationEnv:
    """reset(seed) -> observation, info; step(action) -> observation, reward, terminated, truncated, info.

    An action (3,) [m] moves the finger by at most 1 mm an axis; an observation (6,) is its position [m] and force [N].
    The reward is the stiffness that was felt, in N/mm. 1 kHz below, 50 actions a second.
    """

    TICKS, TICK_S = 20, 0.001

    def __init__(self, db, tool="", limit=200):
        self._db, self._tool, self._limit = db, db.tool(tool or db.tools[0]), limit
        self._renderer = palpate.Renderer(db, self._tool.name)

    def reset(self, seed=None):
        pressed = numpy.flatnonzero(numpy.isfinite(self._tool.stiffness(0.0)))
        start = self._db.vertices[numpy.random.default_rng(seed).choice(pressed)]
        self._position = start + [0.0, 0.0, self._tool.radius_m + 0.001]
        self._renderer.reset()
        self._actions = 0
        return self._move(self._position), {}

    def step(self, action):
        goal = self._position + numpy.clip(action, -0.001, 0.001)
        observation = self._move(goal)
        self._actions += 1
        depth = self._renderer.depth_m
        reward = 1e-3 * numpy.linalg.norm(observation[3:]) / depth if depth > 1e-4 else 0.0
        too_deep = self._renderer.extrapolated
        return observation, reward, too_deep, self._actions >= self._limit, {"work_j": self._renderer.work_j}

    def _move(self, goal):
        way = self._position + numpy.linspace(0.0, 1.0, self.TICKS + 1)[1:, None] * (goal - self._position)
        self._position = goal
        return numpy.concatenate([goal, palpate.step_many(self._renderer, way, self.TICK_S, slow_every=1)[-1]])


def forces(db, positions):
    """Of n environments that share the body; a torch tensor on the CPU goes in as it is.

    With history and friction, n renderers step at once: palpate.step_many(renderers, ways (n, k, 3), dt).
    """
    return db.force(positions, db.tools[0])


def main():
    if len(sys.argv) > 1:
        db = palpate.open(sys.argv[1])
    else:
        import haptic_loop
        db = haptic_loop.sheet()
    env = PalpationEnv(db)
    env.reset(seed=1)
    total = 0.0
    for _ in range(100):
        observation, reward, terminated, truncated, info = env.step([0.0005, 0.0, -0.0001])
        total += reward
        if terminated or truncated:
            break
    print(f"return {total:.3g}, last force {observation[3:]} N, work {1e3 * info['work_j']:.3g} mJ")
    many = numpy.tile(observation[:3], (1000, 1)) + numpy.random.default_rng(0).normal(0.0, 1e-3, (1000, 3))
    print(f"1000 fingers: {numpy.linalg.norm(forces(db, many), axis=1).mean():.3g} N in the mean")


if __name__ == "__main__":
    main()
