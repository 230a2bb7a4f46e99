"""The package against the gold standard, closed forms, and the program's own arrays."""

import ast
import os
import subprocess
import threading
import time
from pathlib import Path

import numpy as np
import pytest

import flipmap
from flipmap import Status, Trust


def angles(width, height, center, side):
    """Angles of the pixels of a view `side` rad wide."""
    step = side / width
    across = center[0] + (np.arange(width) + 0.5 - width / 2) * step
    up = center[1] - (np.arange(height) + 0.5 - height / 2) * step
    return across, up


def test_flip_times_are_those_of_the_gold_standard():
    center, side = (2.0, 1.4), 0.5
    found = flipmap.render(center=center, width=side, size=(24, 16), budget=10)
    assert found.shape == (16, 24) and found.dtype.names == ("time", "status", "trust", "error")
    across, up = angles(24, 16, center, side)
    for row, column in [(0, 0), (3, 20), (8, 8), (15, 23), (10, 2)]:
        traced = flipmap.trace((across[column], up[row]), until=10, every=1)
        passes = [found.time for found in traced.passes if found.bob == 2]
        pixel = found[row, column]
        assert (pixel["status"] == Status.FLIPPED) == bool(passes)
        if passes:
            assert abs(pixel["time"] - passes[0]) < 1e-3


def test_the_whole_map_is_symmetric_and_says_what_is_forbidden():
    found = flipmap.render("lesson", size=32)
    assert np.array_equal(found["status"], found["status"][::-1, ::-1])
    forbidden = found["status"] == Status.FORBIDDEN
    assert forbidden[16, 16] and np.isnan(found["time"][forbidden]).all()
    assert np.isinf(found["time"][found["status"] == Status.UNFLIPPED]).all()
    assert found.seconds > 0 and "[view]" in found.scene and found.units == {"time": "s"}


def test_exact_marks_what_is_uncertain():
    found = flipmap.render(center=(-1.6601, 0.1003), width="1e-3", size=16, accuracy="exact", budget=40)
    assert (found["trust"] != Trust.UNCHECKED).all()
    assert np.array_equal(found.uncertain, found["trust"] == Trust.UNCERTAIN)
    sure = (found["status"] == Status.FLIPPED) & ~found.uncertain
    assert (found["error"][sure] < 1e-2).all()
    unchecked = flipmap.render(center=(2, 1.4), width=0.1, size=8)
    assert (unchecked["trust"] == Trust.UNCHECKED).all() and not unchecked.uncertain.any()
    assert np.isnan(unchecked["error"]).all()


def test_states_have_a_field_for_every_channel():
    found = flipmap.render(ask="state", at=2, center=(0, 0), width=1e-6, size=5, budget=2)
    assert found.channels.shape == (5, 5, 6) and list(found.units)[:2] == ["theta1", "theta2"]
    # So near to hanging the motion is linear: a pixel twice as far out has twice the angles, but for the
    # error of the integration (the cube of 1e-6 is smaller still).
    centre_row = found["theta1"][2]
    assert abs(centre_row[4] - 2 * centre_row[3]) < 1e-14


def test_small_oscillations_are_normal_modes():
    # Equal bobs: the slow mode has θ2 = √2 θ1 and ω² = (2 − √2) g / l.
    small = 1e-6
    traced = flipmap.trace((small, small * np.sqrt(2)), until=5, every=0.25)
    omega = np.sqrt((2 - np.sqrt(2)) * 9.81)
    assert np.abs(traced["theta1"] - small * np.cos(omega * traced["t"])).max() < 1e-14
    assert np.abs(traced["energy_error"]).max() < 1e-25
    assert len(traced) == 21 and traced.passes == []


def test_questions_add_columns_to_a_trace():
    traced = flipmap.trace((3, 3), until=2, every=0.5, ask="growth")
    assert traced.dtype.names[-1] == "exponent" and np.isnan(traced["exponent"][0])
    assert traced["exponent"][-1] > 0
    thrown = flipmap.trace("0.1,0,0,12", until=1, every=1)
    assert thrown["omega2"][0] == 12 and thrown.passes[0].anticlockwise


def test_every_digit_counts():
    center = ("8.4177543548844212457483172", "-5.2999695265772113618326545")
    found = flipmap.render("thrown", center=center, width="3e-20", budget=62, size=(6, 4))
    assert len(np.unique(found["time"])) > 1


def test_a_map_knows_its_scene_again(tmp_path):
    first = flipmap.render(ask="first", center=(2, 1.4), width=0.2, size=(8, 6), method="dop853")
    again = flipmap.render(first.scene, size=(8, 6))
    assert first.tobytes() == again.tobytes() and 'method = "dop853"' in again.scene
    path = tmp_path / "scene.toml"
    path.write_text(first.scene)
    assert first.tobytes() == flipmap.render(path, size=(8, 6)).tobytes()


@pytest.mark.parametrize(
    ("words", "error", "says"),
    [
        ({"widht": 1}, TypeError, "did you mean width"),
        ({"width": 0}, ValueError, "`width`"),
        ({"center": 1}, ValueError, "two numbers"),
        ({"scene": "filigre"}, ValueError, "did you mean filigree"),
        ({"scene": "/nowhere/a.toml"}, ValueError, "/nowhere/a.toml"),
        ({"scene": "[view]\nwidth = -3"}, ValueError, "line 2"),
        ({"size": 0}, ValueError, "between 1 and 1000000"),
        ({"accuracy": "best"}, ValueError, "`accuracy`"),
        ({"engine": "abacus"}, ValueError, "cpu or gpu"),
        ({"adapter": "no such card", "engine": "gpu"}, ValueError, "adapter"),
        ({"ask": "state", "rule": "either"}, ValueError, "`rule`"),
        ({"ask": "flips", "width": "1e-30", "center": "1,1"}, ValueError, "`width` is too small"),
    ],
)
def test_what_cannot_be_asked_for_is_said(words, error, says):
    with pytest.raises(error, match=says):
        flipmap.render(**{"size": 8, **words})


def test_a_trace_refuses_bad_numbers():
    for bad in [{"start": (1,)}, {"start": "a,b"}, {"until": -1}, {"until": 1e5, "every": 1e-9}]:
        with pytest.raises(ValueError):
            flipmap.trace(**{"start": (1, 1), **bad})


def test_progress_is_told_and_its_exceptions_stop_the_work():
    told = []
    flipmap.render("filigree", size=200, progress=lambda done, all: told.append((done, all)))
    assert told[-1] == (40_000, 40_000) and told == sorted(told)

    def stop(done, all):
        raise StopIteration("enough")

    with pytest.raises(StopIteration, match="enough"):
        flipmap.render("filigree", size=2000, progress=stop)


def test_an_interrupt_is_heard():
    import _thread

    for work in [
        lambda: flipmap.render("filigree", size=4000, accuracy="exact"),
        lambda: flipmap.trace((3, 3), until=1e6, every=1e3),
    ]:
        timer = threading.Timer(0.5, _thread.interrupt_main)
        timer.start()
        begun = time.monotonic()
        with pytest.raises(KeyboardInterrupt):
            work()
        assert time.monotonic() - begun < 5


@pytest.mark.skipif("FLIPMAP" not in os.environ, reason="FLIPMAP names no program to compare with")
@pytest.mark.parametrize("words", [{}, {"ask": "state", "at": 5}, {"accuracy": "lesson"}])
def test_arrays_are_the_programs_own(tmp_path, words):
    options = [part for name, value in words.items() for part in (f"--{name}", str(value))]
    command = [os.environ["FLIPMAP"], "render", "filigree", "--size", "48x32", "--engine", "cpu"]
    command += [*options, "--raw", "map.npy"]
    subprocess.run(command, cwd=tmp_path, check=True, capture_output=True)
    found = flipmap.render("filigree", size=(48, 32), engine="cpu", **words)
    assert np.array_equal(found.channels, np.load(tmp_path / "map.npy"), equal_nan=True)


def test_the_stubs_name_every_word_and_code():
    stubs = ast.parse((Path(flipmap.__file__).parent / "__init__.pyi").read_text())
    of = {node.name: node for node in stubs.body if isinstance(node, (ast.FunctionDef, ast.ClassDef))}
    arguments = {argument.arg for argument in of["render"].args.kwonlyargs}
    assert set(flipmap._flipmap.WORDS) <= arguments
    cut = {argument.arg for argument in of["tiles"].args.kwonlyargs}
    assert arguments - cut == {"engine", "adapter", "threads", "progress"}
    assert cut - arguments == {"across", "down"}
    written = {line.name for line in of["Map"].body if isinstance(line, ast.FunctionDef)}
    assert written == {name for name in vars(flipmap.Map) if name[0] != "_"}
    for codes in (Status, Trust):
        written = {line.targets[0].id: line.value.value for line in of[codes.__name__].body}
        assert written == {code.name: code.value for code in codes}
