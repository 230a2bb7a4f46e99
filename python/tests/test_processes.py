"""Maps in several processes: forked, spawned, and by Dask in tiles."""

import multiprocessing
import os
import re
import subprocess
import sys
import textwrap
from pathlib import Path

import numpy as np
import pytest

import flipmap

NO_DASK = "Dask is not installed (pip install dask distributed)"
README = Path(__file__).parent.parent / "README.md"
needs_fork = pytest.mark.skipif(not hasattr(os, "fork"), reason="this system cannot fork")
DEEP = ("1.186731002827734375", "2.044025554308203125")
AROUND = {"center": (2.0, 1.4), "width": 0.5, "budget": 5}


def script(text):
    """Run a script in an interpreter of its own, and return what it printed."""
    command = [sys.executable, "-W", "ignore::DeprecationWarning", "-c", textwrap.dedent(text)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    return done.stdout.strip()


@needs_fork
def test_a_process_forked_after_use_refuses_at_once():
    said = script("""
        import multiprocessing, time, flipmap
        def work(size):
            begun = time.monotonic()
            try:
                flipmap.render("lesson", size=size)
            except RuntimeError as error:
                return str(error), time.monotonic() - begun
        flipmap.render("lesson", size=16)
        with multiprocessing.get_context("fork").Pool(2) as pool:
            for text, seconds in pool.map_async(work, [16, 32]).get(60):
                assert seconds < 1 and "get_context('spawn')" in text, (text, seconds)
        flipmap.render("lesson", size=16)
        print(text)
    """)
    assert said.startswith("flipmap was used before this process was forked")


@needs_fork
def test_forking_before_the_first_use_works():
    said = script("""
        import multiprocessing, flipmap
        def work(size):
            return flipmap.render("lesson", size=size, engine="cpu")["time"].shape
        for refused in [{"width": 0}, {"size": 10**6}, {"scene": "nowhere"}, {"engine": "abacus"}]:
            try:
                flipmap.render(**refused)
            except (ValueError, MemoryError):
                pass
        flipmap.trace((3, 3), until=1, every=1)
        with multiprocessing.get_context("fork").Pool(2) as pool:
            print(pool.map_async(work, [16, 32]).get(60))
        print(flipmap.render("lesson", size=8).shape)
    """)
    assert said.splitlines() == ["[(16, 16), (32, 32)]", "(8, 8)"]


@needs_fork
def test_a_forked_process_can_still_read_maps_and_follow_pendulums():
    said = script("""
        import multiprocessing, flipmap
        found = flipmap.render("lesson", size=16)
        def work(_):
            traced = flipmap.trace((3, 3), until=2, every=1, ask="growth")
            return found.theta1[0], found["time"].shape, len(traced)
        with multiprocessing.get_context("fork").Pool(1) as pool:
            print(pool.map_async(work, [0]).get(60) == [(found.theta1[0], (16, 16), 3)])
    """)
    assert said == "True"


def test_spawned_processes_work_and_send_their_maps():
    here = flipmap.render(size=(12, 8), engine="cpu", **AROUND)
    cut = flipmap.tiles(size=(12, 8), across=1, down=2, **AROUND)
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        parts = pool.map_async(flipmap.Tile.render, cut).get(120)
    assert all(type(part) is flipmap.Map and part.scene for part in parts)
    assert np.array_equal(np.concatenate(parts)["status"], here["status"])


def joined(cut, parts, like):
    """Put tiles together in an array like another one."""
    whole = np.empty(like.shape, like.dtype)
    for tile, part in zip(cut, parts):
        whole[tile.rows, tile.columns] = part
    return whole


@pytest.mark.parametrize(
    ("size", "words"),
    [
        ((64, 48), {"center": (2.0, 1.5), "width": 0.5, "budget": 5}),
        ((61, 43), {"scene": "filigree"}),
        ((40, 30), {"budget": 8}),
        ((32, 32), {"center": DEEP, "width": "2e-9", "budget": "auto"}),
        ((24, 16), {"center": ("0.1", "3"), "width": "0.7", "stretch": 2, "ask": "state", "at": 3}),
        ((24, 16), {"plane": "speeds", "center": (1, 2), "width": 5, "budget": 3, "method": "dop853"}),
    ],
)
def test_tiles_are_parts_of_the_whole_bit_for_bit(size, words):
    whole = flipmap.render(size=size, engine="cpu", **words)
    cut = flipmap.tiles(size=size, across=4, down=4, **words)
    parts = [tile.render(engine="cpu") for tile in cut]
    assert len(cut) == 16 and all(part.shape == tile.size[::-1] for tile, part in zip(cut, parts))
    assert joined(cut, parts, whole).tobytes() == whole.tobytes()


def test_tiles_lie_where_they_were_cut():
    whole = flipmap.render(size=(10, 6), budget=1)
    for tile in flipmap.tiles(size=(10, 6), across=3, down=2, budget=1):
        part = tile.render()
        assert np.allclose(part.theta1, whole.theta1[tile.columns], rtol=0, atol=1e-15)
        assert np.allclose(part.theta2, whole.theta2[tile.rows], rtol=0, atol=1e-15)


@pytest.mark.parametrize(
    ("words", "error", "says"),
    [
        ({"across": 0}, ValueError, "`across` is 0; it must be a whole number between 1 and 8"),
        ({"down": 9}, ValueError, "`down` is 9; it must be a whole number between 1 and 8"),
        ({"down": 1.5}, TypeError, "`down` is 1.5; it"),
        ({"rotate": 5}, ValueError, "`rotate` is not 0; only an upright map"),
        ({"widht": 5}, TypeError, "did you mean width"),
    ],
)
def test_what_cannot_be_cut_is_said(words, error, says):
    with pytest.raises(error, match=says):
        flipmap.tiles(size=8, **words)


def test_sixteen_tiles_by_dask_are_one_map_bit_for_bit():
    distributed = pytest.importorskip("distributed", reason=NO_DASK)
    import dask

    size, words = (64, 48), {"scene": "filigree"}
    whole = flipmap.render(size=size, engine="cpu", **words)
    cut = flipmap.tiles(size=size, across=4, down=4, **words)
    settings = {"distributed.worker.multiprocessing-method": "spawn"}
    with dask.config.set(settings), distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None
    ) as cluster, distributed.Client(cluster) as client:
        parts = client.gather(client.map(flipmap.Tile.render, cut, engine="cpu"))
    assert joined(cut, parts, whole).tobytes() == whole.tobytes()


@pytest.mark.parametrize("about", ["LocalCluster", "get_context"])
def test_the_examples_of_the_readme_run(tmp_path, about):
    if about == "LocalCluster":
        pytest.importorskip("distributed", reason=NO_DASK)
    examples = re.findall(r"```python\n(.*?)```", README.read_text(encoding="utf-8"), re.DOTALL)
    (example,) = [text for text in examples if about in text]
    example = example.replace("(640, 480)", "(64, 48)").replace("(480, 640)", "(48, 64)")
    path = tmp_path / "example.py"
    path.write_text(example + """
    one = flipmap.render("filigree", size=(64, 48), engine="cpu")
    print(len(maps) == 2 if "maps" in dir() else whole.tobytes() == one.tobytes())
""")
    done = subprocess.run([sys.executable, path], capture_output=True, text=True, timeout=240)
    assert done.stdout.strip() == "True", done.stderr


def test_sixteen_tiles_by_ray_are_one_map_bit_for_bit():
    ray = pytest.importorskip("ray", reason="Ray is not installed (pip install ray)")
    size, words = (64, 48), {"scene": "filigree"}
    whole = flipmap.render(size=size, engine="cpu", **words)
    cut = flipmap.tiles(size=size, across=4, down=4, **words)
    ray.init(num_cpus=2, include_dashboard=False, log_to_driver=False)
    try:
        render = ray.remote(flipmap.Tile.render)
        parts = ray.get([render.remote(tile, engine="cpu") for tile in cut])
    finally:
        ray.shutdown()
    assert joined(cut, parts, whole).tobytes() == whole.tobytes()
