"""Measurements: the numbers of a small scene, what is kept, and what is refused."""

import pytest

import flipmap

SMALL = {"samples": 1600, "budget": 2, "engine": "cpu"}


def test_areas_are_numbers_with_intervals():
    found = flipmap.measure(of="areas", **SMALL)
    classes = dict(found["areas"]["classes"])
    assert abs(classes["forbidden"]["value"] - 0.30643564) < 1e-7
    assert classes["flips"]["low"] < classes["flips"]["value"] < classes["flips"]["high"]
    assert found["edges"] is None


def test_a_folder_keeps_samples(tmp_path):
    folder = tmp_path / "found"
    found = flipmap.measure(of=["areas"], folder=folder, **SMALL)
    assert (folder / "measure.html").is_file()
    assert flipmap.measure(of=["areas"], folder=folder, **SMALL) == found


@pytest.mark.parametrize(
    ("given", "error", "says"),
    [
        ({"of": "colour"}, ValueError, "colour"),
        ({"of": [1]}, TypeError, "of"),
        ({"samples": 10}, ValueError, "1600"),
        ({"seed": -1}, ValueError, "seed"),
        ({"of": "wada"}, ValueError, "three classes"),
        ({"of": "areas", "ask": "speed"}, ValueError, "classes"),
    ],
)
def test_what_cannot_be_measured_is_refused(given, error, says):
    with pytest.raises(error, match=says):
        flipmap.measure(**{**SMALL, **given})
