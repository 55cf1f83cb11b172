import os
import threading
import time

import numpy
import pytest

import c_interface
import palpate
from conftest import block

MODELS = ["potential", "element", "energy-tank", "equal-energy"]
TOP_M = 0.02 + 0.01  # height at which the ball touches the block


@pytest.fixture(scope="session")
def file(built, tmp_path_factory):
    file = tmp_path_factory.mktemp("built") / "block.h5"
    built.save(file)
    return file


def path(n=1500):
    """Down on the block, along it, and up."""
    turn = numpy.linspace(0.0, 2.0 * numpy.pi, n)
    depth = numpy.interp(numpy.arange(n), [0, n // 5, 4 * n // 5, n], [-0.001, 0.002, 0.001, -0.001])
    return numpy.column_stack([0.02 + 0.008 * numpy.sin(turn), 0.02 + 0.006 * numpy.sin(2 * turn), TOP_M - depth])


def turned(n=1500):
    tilt = 0.1 * numpy.sin(numpy.linspace(0.0, 3.0, n))
    return numpy.column_stack([numpy.zeros(n), numpy.sin(tilt), 0.3 * tilt, numpy.cos(tilt)])


def account_of(renderer):
    return [renderer.work_j, renderer.stored_j, renderer.tank_j, renderer.dissipated_j, renderer.rest_offset_m,
            renderer.depth_m, *renderer.contact_point, *renderer.normal, renderer.triangle, renderer.ticks]


def account_by_c(state):
    return [state.work_j, state.stored_j, state.tank_j, state.dissipated_j, state.rest_offset, state.depth,
            *state.contact_point, *state.normal, state.triangle, state.ticks]


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("from_file", [False, True])
def test_bits_are_those_of_the_c_interface(built, file, model, from_file):
    renderer = palpate.Renderer(file if from_file else built, "ball", model)
    host = c_interface.Host(file, tool_name="ball", model=model)
    largest = 0.0
    for i, x in enumerate(path()):
        status, wanted, _ = host.wrench(x, None, 0.001)
        force = renderer.step(x, 0.001)
        assert force.tobytes() == wanted.tobytes(), i
        assert renderer.in_contact == (status == 1)
        assert account_of(renderer) == account_by_c(host.state()), i
        largest = max(largest, force[2])
        if i % 10 == 0:
            assert renderer.slow_step() == host.slow_step()
    host.close()
    assert largest > 0.02 and renderer.dissipated_j > 0.0


def test_poses_and_torques_are_those_of_the_c_interface(built, file):
    renderer = palpate.Renderer(built, "pads")
    host = c_interface.Host(file, tool_name="pads")
    largest = 0.0
    for i, (x, q) in enumerate(zip(path(), turned())):
        _, force, torque = host.wrench(x, q, 0.001)
        got = renderer.wrench(x, q, 0.001)
        assert (got[0].tobytes(), got[1].tobytes()) == (force.tobytes(), torque.tobytes()), i
        assert numpy.array_equal(renderer.torque, torque)
        largest = max(largest, abs(torque[1]))
        if i % 10 == 0:
            assert renderer.slow_step() == host.slow_step()
    host.close()
    assert largest > 1e-4


def test_two_hands_sink_the_body_under_each_other_wherever_it_stands(built):
    one = palpate.Renderer(built, "pads")
    two = palpate.Renderer(built, "pads", second_tool="")
    placed = palpate.Renderer(built, "pads", second_tool="pads")
    turn = numpy.array([0.0, 0.0, numpy.sin(0.7), numpy.cos(0.7)])  # about z
    c, s = numpy.cos(1.4), numpy.sin(1.4)
    world = numpy.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    placed.place([0.1, 0.2, 0.3], turn)
    most = (0.0, 0.0, 0)
    aside = numpy.array([[0.0, -0.004, 0.0], [0.0, 0.004, 0.0]])
    for i, x in enumerate(path()):
        alone, _ = one.wrench(x + aside[0], None, 0.001)
        force, torque = two.wrench(x + aside, None, 0.001)
        poses = (x + aside) @ world.T + [0.1, 0.2, 0.3]
        elsewhere, _ = placed.wrench(poses, [turn, turn], 0.001)
        if i % 10 == 0:
            for each in (one, two, placed):
                each.slow_step()
        assert force.shape == torque.shape == two.force.shape == (2, 3)
        assert numpy.allclose(elsewhere, force @ world.T, atol=1e-9), i
        if alone[2] > most[0]:
            most = (alone[2], force[0, 2], two.contacts)
        if i % 50 == 0:  # what is drawn is what is felt, where it is felt
            here, there = two.contact_table(), placed.contact_table()
            felt = [here["force_n"][here["hand"] == hand].sum(axis=0) for hand in (0, 1)]
            assert here["radius_m"].size == 4 and numpy.allclose(felt, force, atol=1e-12), i
            assert numpy.allclose(there["force_n"], here["force_n"] @ world.T, atol=1e-9)
            assert numpy.allclose(there["centre_m"], here["centre_m"] @ world.T + [0.1, 0.2, 0.3], atol=1e-12)
            assert numpy.all(here["own_depth_m"] <= here["depth_m"] + 1e-12)
    assert 0.01 < most[1] < 0.97 * most[0] and most[2] == 4
    assert numpy.allclose(placed.vertices, built.vertices @ world.T + [0.1, 0.2, 0.3], atol=1e-12)
    assert two.displaced() is None
    with pytest.raises(palpate.InputError, match="one for each of 2 hands"):
        two.step(numpy.zeros((3, 3)))
    with pytest.raises(palpate.InputError, match="three|3"):
        one.step(numpy.zeros((2, 3)))
    with pytest.raises(palpate.InputError, match="place"):
        placed.place([0.0, numpy.nan, 0.0])


def test_turns_that_are_not_felt_and_what_was_delivered_are_those_of_the_c_interface(built, file):
    renderer = palpate.Renderer(built, "pads")
    host = c_interface.Host(file, tool_name="pads")
    felt = palpate.Renderer(built, "pads")
    apart = 0.0
    for i, (x, q) in enumerate(zip(path(), turned())):
        _, wanted = host.force(x, q, 0.001)
        force = renderer.step(x, 0.001, orientation=q)
        assert force.tobytes() == wanted.tobytes(), i
        apart = max(apart, abs(felt.wrench(x, q, 0.001)[0] - force).max())
        renderer.delivered(0.9 * force)
        assert host.delivered(0.9 * force) == 0
        for each in (renderer, felt, host):
            each.slow_step() if i % 10 == 0 else None
        assert renderer.work_j == host.state().work_j
    host.close()
    assert apart > 1e-4
    with pytest.raises(palpate.InputError, match="finite"):
        renderer.delivered([0.0, numpy.nan, 0.0])


def test_options_are_those_of_the_c_interface(built, file):
    renderer = palpate.Renderer(built, "ball", force_max_n=0.03, ramp_s=0.2, tick_s=0.002, position_gain=2.0,
                                force_gain=0.5)
    host = c_interface.Host(file, tool_name="ball", force_max=0.03, ramp=0.2, tick=0.002, position_gain=2.0,
                            force_gain=0.5)
    for x in path(400):
        assert renderer.step(x).tobytes() == host.wrench(x, None, 0.0)[1].tobytes()
        renderer.slow_step(), host.slow_step()
    host.close()
    # 0.5 K T / 2 of the tick 0.002: position_gain force_gain = 1.
    one = palpate.Renderer(built, "ball").needed_damping_n_s_per_m
    assert one > 0.0 and renderer.needed_damping_n_s_per_m == pytest.approx(2.0 * one, rel=0.5)


def test_a_device_that_cannot_render_the_stiffness_is_refused_or_scaled(built):
    with pytest.raises(palpate.InputError, match="cannot render"):
        palpate.Renderer(built, "ball", damping_n_s_per_m=1e-6)
    scaled = palpate.Renderer(built, "ball", damping_n_s_per_m=1e-3, limit_stiffness=True)
    assert 0.0 < scaled.force_scale < 1.0


def test_the_account_closes_at_every_tick(built):
    renderer = palpate.Renderer(built, "ball")
    for x in path():
        renderer.step(x, 0.001)
        renderer.slow_step()
        held = renderer.stored_j + renderer.tank_j + renderer.dissipated_j + renderer.memory_j
        assert renderer.work_j == pytest.approx(held, abs=1e-12)
        assert min(renderer.tank_j, renderer.dissipated_j, renderer.memory_j) >= 0.0
    assert renderer.fault == "none" and renderer.work_j > 0.0


def press(renderer, ticks=400):
    for depth in numpy.linspace(-0.001, 0.001, ticks):
        force = renderer.step([0.02, 0.02, TOP_M - depth], 0.001)
        time.sleep(0.0002)
    return force


def test_a_thread_does_the_slow_steps(built):
    renderer = palpate.Renderer(built, "ball", slow_hz=500)
    with renderer as same:
        assert same is renderer and renderer.running
        assert press(renderer)[2] > 0.005
        with pytest.raises(palpate.InputError, match="thread"):
            renderer.slow_step()
        renderer.start()  # nothing happens
    assert not renderer.running
    renderer.stop()
    renderer.start()
    assert press(renderer)[2] > 0.005
    with_thread = len(os.listdir("/proc/self/task"))
    del renderer, same
    for _ in range(100):  # the kernel strikes it off a little later
        if len(os.listdir("/proc/self/task")) < with_thread:
            return
        time.sleep(0.05)
    pytest.fail("the thread goes on")


def test_starting_and_ending_from_many_threads_is_one_at_a_time(built):
    renderer = palpate.Renderer(built, "ball")

    def turn():
        for _ in range(20):
            renderer.start()
            renderer.stop()
    threads = [threading.Thread(target=turn) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    renderer.stop()
    assert not renderer.running


def test_faults_are_raised_until_reset(built):
    renderer = palpate.Renderer(built, "ball")
    for _ in range(2):
        with pytest.raises(palpate.RenderingFault, match="not-finite"):
            renderer.step([0.02, numpy.nan, 0.03] if renderer.ticks == 0 else [0.02, 0.02, 0.03], 0.001)
    assert renderer.fault == "not-finite" and not renderer.force.any()
    renderer.reset()
    assert renderer.fault == "none" and not renderer.step([0.02, 0.02, 0.04], 0.001).any()
    for wrong in (-0.001, 1.5, numpy.nan):
        with pytest.raises(palpate.RenderingFault, match="time-step"):
            renderer.step([0.02, 0.02, 0.04], wrong)
        renderer.reset()


def test_without_slow_steps_a_contact_stalls_and_says_what_to_do(built):
    renderer = palpate.Renderer(built, "ball")
    for x in path(300)[:40]:
        renderer.step(x, 0.001)
        renderer.slow_step()
    with pytest.raises(palpate.RenderingFault, match="slow_step"):
        for _ in range(600):
            renderer.step(path(300)[40], 0.001)


@pytest.mark.parametrize("wrong", [None, "abc", 1.0, [1, 2], [1, 2, 3, 4], [[1, 2, 3]], [1, 2, None], numpy.zeros(2),
                                   numpy.zeros(3, complex)])
def test_wrong_positions_are_refused_and_move_nothing(built, wrong):
    renderer = palpate.Renderer(built, "ball")
    with pytest.raises(palpate.InputError):
        renderer.step(wrong, 0.001)
    if wrong is not None:  # no orientation: turns are not felt
        with pytest.raises(palpate.InputError, match="orientation"):
            renderer.wrench([0, 0, 1], wrong if numpy.shape(wrong) != (4,) else [1, 2], 0.001)
    assert renderer.ticks == 0


def test_positions_of_any_layout_are_taken(built):
    x = path(50)
    wanted = palpate.Renderer(built, "ball")
    for same in (lambda p: p.tolist(), lambda p: tuple(p), lambda p: p.astype(">f8"), lambda p: p[::-1].copy()[::-1],
                 lambda p: numpy.repeat(p, 2)[::2]):
        other = palpate.Renderer(built, "ball")
        wanted.reset()
        for p in x:
            assert other.step(same(p), 0.001).tobytes() == wanted.step(p, 0.001).tobytes()
            other.slow_step(), wanted.slow_step()


def test_wrong_options_are_refused(built, file, tmp_path):
    for options, kind in [({"model": "single"}, palpate.InputError), ({"tool": "needle"}, palpate.InputError),
                          ({"tick_s": -1.0}, palpate.InputError), ({"force_max_n": numpy.nan}, palpate.InputError),
                          ({"stiffness": 3}, TypeError), ({"tick_s": "fast"}, TypeError),
                          ({"streamed": True}, palpate.InputError)]:
        with pytest.raises(kind):
            palpate.Renderer(built, **{"tool": "ball", **options})
    with pytest.raises(palpate.InputError):
        palpate.Renderer(tmp_path / "nothing.h5")
    with pytest.raises(TypeError):
        palpate.Renderer(3)


def test_a_streamed_file_gives_the_same_bits(built, file):
    whole, streamed = palpate.Renderer(built, "ball"), palpate.Renderer(file, "ball", streamed=True)
    for x in path(600):
        assert whole.step(x, 0.001).tobytes() == streamed.step(x, 0.001).tobytes()
        whole.slow_step(), streamed.slow_step()


def test_a_body_that_yields_keeps_its_dents_in_a_file(tmp_path):
    soft = {"region": "body", "law": "linear", "youngs_modulus_pa": 5000.0, "poissons_ratio": 0.4,
            "plastic": {"yield_depth_m": 0.0003, "share": 0.5}}
    file, kept = tmp_path / "soft.h5", tmp_path / "kept.h5"
    db = palpate.build(
        {"body": {"mesh": block()}, "material": [soft], "support": [{"box_m": [[-1, -1, -1], [1, 1, 0.001]]}],
         "tool": [{"name": "ball", "shape": "sphere", "radius_m": 0.01}],
         "reach": {"box_m": [[0.009, 0.009, 0.019], [0.031, 0.031, 1]], "depth_max_m": 0.003},
         "accuracy": {"force_relative": 0.5, "verify": 0, "depths": 3}}, output=file)

    def pressed(renderer):
        total = 0.0
        for depth in [*numpy.linspace(-0.001, 0.001, 300), *numpy.linspace(0.001, 0.0006, 100)]:
            total += renderer.step([0.02, 0.02, TOP_M - depth], 0.001)[2]
            renderer.slow_step()
        return total
    renderer = palpate.Renderer(file)
    first = pressed(renderer)
    assert renderer.yielded_j > 0.0 and renderer.dent_m > 0.0
    renderer.save_surface(kept)
    renderer.reset()
    again = pressed(renderer)
    other = palpate.Renderer(file)
    other.load_surface(kept)
    assert pressed(other) == again < first
    other.load_surface()
    assert pressed(other) == first
    with pytest.raises(palpate.InputError, match="force depends"):
        db.force([0.02, 0.02, TOP_M])
    in_memory = palpate.Renderer(db)
    for wrong in (lambda: in_memory.save_surface(kept), lambda: in_memory.load_surface(kept),
                  lambda: other.load_surface(tmp_path / "nothing.h5")):
        with pytest.raises(palpate.InputError):
            wrong()
    with other, pytest.raises(palpate.InputError, match="stop"):
        other.save_surface(kept)


def test_a_renderer_outlives_its_database(flat):
    renderer = palpate.Renderer(flat)
    del flat
    for depth in numpy.linspace(-0.001, 0.002, 300):
        force = renderer.step([0.02, 0.02, 0.005 - depth], 0.001)
        renderer.slow_step()
    assert force[2] == pytest.approx(200.0 * 0.002, rel=1e-9)


def test_a_forked_child_has_no_thread_and_does_not_wait_for_it(built):
    renderer = palpate.Renderer(built, "ball")
    renderer.start()
    child = os.fork()
    if child == 0:
        try:
            renderer.stop()
        except palpate.InputError:
            own = palpate.Renderer(built, "ball")
            own.step([0.02, 0.02, 0.04], 0.001)
            assert not renderer.running
            del renderer  # would wait for ever
            os._exit(0)
        os._exit(1)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0
    renderer.stop()


def test_memory_is_steady(built, grown_kilobytes):
    renderer = palpate.Renderer(built, "ball", stall_s=1e9)
    x = numpy.array([0.02, 0.02, TOP_M - 0.001])

    def call():
        renderer.step(x, 0.001)
        renderer.wrench([0.02, 0.02, 0.04], [0, 0, 0, 1], 0.001)
        renderer.slow_step()
        _ = renderer.force, renderer.work_j, renderer.fault
    assert grown_kilobytes(call, 100000) < 1024

    def make():
        palpate.Renderer(built, "ball").step(x, 0.001)
    assert grown_kilobytes(make, 100) < 2048


def test_a_scene_is_rendered_while_it_is_computed(tmp_path):
    from palpate._mesh import write_obj
    from palpate._toml import toml
    from test_tools import SCENE
    write_obj(tmp_path / "block.obj", *block())
    scene, output = tmp_path / "scene.toml", tmp_path / "out.h5"
    scene.write_text(toml({"body": {"mesh": str(tmp_path / "block.obj"), "length_unit": "m"}, **SCENE}))
    at = numpy.array([0.02, 0.02, TOP_M])
    answers = []

    def press(renderer):
        renderer.reset()
        for height_m in numpy.linspace(0.002, -0.002, 400):
            force = renderer.step(at + [0.0, 0.0, height_m], 0.001)
            renderer.slow_step()
        return force

    renderer = palpate.Renderer(scene, estimate=True, output=output)
    assert renderer.service["state"] in ("serving", "done")
    until = time.monotonic() + 60.0
    while renderer.service["state"] != "done" and time.monotonic() < until:
        press(renderer)
        answers.append(renderer.answer)
        time.sleep(0.05)
    assert renderer.service["state"] == "done" and renderer.service["finished"] > 0, renderer.service
    meanwhile = press(renderer)
    assert renderer.answer == "final" and set(answers) <= {"none", "estimated", "preliminary", "final"}
    whole = palpate.Renderer(output)
    assert (whole.answer, whole.service) == ("final", None)
    assert press(whole)[2] == pytest.approx(meanwhile[2], rel=0.02) and meanwhile[2] > 0.01
    with pytest.raises(palpate.InputError):
        palpate.Renderer(tmp_path / "missing.toml")
    with pytest.raises(TypeError):
        palpate.Renderer(output, estimate=True)
