"""The examples run as their first lines say."""
import os
import pathlib
import subprocess
import sys

import numpy
import pytest

import layouts
import palpate

EXAMPLES = pathlib.Path(__file__).parents[2] / "python" / "examples"


def run(name, *arguments):
    done = subprocess.run([sys.executable, EXAMPLES / name, *map(str, arguments)], capture_output=True, text=True,
                          env={**os.environ, "MPLBACKEND": "Agg"}, timeout=300)
    assert done.returncode == 0, done.stderr
    return done.stdout


def is_picture(file):
    return file.read_bytes().startswith(b"\x89PNG") and file.stat().st_size > 5000


def test_stiffness_map(tmp_path):
    pytest.importorskip("matplotlib")
    said = run("stiffness_map.py", tmp_path / "map.png")
    assert is_picture(tmp_path / "map.png") and "N/m" in said.splitlines()[-1]


def test_lab_curves(tmp_path):
    files = [layout(tmp_path)[0] for layout in (layouts.plain, layouts.bluehill)]
    said = run("lab_curves.py", tmp_path / "lab.h5", 0.002, *files)
    assert said.count("E = ") == 3
    assert palpate.open(tmp_path / "lab.h5").tool().radius_m == 0.002


def test_haptic_loop(tmp_path):
    pytest.importorskip("matplotlib")
    said = run("haptic_loop.py", tmp_path / "energy.png")
    assert is_picture(tmp_path / "energy.png") and said.startswith("2000 ticks")
    assert float(said.split("at most ")[1].split()[0]) > 0.01


def test_pressed_body(tmp_path):
    pytest.importorskip("matplotlib")
    sys.path.insert(0, str(EXAMPLES))
    import haptic_loop
    haptic_loop.sheet().save(tmp_path / "sheet.h5")
    said = run("pressed_body.py", tmp_path / "sheet.h5", tmp_path / "pressed.png")
    assert is_picture(tmp_path / "pressed.png") and "no displacement" in said
    assert float(said.split()[1]) > 0.1


def test_newton_pressure():
    lines = run("newton_pressure.py").splitlines()
    assert len(lines) == 3 and all(abs(float(line.split("off ")[1].rstrip("%"))) < 1.0 for line in lines)


def test_drake_hydroelastic():
    lines = run("drake_hydroelastic.py", 0.02).splitlines()
    assert [line.split()[0] for line in lines] == ["modulus", "modulus", "over"]
    assert float(lines[0].split()[1]) > float(lines[1].split()[1])  # Hertz: a secant falls with depth
    assert "misses 20%" in lines[0] and "off -10%" in lines[0]


def test_torch_batch():
    said = run("torch_batch.py")
    assert said.startswith("10000 fingers: ") and float(said.split()[2]) > 0.01


def test_palpation_env():
    said = run("palpation_env.py")
    assert float(said.split()[1].rstrip(",")) > 0.0
    sys.path.insert(0, str(EXAMPLES))
    import haptic_loop
    import palpation_env
    env = palpation_env.PalpationEnv(haptic_loop.sheet(), limit=3)
    first, _ = env.reset(seed=2)
    assert numpy.array_equal(first, env.reset(seed=2)[0]) and first.shape == (6,)
    assert [env.step([0, 0, -0.001])[3] for _ in range(3)] == [False, False, True]
