"""Forces at many positions and of many renderers at once, from and into memory of others."""
import concurrent.futures
import gc
import weakref

import numpy
import pytest

import palpate
from test_force import positions
from test_renderer import path


class Foreign:
    """An array of another library: numpy's memory behind the two methods of DLPack alone."""

    def __init__(self, array, device=None):
        self.array, self._device = array, array.__dlpack_device__() if device is None else device

    def __dlpack__(self, stream=None):
        return self.array.__dlpack__()

    def __dlpack_device__(self):
        return self._device


def address(array):
    return array.__array_interface__["data"][0]


def test_the_number_of_threads_changes_no_bit(uneven):
    x = positions(20000)
    wanted = uneven.force(x, threads=1)
    assert numpy.abs(wanted).max() > 0.1
    for threads in (0, 2, 3, 8):
        assert uneven.force(x, threads=threads).tobytes() == wanted.tobytes(), threads
    with pytest.raises(TypeError):
        uneven.force(x, threads=-1)


@pytest.mark.parametrize("wrap", [lambda a: a, Foreign])
def test_positions_are_not_copied(uneven, wrap):
    x = positions(100)
    assert address(palpate._palpate._numbers(wrap(x))) == address(x)


def test_what_must_be_converted_is_copied(uneven):
    x = positions(100)
    wanted = uneven.force(x)
    for same in (Foreign(numpy.asfortranarray(x)), Foreign(numpy.repeat(x, 2, axis=0)[::2]), Foreign(x[::-1])):
        seen = palpate._palpate._numbers(same)
        assert not numpy.shares_memory(seen, same.array)
        assert numpy.array_equal(uneven.force(same), uneven.force(same.array))
    single = x.astype(numpy.float32)
    assert numpy.array_equal(uneven.force(Foreign(single)), uneven.force(single.astype(float)))
    assert numpy.array_equal(uneven.force(Foreign(x)), wanted)
    assert uneven.force(Foreign(numpy.empty((0, 3)))).shape == (0, 3)


@pytest.mark.parametrize("wrong", [
    Foreign(numpy.zeros((2, 3)), (2, 0)), Foreign(numpy.zeros((2, 2))), Foreign(numpy.zeros((2, 3), complex)),
    Foreign(numpy.full((2, 3), numpy.nan)), Foreign(numpy.zeros((2, 3), ">f8")), Foreign(numpy.zeros((2, 3)), ()),
    Foreign(numpy.zeros((2, 3)), "cpu")])
def test_wrong_arrays_of_others_are_refused(flat, wrong):
    with pytest.raises(palpate.InputError):
        flat.force(wrong)


def test_an_array_on_a_gpu_is_to_be_moved(flat):
    with pytest.raises(palpate.InputError, match=r"^positions lie on a device .* moved to the CPU first$"):
        flat.force(Foreign(numpy.zeros((2, 3)), (2, 0)))


def test_what_a_producer_raises_is_said(flat):
    fixed = numpy.zeros((2, 3))
    fixed.flags.writeable = False  # numpy exports no such array
    with pytest.raises(palpate.InputError, match="readonly"):
        flat.force(Foreign(fixed))


@pytest.mark.parametrize("wrap", [lambda a: a, Foreign])
def test_forces_go_into_the_callers_buffer(uneven, wrap):
    x = positions(3000)
    memory = numpy.full((3000, 3), numpy.nan)
    out = wrap(memory)
    assert uneven.force(x, out=out) is out
    assert memory.tobytes() == uneven.force(x).tobytes()
    one = numpy.empty(3)
    assert uneven.force(x[0], out=one) is one and numpy.array_equal(one, memory[0])


def test_a_buffer_may_be_the_positions_memory(uneven):
    x = positions(3000)
    wanted = uneven.force(x)
    both = x.copy()
    assert uneven.force(both, out=both) is both and numpy.array_equal(both, wanted)
    memory = numpy.empty((3001, 3))
    memory[:-1] = x
    uneven.force(memory[:-1], out=memory[1:])  # a row further on
    assert numpy.array_equal(memory[1:], wanted)


def read_only(shape):
    array = numpy.zeros(shape)
    array.flags.writeable = False
    return array


@pytest.mark.parametrize("wrong", [
    numpy.zeros((4, 3)), numpy.zeros((5, 3), numpy.float32), numpy.zeros((5, 3), ">f8"), numpy.zeros((10, 3))[::2],
    numpy.asfortranarray(numpy.zeros((5, 3))), numpy.zeros(15), read_only((5, 3)), [[0.0] * 3] * 5, 3.0,
    Foreign(numpy.zeros((5, 3)), (2, 0)), Foreign(numpy.zeros((5, 3), numpy.float32)), Foreign(read_only((5, 3)))])
def test_buffers_that_do_not_fit_are_refused(flat, wrong):
    before = numpy.array(getattr(wrong, "array", wrong), copy=True)
    with pytest.raises(palpate.InputError, match="^out "):
        flat.force(positions(5), out=wrong)
    assert numpy.array_equal(getattr(wrong, "array", wrong), before)


def test_memory_of_others_lives_as_long_as_it_is_used(uneven):
    x = positions(100)
    seen = palpate._palpate._numbers(Foreign(x.copy()))
    gc.collect()
    assert numpy.array_equal(seen, x)
    owner = Foreign(x.copy())
    gone = weakref.ref(owner)
    uneven.force(owner)
    del owner
    gc.collect()
    assert gone() is None


def test_results_are_exported_as_they_lie(uneven):
    force = uneven.force(positions(10))
    assert address(numpy.from_dlpack(Foreign(force))) == address(force)


def renderers(db, n):
    return [palpate.Renderer(db, "ball", stall_s=1e9) for _ in range(n)]


def paths(n, ticks=400):
    """(n, ticks, 3): the same way at other places and depths."""
    random = numpy.random.default_rng(3)
    return path(ticks) + random.uniform(-0.002, 0.0005, (n, 1, 3)) * [1, 1, 0.5]


def test_many_renderers_step_as_one_by_one(built):
    ways = paths(6)
    wanted = numpy.empty_like(ways)
    alone = renderers(built, 6)
    for renderer, way, force in zip(alone, ways, wanted):
        for i, x in enumerate(way):
            force[i] = renderer.step(x, 0.001)
            if renderer.ticks % 10 == 0:
                renderer.slow_step()
    assert wanted[..., 2].max() > 0.02 and all(r.dissipated_j > 0.0 for r in alone)
    for threads in (1, 3):
        whole = renderers(built, 6)
        force = palpate.step_many(whole, ways, 0.001, slow_every=10, threads=threads)
        assert force.tobytes() == wanted.tobytes()
        assert [r.work_j for r in whole] == [r.work_j for r in alone]
    singly = renderers(built, 6)
    out = Foreign(numpy.empty((6, 3)))
    for i in range(ways.shape[1]):
        given = palpate.step_many(singly, Foreign(ways[:, i].copy()), 0.001, slow_every=10, out=out)
        assert given is out and numpy.array_equal(out.array, wanted[:, i])


def test_one_renderer_steps_along_a_path(built):
    way, = paths(1)
    one, other = renderers(built, 2)
    along = palpate.step_many(one, way, 0.001, slow_every=10)
    wanted = palpate.step_many([other], way[None], 0.001, slow_every=10)
    assert along.shape == way.shape and along.tobytes() == wanted.tobytes()
    assert palpate.step_many(one, way[0], 0.001).shape == (3,)
    assert palpate.step_many([], numpy.empty((0, 3))).shape == (0, 3)
    assert palpate.step_many(one, numpy.empty((0, 3))).shape == (0, 3)


def test_slow_threads_may_run(built):
    whole = renderers(built, 2)
    with whole[0], whole[1]:
        assert palpate.step_many(whole, paths(2)[:, 0], 0.001).shape == (2, 3)
        with pytest.raises(palpate.InputError, match="renderer 0: the slow thread runs"):
            palpate.step_many(whole, paths(2)[:, 0], 0.001, slow_every=1)


def test_a_fault_stops_one_renderer_and_no_other(built):
    ways = paths(3, 50)
    whole, alone = renderers(built, 3), renderers(built, 1)[0]
    wanted = palpate.step_many(alone, ways[2], 0.001, slow_every=1)
    ways[1, 20] = numpy.nan
    out = numpy.full_like(ways, 7.0)
    with pytest.raises(palpate.RenderingFault, match="^1 of 3 renderers, the first of them renderer 1: .*not-finite"):
        palpate.step_many(whole, ways, 0.001, slow_every=1, out=out)
    assert numpy.array_equal(out[2], wanted) and numpy.all(out[1, 20:] == 0.0)
    assert [r.fault for r in whole] == ["none", "not-finite", "none"]
    whole[1].reset()
    assert palpate.step_many(whole, ways[:, 0], 0.001).shape == (3, 3)


def test_wrong_batches_are_refused(built):
    one, other = renderers(built, 2)
    pair = palpate.Renderer(built, "pads", second_tool="")
    for whose, where, said in [
            ([one, one], numpy.zeros((2, 3)), "twice"), ([one, 3], numpy.zeros((2, 3)), "Renderer"),
            ([one, other], numpy.zeros((3, 3)), r"\(2, 3\) or \(2, k, 3\)"), ([one], numpy.zeros((1, 2)), "shape"),
            (one, numpy.zeros((1, 1, 3)), r"\(3,\) or \(k, 3\)"), ([pair], numpy.zeros((1, 3)), "two hands")]:
        with pytest.raises(palpate.InputError, match=said):
            palpate.step_many(whose, where)
    with pytest.raises(TypeError):
        palpate.step_many(None, numpy.zeros((1, 3)))
    assert one.ticks == 0 and palpate.step_many([one, other], numpy.ones((2, 3))).shape == (2, 3)


def test_nobody_else_steps_a_renderer_of_a_batch(built):
    """While step_many() runs in a thread, others are refused; afterwards they are not."""
    one, = renderers(built, 1)
    way = numpy.repeat(path(1000)[:1], 300000, axis=0)
    refused = 0
    with concurrent.futures.ThreadPoolExecutor(1) as pool:
        batch = pool.submit(palpate.step_many, one, way, 0.001)
        while not batch.done():
            for call in (lambda: one.step(way[0]), lambda: one.work_j, one.reset, one.contact_table,
                         lambda: palpate.step_many(one, way[0])):
                try:
                    call()
                except palpate.InputError as error:
                    refused += "step_many() steps the renderer" in str(error)
        batch.result()
    assert refused > 0
    one.step(way[0])
