"""Maps of double pendulums as NumPy arrays.

Every pixel of a map is a pendulum, released from rest at two angles, and answers a question: when
its second bob first goes over the top, where it is after some seconds, how chaotic it is.

>>> import flipmap
>>> times = flipmap.render("filigree", size=(64, 48))["time"]
>>> times.shape
(48, 64)
"""

import difflib
from collections import namedtuple
from enum import IntEnum

import numpy as np

from . import _flipmap

__all__ = ["Map", "Pass", "SCENES", "Status", "Trace", "Trust", "render", "trace"]
__version__ = _flipmap.VERSION

SCENES = tuple(_flipmap.SCENES)
Status = IntEnum("Status", _flipmap.STATUSES, module=__name__)
Status.__doc__ = "The way in which a pixel's simulation ended."
Trust = IntEnum("Trust", _flipmap.TRUSTS, module=__name__)
Trust.__doc__ = "How sure the answer of a pixel is, if its map was checked."
Pass = namedtuple("Pass", ["bob", "time", "anticlockwise"])
Pass.__doc__ = "A pass of the top: number of the bob, time in s, true towards the left."


class Map(np.ndarray):
    """A structured array of shape (height, width), row 0 at the top.

    Its fields are the question's channels (f8: ``inf`` where there is no answer within the budget,
    ``nan`` where energy forbids one), ``status`` and ``trust`` (u1, see `Status` and `Trust`).
    """

    seconds: float
    """Seconds that it took to compute."""
    units: dict
    """Unit of each channel, by name."""
    engine: str
    """What computed it."""
    scene: str
    """The scene and the settings that ran, as TOML; `render` takes it back."""

    def __array_finalize__(self, of):
        for name in ("seconds", "units", "engine", "scene"):
            setattr(self, name, getattr(of, name, None))

    @property
    def uncertain(self):
        """True for pixels whose checks disagree; with `accuracy="exact"` no other pixel is wrong."""
        return np.asarray(self["trust"]) == Trust.UNCERTAIN

    @property
    def channels(self):
        """The channels as floats: (height, width), or (height, width, channels) for several."""
        parts = [np.asarray(self[name]) for name in self.units]
        return parts[0] if len(parts) == 1 else np.stack(parts, axis=-1)


class Trace(np.ndarray):
    """A structured array of rows: t, theta1, theta2, omega1, omega2, energy_error and, for other
    questions than ``flip``, their channels so far (``nan`` where there is no value yet)."""

    passes: list
    """All passes of the top, in order of time, as `Pass`."""

    def __array_finalize__(self, of):
        self.passes = getattr(of, "passes", None)


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
    wrote, or a scene's text; by default the whole map. `size` is (width, height), or one side.
    `accuracy` is lesson, fast, balanced (the default) or exact. `words` change the scene as the
    program's options do: ``center=("2.85", "-0.4"), width="1e-20", budget=60, ask="state"``; numbers
    of many digits are given as text or `decimal.Decimal`. `progress` is called with the numbers of
    pixels done and in all. Returns a `Map`; raises `ValueError` for what cannot be asked for and
    `RuntimeError` for what a device cannot do.
    """
    width, height = (size, size) if isinstance(size, int) else size
    run = {
        "accuracy": accuracy, "method": method, "step": _text(step),
        "tolerance": _text(tolerance), "precision": precision, "verify": verify,
        "engine": engine, "adapter": adapter, "threads": threads,
    }
    made = _flipmap.render(_scene(scene), _words(words), [width, height], run, progress)
    names = [name for name, _ in made["channels"]]
    fields = [(name, "f8") for name in names] + [("status", "u1"), ("trust", "u1")]
    array = np.empty((height, width), fields).view(Map)
    values = np.frombuffer(made["values"]).reshape(height, width, len(names))
    for place, name in enumerate(names):
        array[name] = values[..., place]
    array["status"] = np.frombuffer(made["statuses"], "u1").reshape(height, width)
    array["trust"] = np.frombuffer(made["trusts"], "u1").reshape(height, width)
    array.seconds, array.engine, array.scene = made["seconds"], made["engine"], made["scene"]
    array.units = dict(made["channels"])
    return array


def trace(start, until=30.0, every=0.01, scene=None, **words):
    """Follow one pendulum by the gold standard, in double-double.

    `start` is (θ1, θ2) in rad, or (θ1, θ2, ω1, ω2) for one that is thrown; `until` and `every` are
    in s. `scene` and `words` are those of `render`. Returns a `Trace`.
    """
    made = _flipmap.trace(_text(start), _text(until), _text(every), _scene(scene), _words(words))
    fields = [(name, "f8") for name in made["columns"]]
    rows = np.frombuffer(made["rows"], fields).copy().view(Trace)
    rows.passes = [Pass(*found) for found in made["passes"]]
    return rows


def _scene(scene):
    return None if scene is None else str(scene)


def _words(words):
    for name in words:
        if name not in _flipmap.WORDS:
            near = difflib.get_close_matches(name, _flipmap.WORDS, 1)
            meant = f" (did you mean {near[0]}?)" if near else ""
            raise TypeError(f"no word {name!r}{meant}: the words are {', '.join(_flipmap.WORDS)}")
    return [(name, _text(value)) for name, value in words.items() if value is not None]


def _text(value):
    """A value as the program's options take it; every digit of a number is kept."""
    if value is None or isinstance(value, str):
        return value
    if isinstance(value, (tuple, list, np.ndarray)):
        return ",".join(_text(part) for part in value)
    if isinstance(value, float):
        return float.__repr__(value)
    return str(value)
