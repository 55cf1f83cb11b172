import concurrent.futures
import os

import numpy
import pytest

import c_interface
import palpate

RADIUS_M = 0.005


def positions(n, seed=0):
    random = numpy.random.default_rng(seed)
    x = random.uniform([0.005, 0.005, RADIUS_M - 0.004], [0.035, 0.035, RADIUS_M + 0.001], (n, 3))
    return x


def test_a_sheet_of_springs_pushes_straight_back(flat):
    x = positions(500)
    wanted = 200.0 * numpy.maximum(0.0, RADIUS_M - x[:, 2])
    force = flat.force(x)
    assert numpy.allclose(force[:, 2], wanted, rtol=1e-12, atol=1e-15)
    assert numpy.allclose(force[:, :2], 0.0, atol=1e-14)  # roundings of 0.8 N


def test_stiffness_is_the_slope_of_the_curves(flat):
    assert numpy.allclose(flat.stiffness(0.001), 200.0, rtol=1e-12)


def test_a_node_without_a_curve_has_no_stiffness():
    db = palpate.from_curves([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]],
                             [([0, 0.1], [0, 1.0]), None, ([0, 0.1], [0, 1.0])], radius_m=0.1)
    assert numpy.isnan(db.stiffness(0.05)).tolist() == [False, True, False]


def test_a_force_does_not_depend_on_the_other_positions(uneven):
    x = positions(300)
    together = uneven.force(x)
    assert numpy.array_equal(together, [uneven.force(p) for p in x])
    assert numpy.array_equal(together[::-1], uneven.force(x[::-1]))


def test_the_runtime_renders_the_same_field(uneven, tmp_path):
    """Down from free space and on along the surface, by the C interface's potential model."""
    uneven.save(tmp_path / "body.h5")
    host = c_interface.Host(tmp_path / "body.h5", force_max=1e6, ramp=1e-9)
    down = numpy.linspace([0.012, 0.013, RADIUS_M + 0.001], [0.013, 0.014, RADIUS_M - 0.002], 400)
    along = numpy.linspace(down[-1], [0.029, 0.025, RADIUS_M - 0.001], 2000)
    x = numpy.vstack([down, along])
    rendered = numpy.empty_like(x)
    for i, p in enumerate(x):
        host.slow_step()
        status, rendered[i], _ = host.wrench(p, None, 0.001)
        assert status >= 0, (i, status)
    host.close()
    force = uneven.force(x)
    assert numpy.abs(force).max() > 0.1
    # The account's reserve may shift a contact by rounding.
    assert numpy.allclose(rendered, force, rtol=1e-6, atol=1e-9)


@pytest.mark.parametrize("wrong", [
    numpy.zeros((3, 2)), numpy.zeros((2, 3, 1)), numpy.zeros(4), 1.0, None, "abc",
    numpy.zeros((2, 3), complex), numpy.array([[0, 0, None]], object),
    [[0, 0, numpy.nan]], [[0, numpy.inf, 0]], [[1, 2, 3], [1, 2]]])
def test_wrong_positions_are_refused(flat, wrong):
    with pytest.raises(palpate.InputError):
        flat.force(wrong)


@pytest.mark.parametrize("depth", [-1.0, numpy.nan, numpy.inf])
def test_wrong_depths_are_refused(flat, depth):
    with pytest.raises(palpate.InputError):
        flat.stiffness(depth)


def test_arrays_of_any_layout_are_taken(uneven):
    x = positions(50)
    wanted = uneven.force(x)
    fixed = x.copy()
    fixed.flags.writeable = False
    for same in (numpy.asfortranarray(x), numpy.repeat(x, 2, axis=0)[::2], fixed, x.tolist(),
                 x.astype(">f8")):
        assert numpy.array_equal(uneven.force(same), wanted)
    single = x.astype(numpy.float32)
    assert numpy.array_equal(uneven.force(single), uneven.force(single.astype(float)))
    assert uneven.force(numpy.empty((0, 3))).shape == (0, 3)


def test_threads_get_the_same(uneven):
    x = positions(2000)
    wanted = uneven.force(x)
    with concurrent.futures.ThreadPoolExecutor(4) as pool:
        for force in pool.map(lambda _: uneven.force(x), range(16)):
            assert numpy.array_equal(force, wanted)


def test_a_forked_child_gets_the_same(uneven):
    x = positions(20)
    wanted = uneven.force(x)
    child = os.fork()
    if child == 0:
        os._exit(0 if numpy.array_equal(uneven.force(x), wanted) else 1)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0


def test_memory_is_steady(uneven, grown_kilobytes):
    x = positions(1)[0]
    tool = uneven.tool()

    def call():
        tool.force(x)
        tool.stiffness(0.001)
        _ = tool.depth_m, uneven.vertices
    assert grown_kilobytes(call, 100000) < 1024  # a leak of 16 bytes a call would show
