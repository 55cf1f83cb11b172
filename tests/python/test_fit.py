import json
import signal
import subprocess

import numpy
import pytest

import layouts
import palpate


def tool_says(*arguments):
    """What `palpate-fit curve` prints, without what it says of the file and of the time."""
    done = subprocess.run([palpate.find_tool("palpate-fit"), "curve", *map(str, arguments), "--json"],
                          capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return own(json.loads(done.stdout))


def own(report):
    of_the_file = ("layout", "press", "depth_column", "force_column", "notes", "tip", "seconds")
    return {name: value for name, value in report.items() if name not in of_the_file}


def chosen(curves, arguments):
    """The press that the tool was asked for."""
    if not arguments:
        assert len(curves) == 1
        return curves[0]
    wanted = int(arguments[1])
    return next(curve for curve in curves
                if (curve.metadata["press"] if curve.metadata["presses"] > 1 else curve.metadata["number"]) == wanted)


@pytest.mark.parametrize("layout", layouts.ALL, ids=lambda layout: layout.__name__)
def test_every_layout_is_fitted_as_the_tool_does(layout, tmp_path):
    file, arguments = layout(tmp_path)
    curve = chosen(palpate.load(file), arguments)
    drift = layout is layouts.afm_hdf5  # whose times the tool takes unasked
    fit = palpate.fit(curve, drift=drift, tool="sphere", radius_m=0.002)
    assert own(fit.to_dict()) == tool_says(file, *arguments, "--tool", "sphere", "--radius-m", "0.002")
    assert fit.contact_point_m == fit.to_dict()["contact_point_m"]
    assert curve.metadata["file"] == str(file) and curve.metadata["layout"]
    # From 1 mm on, wherever the file has its zero.
    assert fit.contact_point_m - min(curve.depth_m) == pytest.approx(1e-3, abs=1e-4)


def test_options_mean_what_the_flags_mean(tmp_path):
    file, _ = layouts.plain(tmp_path)
    curve, = palpate.load(file)
    plate = tmp_path / "plate.csv"
    rows = ((0.02 * i, 1e3 * x, 5e4 * max(0.0, x - 1e-3)) for i, x in enumerate(numpy.linspace(0.0, 2e-3, 200).tolist()))
    plate.write_text("Time (s),Travel (mm),Load (N)\n" + "".join("{!r},{!r},{!r}\n".format(*row) for row in rows))
    for flags, arguments in [
            (["--time-column", "Time"], {}),
            (["--from-m", "0.0005", "--to-m", "0.003"], {"drift": False, "from_m": 0.0005, "to_m": 0.003}),
            (["--frame-stiffness-n-per-m", "5e4", "--frame-stiffness-sd-n-per-m", "100"],
             {"drift": False, "frame_stiffness_n_per_m": 5e4, "frame_stiffness_sd_n_per_m": 100.0}),
            (["--frame-run", plate], {"drift": False, "frame_run": palpate.load(plate)[0]}),
            (["--tool", "flat-punch", "--radius-m", "0.003", "--poissons-ratio", "0.4", "--thickness-m", "0.02"],
             {"drift": False, "tool": "flat-punch", "radius_m": 0.003, "poissons_ratio": 0.4, "thickness_m": 0.02}),
            (["--tool", "cone", "--half-angle-deg", "30", "--half-angle-sd-deg", "1"],
             {"drift": False, "tool": "cone", "half_angle_deg": 30.0, "half_angle_sd_deg": 1.0})]:
        assert own(palpate.fit(curve, **arguments).to_dict()) == tool_says(file, *flags), flags


def test_several_holds_are_one_law_as_with_the_tool(tmp_path):
    file, _ = layouts.stairs(tmp_path)
    curve, = palpate.load(file)
    before = {"to_m": layouts.STAIR_FREE_M + 4.9e-4}
    for flags, arguments in [
            (["--time-column", "Time"], {}),
            (["--to-m", before["to_m"], "--tool", "flat-punch", "--radius-m", "0.003"],
             {"drift": False, "tool": "flat-punch", "radius_m": 0.003, **before})]:
        fit = palpate.fit(curve, **arguments)
        tool = tool_says(file, *flags)
        assert fit.relaxation == tool["relaxation"] and fit.relaxation["press_and_hold"]["holds_used"] == 3
        assert own(fit.to_dict()) == tool and "several_holds" in tool["flags"]


@pytest.mark.parametrize("seed, holds_s", [(3, (720.0, 420.0, 240.0)), (4, (300.0, 300.0))])
def test_several_holds_tell_the_law_that_made_them(seed, holds_s):
    x, f, t = layouts.staircase(holds_s, seed)
    found = palpate.fit((x, f, t)).relaxation["press_and_hold"]
    assert found["holds"] == found["holds_used"] == len(holds_s) and len(found["terms"]) == 2
    for term, g, tau_s in zip(found["terms"], layouts.STAIR_G, layouts.STAIR_TAU_S):
        assert abs(term["g"] - g) < 4.0 * term["g_sd"] < 0.1 * g
        assert abs(term["tau_s"] - tau_s) < 4.0 * term["tau_sd_s"] < 0.25 * tau_s
    assert abs(found["g_inf"] - 0.45) < 4.0 * found["g_inf_sd"] < 0.05
    deepest_n = layouts.STAIR_N_PER_M * (found["curve"]["displacement_m"][-1] - layouts.STAIR_FREE_M)
    assert abs(found["curve"]["force_n"][-1] - deepest_n) < 4.0 * found["curve"]["force_sd_n"][-1] < 0.05 * deepest_n
    assert palpate.fit((-x, -f, t)).relaxation["press_and_hold"]["terms"] == found["terms"]


def test_relaxation_needs_times_and_two_holds():
    x, f, t = layouts.staircase()
    told = palpate.fit((x, f, t), drift=False)
    assert palpate.fit((x, f)).relaxation is None and "relaxation" not in palpate.fit((x, f)).to_dict()
    once = palpate.fit(layouts.staircase((600.0,)))
    assert once.relaxation is None and "relaxation" not in once.to_dict()
    # What is not needed is not refused.
    bad = numpy.where(t > 100.0, numpy.nan, t)
    without = palpate.fit((x, f, bad), drift=False)
    assert without.relaxation is None and without.contact_point_m == told.contact_point_m
    with pytest.raises(palpate.InputError, match="time_s"):
        palpate.fit((x, f, bad))
    assert "relaxation" not in palpate.table([told, without])


def test_a_stated_tip_is_taken_as_the_tool_takes_it(tmp_path):
    file, _ = layouts.optics11(tmp_path)
    curve, = palpate.load(file)
    assert curve.metadata["tip_radius_m"] == pytest.approx(25e-6)
    assert own(palpate.fit(curve, drift=False).to_dict()) == tool_says(file)
    assert numpy.array_equal(curve.metadata["position_m"][:2], [1e-6, 2e-6])


def test_columns_can_be_told(tmp_path):
    file = tmp_path / "two.csv"
    x, f, _ = layouts.curve()
    file.write_text("a,b,c\n" + "".join(f"{p!r},{q!r},0\n" for p, q in zip(x.tolist(), f.tolist())))
    with pytest.raises(palpate.InputError):
        palpate.load(file)
    curve, = palpate.load(file, depth_column="a", depth_unit="mm", force_column="2", force_unit="kN")
    assert numpy.allclose(curve.depth_m, x * 1e-3, rtol=1e-15) and numpy.allclose(curve.force_n, f * 1e3, rtol=1e-15)
    assert curve.time_s is None and set(curve) == {"depth_m", "force_n"}
    with pytest.raises(palpate.InputError, match="time_column"):
        palpate.load(file, depth_column="a", depth_unit="m", force_column="b", force_unit="N", time_unit="s")


def test_arrays_pairs_and_mappings_are_curves():
    x, f, t = layouts.curve()
    wanted = own(palpate.fit(palpate.Curve(x, f)).to_dict())
    for same in ((x, f), [x.tolist(), f.tolist()], {"depth_m": x, "force_n": f}, (numpy.repeat(x, 2)[::2], f, None)):
        assert own(palpate.fit(same).to_dict()) == wanted
    assert own(palpate.fit((x, f, t), drift=False).to_dict()) == wanted
    assert palpate.fit((x, f, t)).to_dict()["corrections"] != wanted["corrections"]


@pytest.mark.parametrize("wrong", [
    None, 3, "abc", ([0.0, 1.0],), ([1, 2], [1, 2, 3]), ([[1, 2]], [[1, 2]]), ([1, numpy.nan] * 10, [1, 2] * 10),
    (["a"] * 20, [1] * 20), ([1, 2, 3], [1, 2, 3]), ([0.0] * 20, [0.0] * 20), {"depth_m": [1, 2]},
    (range(20), range(20), range(19))])
def test_wrong_curves_are_refused(wrong):
    with pytest.raises(palpate.InputError):
        palpate.fit(wrong)


@pytest.mark.parametrize("forces, times", [(19, 20), (21, 20), (20, 19), (20, 21)])
def test_as_many_depths_forces_and_times_are_needed(forces, times):
    with pytest.raises(palpate.InputError, match=f"^20 depths, {forces} forces and {times} times"):
        palpate.fit((range(20), range(forces), range(times)))


@pytest.mark.parametrize("options, kind, says", [
    ({"tool": "needle"}, palpate.InputError, "needle"), ({"tool": "sphere"}, palpate.InputError, "radius_m"),
    ({"tool": "sphere", "radius_m": -1.0}, palpate.InputError, "radius_m is -1"),
    ({"radius_m": 1.0}, palpate.InputError, "tool"), ({"tool": "cone", "half_angle_deg": 95.0}, palpate.InputError, "90"),
    ({"frame_stiffness_sd_n_per_m": 1.0}, palpate.InputError, "frame_stiffness_n_per_m"),
    ({"frame_stiffness_n_per_m": 0.0}, palpate.InputError, ""), ({"colour": "red"}, TypeError, "colour"),
    ({"tool": "sphere", "radius_m": "big"}, TypeError, "radius_m"), ({"from_m": 1.0}, palpate.InputError, "")])
def test_wrong_options_are_refused_by_the_name_of_the_argument(options, kind, says):
    x, f, _ = layouts.curve()
    with pytest.raises(kind, match=says):
        palpate.fit((x, f), **options)


def test_a_fit_becomes_a_database_as_with_the_tool(tmp_path):
    file, _ = layouts.plain(tmp_path)
    curve, = palpate.load(file, time=False)
    flags = ["--tool", "sphere", "--radius-m", "0.002", "-o", str(tmp_path / "tool.h5")]
    tool_says(file, *flags)
    fit = palpate.fit(curve, tool="sphere", radius_m=0.002)
    db = fit.database(file)
    db.save(tmp_path / "own.h5")
    assert (tmp_path / "own.h5").read_bytes() == (tmp_path / "tool.h5").read_bytes()
    depth = db.tool().curve(0)["depth_m"]
    assert numpy.allclose(fit.force(depth), db.tool().curve(0)["force_n"], rtol=1e-9, atol=1e-12)
    assert fit.force(numpy.zeros((2, 3))).shape == (2, 3) and fit.force([-1.0]) == fit.force([0.0])
    assert fit.database().provenance["source_file"] == "" and db.provenance["source_file"] == "plain.csv"
    with pytest.raises(palpate.InputError, match="none is given"):
        palpate.fit(curve).database()


def test_a_table_has_an_entry_for_each_fit():
    fits = [palpate.fit(layouts.curve(seed)[:2], tool="sphere", radius_m=0.002) for seed in range(3)]
    table = palpate.table(fits)
    assert table["youngs_modulus_pa"].tolist() == [fit.youngs_modulus_pa for fit in fits]
    assert {len(column) for column in table.values()} == {3} and table["family"][0] == "power_law"
    assert numpy.isnan(palpate.table([palpate.fit(layouts.curve()[:2])])["youngs_modulus_pa"]).all()
    assert palpate.table([]) == {}
    pandas = pytest.importorskip("pandas")
    assert len(pandas.DataFrame(table)) == 3
    assert list(pandas.DataFrame(dict(palpate.Curve(*layouts.curve()))).columns) == ["depth_m", "force_n", "time_s"]


def test_presses_that_cannot_be_read_are_left_out_with_a_warning(tmp_path):
    import h5py
    file, _ = layouts.afm_hdf5(tmp_path)
    with h5py.File(file, "a") as h5:
        del h5["1/force"]
    with pytest.warns(UserWarning, match="left out"):
        curves = palpate.load(file)
    assert [curve.metadata["number"] for curve in curves] == [0]
    with h5py.File(file, "a") as h5:
        del h5["0/force"]
    with pytest.warns(UserWarning), pytest.raises(palpate.InputError, match="no press"):
        palpate.load(file)
    with pytest.raises(palpate.InputError):
        palpate.load(tmp_path / "nothing.csv")
    with pytest.raises(TypeError):
        palpate.load(3)


def places(n=12):
    """Points of the flat sheet, their curves: stiffer towards +x."""
    random = numpy.random.default_rng(3)
    at = numpy.column_stack([random.uniform(0.002, 0.038, (n, 2)), numpy.zeros(n)])
    return at, [layouts.curve(i, 60, 1.0 + 20.0 * p[0])[:2] for i, p in enumerate(at)]


@pytest.fixture(scope="module")
def session(tmp_path_factory):
    """As a laboratory has it: files, and a session that names them."""
    import conftest
    folder = tmp_path_factory.mktemp("session")
    vertices, triangles = conftest.sheet()
    (folder / "body.obj").write_text(
        "".join(f"v {x!r} {y!r} {z!r}\n" for x, y, z in vertices.tolist())
        + "".join(f"f {a + 1} {b + 1} {c + 1}\n" for a, b, c in triangles.tolist()))
    text = ('[read]\ndepth_column = "x"\ndepth_unit = "m"\nforce_column = "f"\nforce_unit = "N"\n'
            '[indenter]\nshape = "sphere"\nradius_m = 0.002\n[body]\nmesh = "body.obj"\nlength_unit = "m"\n')
    for i, (at, (x, f)) in enumerate(zip(*places())):
        (folder / f"{i}.csv").write_text("x,f\n" + "".join(f"{a!r},{b!r}\n" for a, b in zip(x.tolist(), f.tolist())))
        text += f'[[run]]\nfile = "{i}.csv"\nposition_m = {at.tolist()}\n'
    (folder / "session.toml").write_text(text)
    return folder / "session.toml"


@pytest.fixture(scope="module")
def surface(session):
    return palpate.fit_surface(session)


def without_time(report):
    return {name: value for name, value in report.items() if name != "seconds"}


def test_a_surface_is_fitted_as_the_tool_does(session, surface, tmp_path):
    done = subprocess.run([palpate.find_tool("palpate-fit"), "surface", session, "-o", tmp_path / "tool.h5", "--json"],
                          capture_output=True, text=True, check=True)
    fit = surface
    assert without_time(fit.to_dict()) == without_time(json.loads(done.stdout))
    fit.database.save(tmp_path / "own.h5")
    assert (tmp_path / "own.h5").read_bytes() == (tmp_path / "tool.h5").read_bytes()
    table = fit.table()
    assert table["depth_m"].size == len(fit.to_dict()["left_one_out"]) > 0


def test_a_surface_of_arrays_is_that_of_the_files(surface):
    import conftest
    at, curves = places()
    by_files = surface
    by_arrays = palpate.fit_surface(curves, positions=at, mesh=conftest.sheet(), radius_m=0.002)
    assert without_time(by_arrays.to_dict()) == without_time(by_files.to_dict())
    one, other = by_arrays.database.tool(), by_files.database.tool()
    assert numpy.array_equal(one.force_n, other.force_n) and numpy.array_equal(one.depth_m, other.depth_m)
    for wrong in ({"positions": at[:5]}, {"positions": None}, {"mesh": (at, [[0, 1, 99]])}, {"normals": at[:, :2]},
                  {"radius_m": -1.0}, {"radius_m": None}):
        with pytest.raises(palpate.InputError):
            palpate.fit_surface(curves, **{"positions": at, "mesh": conftest.sheet(), "radius_m": 0.002, **wrong})


def test_all_runs_of_a_session_are_those_of_batch(session, tmp_path):
    subprocess.run([palpate.find_tool("palpate-fit"), "batch", session, "-o", tmp_path, "--quiet"], check=True,
                   capture_output=True)

    def strip(value):
        if isinstance(value, dict):
            return {k: strip(v) for k, v in value.items() if not k.startswith("seconds")}
        return [strip(part) for part in value] if isinstance(value, list) else value
    assert strip(palpate.fit_session(session)) == strip(json.loads((tmp_path / "results.json").read_text()))
    with pytest.raises(palpate.InputError):
        palpate.fit_session(tmp_path / "nothing.toml")


@pytest.mark.parametrize("threads", [1, 4])
def test_a_session_tells_its_progress_and_ends_when_told(session, threads):
    told = []
    palpate.fit_session(session, threads=threads, progress=lambda *of: told.append(of))
    assert sorted(told) == [(i, 12) for i in range(1, 13)]

    def stop(done, files):
        told.append(done)
        raise KeyError(done)
    told.clear()
    with pytest.raises(KeyError):
        palpate.fit_session(session, threads=threads, progress=stop)
    assert len(told) <= threads  # those that were under way
    before = signal.signal(signal.SIGALRM, lambda *_: stop(0, 0))
    try:
        signal.setitimer(signal.ITIMER_REAL, 0.02)
        with pytest.raises(KeyError):
            while True:
                palpate.fit_session(session, threads=threads)
    finally:
        signal.signal(signal.SIGALRM, before)


def test_memory_is_steady(tmp_path, grown_kilobytes):
    curve = layouts.curve(1, 40)
    file, _ = layouts.plain(tmp_path)
    assert grown_kilobytes(lambda: palpate.load(file), 1200) < 400
    assert grown_kilobytes(lambda: palpate.fit(curve, tool="sphere", radius_m=0.002).to_dict(), 150) < 1024
