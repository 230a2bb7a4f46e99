"""Films: what is written, that stopped ones go on, and that the rest is refused in one sentence."""

import json
import os
import subprocess

import pytest

import flipmap

SMALL = {"size": (32, 24), "accuracy": "fast", "engine": "cpu", "budget": 3}
DEEP = "[view]\ncenter = ['2', '1.4']\nwidth = '0.3'\n"


def pictures(folder):
    return {path.name: path.read_bytes() for path in folder.glob("*.png")}


def test_a_zoom_is_written_and_made_again_at_no_cost(tmp_path):
    told = []
    made = flipmap.film(
        tmp_path / "zoom", DEEP, secs=0.5, fps=10, progress=lambda *now: told.append(now), **SMALL
    )
    assert made[:4] == (str(tmp_path / "zoom"), 5, 10.0, (32, 24)) and made.engine.startswith("cpu")
    assert told[-1] == (5, 5)
    manifest = json.loads((tmp_path / "zoom" / "manifest.json").read_text())
    assert manifest["frames"] == 5 and len(pictures(tmp_path / "zoom")) == 5
    kept = tmp_path / "zoom.samples"
    before = {path: path.stat().st_mtime_ns for path in kept.rglob("*.part")}
    assert before
    again = flipmap.film(tmp_path / "again", DEEP, secs=0.5, fps=10, samples=kept, **SMALL)
    assert again.frames == 5 and pictures(tmp_path / "again") == pictures(tmp_path / "zoom")
    assert before == {path: path.stat().st_mtime_ns for path in kept.rglob("*.part")}


def test_films_are_those_of_the_program(tmp_path):
    program = os.environ.get("FLIPMAP")
    if not program:
        pytest.skip("FLIPMAP does not name the program")
    (tmp_path / "deep.toml").write_text(DEEP)
    words = "video --zoom-to deep.toml --secs 0.5 --fps 10 --size 32x24 --accuracy fast --engine cpu --budget 3"
    subprocess.run([program, *words.split(), "-o", "told"], cwd=tmp_path, check=True, capture_output=True)
    flipmap.film(tmp_path / "made", tmp_path / "deep.toml", secs=0.5, fps=10, **SMALL)
    assert pictures(tmp_path / "made") == pictures(tmp_path / "told")


def test_what_was_computed_before_a_stop_is_not_computed_again(tmp_path):
    class Stop(Exception):
        pass

    def stop(done, total):
        if done > total // 4:
            raise Stop

    large = {**SMALL, "size": (320, 240), "budget": 10, "accuracy": "balanced"}
    with pytest.raises(Stop):
        flipmap.film(tmp_path / "film", DEEP, secs=0.5, fps=10, progress=stop, **large)
    kept = {path.name: path.read_bytes() for path in (tmp_path / "film.samples").rglob("*.part")}
    assert kept and not (tmp_path / "film" / "manifest.json").exists()
    assert flipmap.film(tmp_path / "film", DEEP, secs=0.5, fps=10, **large).frames == 5
    now = {path.name: path.read_bytes() for path in (tmp_path / "film.samples").rglob("*.part")}
    assert kept.items() <= now.items() and len(now) > len(kept)


def test_films_of_states_and_of_keys(tmp_path):
    keys = "[[key]]\nsecs = 0\n[[key]]\nsecs = 1\n[key.scene.view]\nwidth = '1'\n"
    (tmp_path / "keys.toml").write_text(keys)
    words = {**SMALL, "ask": "state", "at": 1}
    for given in (keys, tmp_path / "keys.toml", ["home", "[view]\nwidth = '1'\n"]):
        folder = tmp_path / f"film-{len(list(tmp_path.iterdir()))}"
        made = flipmap.film(folder, given, frames=2, secs=1, **words)
        assert made.frames == 2 and len(pictures(folder)) == 2
    assert not list(tmp_path.glob("*.samples")), "frames of states are computed one by one"


@pytest.mark.parametrize(
    ("given", "error", "says"),
    [
        ({"secs": "5"}, TypeError, "`secs` is '5'; it must be a number between 0.01 and 1e+06"),
        ({"secs": 0}, ValueError, "`secs` is 0; it must be a number between"),
        ({"frames": 2.5}, TypeError, "`frames` is 2.5; it must be a whole number between 1 and 100000"),
        ({"fps": float("nan")}, ValueError, "`fps` is nan; it must be a number between 0.1 and 1000"),
        ({"quality": 101}, ValueError, "`quality` is 101; it must be a whole number between 1 and 100"),
        ({"full_chroma": "no"}, TypeError, "`full_chroma` is 'no'; it must be True or False"),
        ({"palette": "sand"}, ValueError, "sand"),
        ({"palette": 7}, TypeError, "`palette` is 7; it must be a palette's name"),
        ({"samples": 7}, TypeError, "`samples` is 7; it must be a path"),
        ({"scenes": []}, ValueError, "`scenes` is []; it must be a scene, a row"),
        ({"scenes": None}, TypeError, "`scenes` is None; it must be a scene, a row"),
        ({"scenes": [None, "home"]}, TypeError, "`scenes` is [None, 'home']; it must be"),
        ({"scenes": ["home", DEEP], "width": 1}, ValueError, "`width` would give all keys the same view"),
        ({"output": "film.avi"}, ValueError, "`output` is 'film.avi'; a film is an .mp4"),
        ({"output": ""}, TypeError, "`output` is ''; it must be a path"),
        ({"secs": 5, "fps": 10, "frames": 90}, ValueError, "90 frames at 10 per second last 9.00 s"),
        ({"secs": 1e6}, ValueError, "a film has 100000 at most"),
        ({"output": "/proc/film"}, OSError, "/proc/film"),
        ({"samples": "/proc/kept"}, OSError, "`samples`: cannot keep samples in /proc/kept"),
    ],
)
def test_other_arguments_are_refused_in_one_sentence(tmp_path, monkeypatch, given, error, says):
    monkeypatch.chdir(tmp_path)
    words = {"output": "film", "scenes": DEEP, **SMALL, **given}
    with pytest.raises(error) as refused:
        flipmap.film(**words)
    said = str(refused.value)
    assert says in said and "\n" not in said, said
    assert not list(tmp_path.glob("film/*.png"))
