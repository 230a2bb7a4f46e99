"""Arguments: what is taken, and that the rest is refused in one sentence that names it."""

from decimal import Decimal
from pathlib import Path

import numpy as np
import pytest

import flipmap
from flipmap import _memory

VIEW = {"center": (2.0, 1.4), "width": 0.1, "budget": 3}


@pytest.mark.parametrize(
    "size",
    [(5, 4), [5, 4], np.array([5, 4]), (np.int64(5), np.uint8(4)), np.array([5, 4], "u2")],
)
def test_sizes_are_whole_numbers_of_any_kind(size):
    assert flipmap.render(size=size, **VIEW).shape == (4, 5)


@pytest.mark.parametrize("side", [3, np.int32(3), np.array(3)])
def test_one_whole_number_is_a_square(side):
    assert flipmap.render(size=side, **VIEW).shape == (3, 3)


@pytest.mark.parametrize(
    ("size", "error"),
    [
        (8.0, TypeError),
        ((8.0, 8), TypeError),
        (np.array([8.0, 8.0]), TypeError),
        (np.ones((2, 2), int), TypeError),
        ("8x8", TypeError),
        ("8", TypeError),
        (True, TypeError),
        ((8, np.True_), TypeError),
        (None, TypeError),
        ({8, 9}, TypeError),
        ((1, 2, 3), ValueError),
        ((), ValueError),
        (-8, ValueError),
        ((8, 0), ValueError),
        (2**70, ValueError),
    ],
)
def test_other_sizes_are_refused_in_our_words(size, error):
    with pytest.raises(error) as refused:
        flipmap.render(size=size)
    said = str(refused.value)
    assert said.startswith("`size` is ") and "between 1 and 1000000" in said and "\n" not in said


@pytest.mark.parametrize(
    ("words", "error", "says"),
    [
        ({"accuracy": 3}, TypeError, "`accuracy` is 3; it must be one of lesson, fast"),
        ({"method": 4.5}, TypeError, "`method` is 4.5; it must be the name of a method"),
        ({"precision": 64}, TypeError, "`precision` is 64; it must be one of f32"),
        ({"engine": True}, TypeError, "`engine` is True; it must be cpu or gpu"),
        ({"engine": "abacus"}, ValueError, "`engine` is 'abacus'; it must be cpu or gpu"),
        ({"adapter": 0}, TypeError, "`adapter` is 0; it must be a part"),
        ({"verify": "yes"}, TypeError, "`verify` is 'yes'; it must be True or False"),
        ({"threads": 1.5}, TypeError, "`threads` is 1.5; it must be a whole number between 1"),
        ({"threads": 0}, ValueError, "`threads` is 0; it must be a whole number between 1"),
        ({"threads": -1}, ValueError, "`threads` is -1; it"),
        ({"progress": 1}, TypeError, "`progress` is 1; it must be a function"),
        ({"scene": 5}, TypeError, "`scene` is 5; it must be a scene's name"),
        ({"scene": b"home"}, TypeError, "`scene` is b'home'; it"),
        ({"step": [None]}, TypeError, "`step` is [None]; it must be a number"),
        ({"tolerance": 1j}, TypeError, "`tolerance` is 1j; it must be a number"),
        ({"center": "x"}, ValueError, "`center` is 'x'; it must be two numbers"),
        ({"center": {1, 2}}, TypeError, "`center` is {1, 2}; it must be a number"),
        ({"center": (1, None)}, TypeError, "`center` is (1, None); it must be a number"),
        ({"width": True}, TypeError, "`width` is True; it must be a number"),
        ({"width": b"1"}, TypeError, "`width` is b'1'; it"),
        ({"budget": "long"}, ValueError, "`budget` is 'long'; it must be auto or a number"),
        ({"budget": float("nan")}, ValueError, "`budget` is 'nan'; it"),
    ],
)
def test_other_arguments_are_refused_in_our_words(words, error, says):
    with pytest.raises(error) as refused:
        flipmap.render(**{"size": 8, **words})
    assert says in str(refused.value) and "\n" not in str(refused.value)


@pytest.mark.parametrize(
    ("words", "says"),
    [
        ({"start": None}, "`start` is None; it"),
        ({"until": {}}, "`until` is {}; it"),
        ({"every": True}, "`every` is True; it"),
        ({"scene": 5}, "`scene` is 5; it"),
    ],
)
def test_a_trace_refuses_other_kinds_in_our_words(words, says):
    with pytest.raises(TypeError) as refused:
        flipmap.trace(**{"start": (1, 1), **words})
    assert says in str(refused.value)


@pytest.mark.parametrize(
    "number", [0.25, "0.25", Decimal("0.25"), np.float32(0.25), np.float64(0.25), np.array(0.25)]
)
def test_numbers_are_taken_of_any_kind(number):
    words = {**VIEW, "width": number, "center": np.array([2.0, 1.5])}
    found = flipmap.render(size=2, **words)
    assert found.tobytes() == flipmap.render(size=2, **{**words, "width": 0.25}).tobytes()


def test_a_scene_is_a_path_too():
    with pytest.raises(ValueError, match="nowhere.toml"):
        flipmap.render(Path("nowhere.toml"), size=2)


def test_a_map_that_does_not_fit_is_refused_before_any_work():
    told = []
    with pytest.raises(MemoryError) as refused:
        flipmap.render(size=10**6, progress=lambda done, all: told.append(done))
    assert told == [] and "\n" not in str(refused.value)
    assert str(refused.value).startswith("`size` is 1000000x1000000; the map needs 28000000000000")
    with pytest.raises(MemoryError, match="100000000000000 bytes"):
        flipmap.render(size=10**6, ask="state")


def test_the_room_decides_and_so_does_the_largest_count(monkeypatch):
    monkeypatch.setattr(_memory, "available", lambda: 100 * 100 * 28)
    assert flipmap.render(size=100, **VIEW).shape == (100, 100)
    with pytest.raises(MemoryError, match="needs 282800 bytes of memory, and 280000 are"):
        flipmap.render(size=(101, 100), **VIEW)
    monkeypatch.setattr(_memory, "available", lambda: None)
    with pytest.raises(ValueError, match="at most 4294967295 pixels"):
        flipmap.render(size=2**16)


def test_the_room_is_the_machines_or_the_containers(monkeypatch, tmp_path):
    meminfo = tmp_path / "meminfo"
    meminfo.write_text("MemTotal: 9 kB\nMemAvailable:    4 kB\n")
    monkeypatch.setattr(_memory, "_MEMINFO", meminfo)
    monkeypatch.setattr(_memory, "_GROUPS", tmp_path)
    assert _memory.available() == 4096
    for name, text in [("max", "3000"), ("current", "2000"), ("stat", "anon 1500\ninactive_file 500")]:
        (tmp_path / f"memory.{name}").write_text(text)
    assert _memory.available() == 1500
    (tmp_path / "memory.max").write_text("max")
    assert _memory.available() == 4096
    meminfo.unlink()
    assert _memory.available() is None or _memory.available() > 2**20
