"""Maps of double pendulums as NumPy arrays.

Every pixel of a map is a pendulum, released from rest at two angles, and answers a question: when
its second bob first goes over the top, where it is after some seconds, how chaotic it is.

>>> import flipmap
>>> times = flipmap.render("filigree", size=(64, 48))["time"]
>>> times.shape
(48, 64)
"""

import json

import numpy as np

from . import _arguments, _flipmap, _memory
from ._film import Film, film
from ._map import Map, Pass, Status, Trace, Trust
from ._tiles import Tile, tiles

__all__ = [
    "Film", "Map", "Pass", "SCENES", "Status", "Tile", "Trace", "Trust", "film", "measure", "render",
    "tiles", "trace",
]
__version__ = _flipmap.VERSION

SCENES = tuple(_flipmap.SCENES)


def render(
    scene=None,
    size=(512, 512),
    accuracy=None,
    *,
    method=None,
    step=None,
    tolerance=None,
    precision=None,
    verify=False,
    engine=None,
    adapter=None,
    threads=None,
    progress=None,
    **words,
):
    """Render a map.

    `scene` is a built-in scene's name (`SCENES`), the path of a scene or of a picture that flipmap
    wrote, or a scene's text; by default the whole map. `size` is (width, height), or one side
    of a square. `accuracy` is lesson, fast, balanced (the default) or exact. `words` change the
    scene as the program's options do: ``center=("2.85", "-0.4"), width="1e-20", budget=60,
    ask="state"``; numbers of many digits are given as text or `decimal.Decimal`. `progress` is called
    with the numbers of pixels done and in all. Returns a `Map`; raises `TypeError` or `ValueError`
    for what cannot be asked for, `MemoryError` for a map that does not fit, and `RuntimeError` for
    what a device cannot do or in a process that was forked after the first map.
    """
    width, height = _arguments.size(size)
    run = _arguments.run({
        "accuracy": accuracy, "method": method, "step": step, "tolerance": tolerance,
        "precision": precision, "verify": verify, "engine": engine, "adapter": adapter,
        "threads": threads,
    })
    scene, words = _arguments.scene(scene), _arguments.words(words)
    progress = _arguments.progress(progress)
    made = _flipmap.render(scene, words, [width, height], run, _memory.available(), progress)
    array = np.frombuffer(made["records"], made["fields"]).reshape(height, width).view(Map)
    array.seconds, array.engine, array.scene = made["seconds"], made["engine"], made["scene"]
    array.units = dict(made["channels"])
    return array


def trace(start, until=30.0, every=0.01, scene=None, **words):
    """Follow one pendulum by the gold standard, in double-double.

    `start` is (θ1, θ2) in rad, or (θ1, θ2, ω1, ω2) for one that is thrown; `until` and `every` are
    in s. `scene` and `words` are those of `render`. Returns a `Trace`.
    """
    numbers = {"start": start, "until": until, "every": every}
    numbers = [_arguments.text(name, given) for name, given in numbers.items()]
    made = _flipmap.trace(*numbers, _arguments.scene(scene), _arguments.words(words))
    fields = [(name, "f8") for name in made["columns"]]
    rows = np.frombuffer(made["rows"], fields).copy().view(Trace)
    rows.passes = [Pass(*found) for found in made["passes"]]
    return rows


def measure(
    scene=None,
    of=(),
    samples=200_000,
    *,
    seed=1,
    apart=None,
    folder=None,
    engine=None,
    adapter=None,
    threads=None,
    progress=None,
    **words,
):
    """Measure a scene: areas, survival, the dimension of its edges, with 95 % intervals.

    `of` is a name or several: areas, survival, edges, boxes, entropy, wada, growth, fat; by default all
    that the question allows. `samples` starts are integrated and checked, the same ones for a `seed`.
    Pairs whose flips are more than `apart` seconds from each other also count as different. With a
    `folder`, samples are kept there, for the next call, and the results as files. The rest is as for
    `render`. Returns a dictionary; a number with an interval is a dictionary of `value`, `low`
    and `high`.
    """
    run = _arguments.run({
        "accuracy": "exact", "method": None, "step": None, "tolerance": None, "precision": None,
        "verify": True, "engine": engine, "adapter": adapter, "threads": threads,
    })
    order = _arguments.survey(of, samples, seed, apart, folder)
    scene, words = _arguments.scene(scene), _arguments.words(words)
    return json.loads(_flipmap.measure(scene, words, order, run, _arguments.progress(progress)))
