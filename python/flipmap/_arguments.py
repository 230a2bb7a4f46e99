"""Arguments as the compiled half takes them; what it cannot take is refused in a sentence."""

import difflib
import numbers
import operator
import os
import reprlib
from collections.abc import Sequence
from decimal import Decimal

import numpy as np

from . import _flipmap

_MAX_THREADS = 1024


def size(given):
    """Return the width and the height of a size: one whole number for a square, or two."""
    row = isinstance(given, (tuple, list)) or isinstance(given, np.ndarray) and given.ndim == 1
    sides = [_whole(side) for side in given] if row else [_whole(given)] * 2
    if None in sides:
        raise TypeError(_refusal("size", given, _SIZES))
    if len(sides) != 2 or not all(1 <= side <= _flipmap.MAX_SIDE for side in sides):
        raise ValueError(_refusal("size", given, _SIZES))
    return sides


_SIZES = (
    "it must be one whole number, for a square, or two, (width, height), each between 1 and "
    f"{_flipmap.MAX_SIDE}"
)


def scene(given):
    """Return a scene's name, path or text."""
    if given is None or isinstance(given, str):
        return given
    if isinstance(given, os.PathLike):
        return os.fsdecode(given)
    raise TypeError(_refusal("scene", given, "it must be a scene's name, its path or its text"))


def scenes(given):
    """Return the scenes of a film: one, or several in a row."""
    allowed = "it must be a scene, a row of scenes, or a file of keys"
    if given is None or not isinstance(given, (str, os.PathLike, Sequence)):
        raise TypeError(_refusal("scenes", given, allowed))
    found = [given] if isinstance(given, (str, os.PathLike)) else list(given)
    if not found:
        raise ValueError(_refusal("scenes", given, allowed))
    if None in found:
        raise TypeError(_refusal("scenes", given, allowed))
    return [scene(one) for one in found]


def path(name, given):
    """Return a path."""
    if isinstance(given, (str, os.PathLike)) and os.fspath(given):
        return os.fsdecode(given)
    raise TypeError(_refusal(name, given, "it must be a path"))


def words(given):
    """Return the scene's words and their values, as text."""
    for name in given:
        if name not in _flipmap.WORDS:
            near = difflib.get_close_matches(name, _flipmap.WORDS, 1)
            meant = f" (did you mean {near[0]}?)" if near else ""
            raise TypeError(f"no word {name!r}{meant}: the words are {', '.join(_flipmap.WORDS)}")
    return [(name, text(name, value)) for name, value in given.items() if value is not None]


def run(given):
    """Return the settings of a run."""
    made = dict(given)
    for argument, allowed in _TEXTS.items():
        name(argument, given[argument], allowed)
    for argument in ("step", "tolerance"):
        value = given[argument]
        made[argument] = None if value is None else text(argument, value)
    made["verify"] = flag("verify", given["verify"])
    if given["threads"] is not None:
        made["threads"] = whole("threads", given["threads"], 1, _MAX_THREADS)
    return made


_TEXTS = {
    "accuracy": "one of lesson, fast, balanced, exact",
    "method": "the name of a method, as in 'dop853'",
    "precision": "one of f32, df32, f64, dd",
    "engine": "cpu or gpu",
    "adapter": "a part of an adapter's name",
}


def survey(of, samples, seed, apart, folder):
    """Return what is to be measured."""
    of = [of] if isinstance(of, str) else list(of)
    if not all(isinstance(one, str) for one in of):
        raise TypeError(_refusal("of", of, "it must be names, as in ['areas', 'edges']"))
    return {
        "of": of,
        "samples": whole("samples", samples, 1, 2**32 - 1),
        "seed": whole("seed", seed, 0, 2**64 - 1),
        "apart": None if apart is None else float(apart),
        "folder": None if folder is None else os.fspath(folder),
    }


def progress(given):
    """Return a function that takes two numbers, or None."""
    if given is None or callable(given):
        return given
    raise TypeError(_refusal("progress", given, "it must be a function of two numbers, as print is"))


def text(name, value):
    """Return a value as the program's options take it; every digit of a number is kept."""
    if isinstance(value, np.ndarray) and value.ndim == 0:
        value = value[()]
    if isinstance(value, str):
        return str(value)
    if isinstance(value, (np.ndarray, Sequence)) and not isinstance(value, (bytes, bytearray)):
        return ",".join(_number(name, part, value) for part in value)
    return _number(name, value, value)


def _number(name, part, whole):
    if isinstance(part, str):
        return str(part)
    if isinstance(part, float):
        return float.__repr__(part)
    if isinstance(part, (numbers.Real, Decimal)) and not isinstance(part, bool):
        return str(part)
    raise TypeError(_refusal(name, whole, "it must be a number, a text, or a row of them"))


def name(argument, given, allowed):
    """Return a text, or None."""
    if given is None or isinstance(given, str):
        return given
    raise TypeError(_refusal(argument, given, f"it must be {allowed}"))


def flag(name, given):
    """Return a truth value."""
    if isinstance(given, (bool, np.bool_)):
        return bool(given)
    raise TypeError(_refusal(name, given, "it must be True or False"))


def between(name, given, least, most):
    """Return a number of a range, or None."""
    if given is None:
        return None
    allowed = f"it must be a number between {least:g} and {most:g}"
    if isinstance(given, (bool, np.bool_)) or not isinstance(given, (numbers.Real, Decimal)):
        raise TypeError(_refusal(name, given, allowed))
    if not least <= given <= most:
        raise ValueError(_refusal(name, given, allowed))
    return float(given)


def whole(name, given, least, most):
    """Return a whole number of a range."""
    allowed = f"it must be a whole number between {least} and {most}"
    count = _whole(given)
    if count is None:
        raise TypeError(_refusal(name, given, allowed))
    if not least <= count <= most:
        raise ValueError(_refusal(name, given, allowed))
    return count


def _whole(given):
    if isinstance(given, (bool, np.bool_)):
        return None
    try:
        return operator.index(given)
    except TypeError:
        return None


def _refusal(name, given, allowed):
    shown = " ".join(reprlib.repr(given).split())
    return f"`{name}` is {shown}; {allowed}"
