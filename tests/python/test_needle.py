import numpy
import pytest

import palpate
from conftest import block

RADIUS_M = 0.001
TOP_M = 0.02 + RADIUS_M  # height at which the ball that is pressed touches the block
KEYS = {"channel", "broken", "refused", "tip_m", "inserted_m", "tip_n", "shaft_n", "lateral_n", "cut_j", "released_j",
        "shaft_j"}


@pytest.fixture(scope="module")
def punctured():
    skinless = {"region": "body", "law": "linear", "youngs_modulus_pa": 5000.0, "poissons_ratio": 0.45,
                "puncture": {"toughness_j_per_m2": 15.0, "friction_n_per_m": 5.0, "membrane_n": 0.02}}
    return palpate.build(
        {"body": {"mesh": block()}, "material": [skinless], "support": [{"box_m": [[-1, -1, -1], [1, 1, 0.001]]}],
         "tool": [{"name": "needle", "shape": "needle", "radius_m": RADIUS_M, "edge_width_m": 0.001}],
         "reach": {"box_m": [[0.009, 0.009, 0.019], [0.031, 0.031, 1]], "depth_max_m": 0.003},
         "accuracy": {"force_relative": 0.5, "verify": 0, "depths": 3}})


def press(renderer, x, down_m, turn=numpy.eye(3), origin=numpy.zeros(3)):
    """Straight from above; the largest force on the way, and the last."""
    peak = 0.0
    for i, depth in enumerate(numpy.arange(-0.001, down_m, 1e-5)):
        force = renderer.step(turn @ [x, 0.02, TOP_M - depth] + origin, 0.001)
        peak = max(peak, numpy.linalg.norm(force))
        if i % 5 == 0:
            renderer.slow_step()
    return peak, force


def test_a_needle_is_read_where_it_is(punctured):
    renderer = palpate.Renderer(punctured)
    renderer.step([0.02, 0.02, 0.1], 0.001)
    before = renderer.needle()
    assert set(before) == KEYS and before["channel"] is None and before["broken"] == 0
    assert renderer.channel_table()["depth_m"].shape == (0,)
    peak, force = press(renderer, 0.02, 0.012)
    needle, channels = renderer.needle(), renderer.channel_table()
    assert needle["channel"] == 0 and needle["broken"] == 1 and needle["refused"] == 0
    assert needle["tip_n"] == pytest.approx(15.0 * 0.001, rel=1e-3)  # J w
    assert needle["shaft_n"] == pytest.approx(5.0 * needle["inserted_m"], rel=1e-3)
    axis = channels["axis"][0]
    parts = (needle["tip_n"] + needle["shaft_n"]) * axis + needle["lateral_n"]
    assert numpy.allclose(parts, force, atol=1e-12)
    assert needle["inserted_m"] == channels["depth_m"][0]
    at = numpy.array([0.02, 0.02, TOP_M - 0.01199])
    assert axis @ (channels["entry_m"][0] - at) == pytest.approx(needle["tip_m"], abs=1e-9)
    assert channels["boundary_m"][0] == numpy.inf and channels["layer"][0] == 0
    assert needle["cut_j"] == pytest.approx(15.0 * 0.001 * channels["depth_m"][0], rel=1e-3)
    works = needle["cut_j"] + needle["released_j"] + needle["shaft_j"]
    assert works <= renderer.dissipated_j * (1 + 1e-9) and works > 0.5 * renderer.dissipated_j
    renderer.reset()
    assert renderer.needle()["channel"] is None and len(renderer.channel_table()["axis"]) == 1


def test_channels_stand_where_the_body_stands(punctured):
    here, there = palpate.Renderer(punctured), palpate.Renderer(punctured)
    turn = numpy.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    origin = numpy.array([0.1, 0.2, 0.3])
    there.place(origin, [0.0, 0.0, 1.0, 1.0])
    for x in (0.014, 0.026):
        press(here, x, 0.01)
        press(there, x, 0.01, turn, origin)
    a, b = here.channel_table(), there.channel_table()
    assert len(a["axis"]) == 2
    assert numpy.allclose(b["entry_m"], a["entry_m"] @ turn.T + origin, atol=1e-9)
    assert numpy.allclose(b["axis"], a["axis"] @ turn.T, atol=1e-9)
    assert numpy.allclose(b["depth_m"], a["depth_m"], atol=1e-9)
    assert numpy.allclose(there.needle()["lateral_n"], turn @ here.needle()["lateral_n"], atol=1e-9)


def test_what_is_no_needle_says_so(flat, punctured):
    renderer = palpate.Renderer(flat)
    for read in (renderer.needle, renderer.channel_table):
        with pytest.raises(palpate.InputError, match="no needle"):
            read()
    with pytest.raises(palpate.InputError, match="a needle needs the model potential or facets"):
        palpate.Renderer(punctured, model="element")
