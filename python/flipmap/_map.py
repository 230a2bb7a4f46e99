"""Maps and traces: arrays that know their scene, and where their pixels lie."""

from collections import namedtuple
from enum import IntEnum

import numpy as np

from . import _flipmap
from ._drawing import draw, edges
from ._kept import Kept
from ._labelled import dataset

Status = IntEnum("Status", _flipmap.STATUSES, module="flipmap")
Status.__doc__ = "The way in which a pixel's simulation ended."
Trust = IntEnum("Trust", _flipmap.TRUSTS, module="flipmap")
Trust.__doc__ = "How sure the answer of a pixel is, if its map was checked."
Pass = namedtuple("Pass", ["bob", "time", "anticlockwise"], module="flipmap")
Pass.__doc__ = "A pass of the top: number of the bob, time in s, true towards the left."


class Map(Kept):
    """A structured array of shape (height, width), row 0 at the top.

    Its fields are the question's channels (f8: ``inf`` where there is no answer within the budget,
    ``nan`` where energy forbids one), ``status`` and ``trust`` (u1, see `Status` and `Trust`), and
    ``error`` if flips are timed: the estimated error in s of a checked map, rounded up to half a
    decade (f4: ``nan`` where nothing was checked, ``inf`` where no two computations agree).
    Fields, parts and copies of parts are plain arrays of NumPy.

    The coordinates of the pixels' middles are ``theta1`` and ``theta2``, or whichever two of
    ``theta1``, ``theta2``, ``omega1``, ``omega2`` and ``momentum2`` the scene's plane has.
    """

    _NOTES = ("seconds", "units", "engine", "scene")

    seconds: float
    """Seconds that it took to compute."""
    units: dict
    """Unit of each channel, by name."""
    engine: str
    """What computed it."""
    scene: str
    """The scene and the settings that ran, as TOML; `render` takes it back."""

    @property
    def uncertain(self):
        """True for pixels whose checks disagree; with `accuracy="exact"` no other pixel is wrong."""
        return self["trust"] == Trust.UNCERTAIN

    @property
    def channels(self):
        """The channels as floats: (height, width), or (height, width, channels) for several."""
        self._require_scene()
        parts = [self[name] for name in self.units]
        return np.array(parts[0]) if len(parts) == 1 else np.stack(parts, axis=-1)

    @property
    def axes(self):
        """The coordinates of the pixels' middles by name: along the columns first, then the rows.

        Arrays of one dimension, of the width and of the height, or, if the view is rotated, of two.
        Angles are not wrapped, so they grow evenly beyond π.
        """
        return {name: self._coordinates(name) for name in self._frame()["names"]}

    @property
    def from_center(self):
        """The same as `axes`, measured from the centre, which keeps its digits at every depth."""
        return {name: self._coordinates(name, True) for name in self._frame()["names"]}

    @property
    def center(self):
        """The centre's coordinates as text, with all their digits."""
        return tuple(self._frame()["center"])

    @property
    def extent(self):
        """The view's left, right, bottom and top, as ``imshow`` of Matplotlib takes them."""
        frame = self._frame()
        if not frame["is_upright"]:
            raise ValueError(
                "extent is for upright views and this one is rotated: plot draws it, and axes has "
                "the coordinates of every pixel"
            )
        return edges(frame, frame["first"])

    def plot(self, ax=None, channel=None, **options):
        """Draw a channel, by default the first one, on axes of Matplotlib, by default the current ones.

        `options` are those of ``imshow``, or of ``pcolormesh`` for a rotated view. Views too deep
        for floats are drawn by the distance from their centre. Returns what was drawn.
        """
        return draw(self, self._frame(), ax, channel, options)

    def to_xarray(self):
        """Return a Dataset of xarray: the fields, with coordinates and units.

        A coordinate with the name of a channel gets ``_at_start`` added to its own.
        """
        return dataset(self, self._frame(), {"status": Status, "trust": Trust})

    def _frame(self):
        self._require_scene()
        height, width = self.shape
        return _flipmap.frame(self.scene, [width, height])

    def _coordinates(self, name, from_center=False):
        frame = self._frame()
        if name not in frame["names"]:
            names = " and ".join(frame["names"])
            raise AttributeError(f"this map has no {name}: its axes are {names}")
        axis, (height, width) = frame["names"].index(name), self.shape
        shape = [(width,), (height,)][axis] if frame["is_upright"] else (height, width)
        made = _flipmap.coordinates(self.scene, [width, height], axis, from_center)
        return np.frombuffer(made).reshape(shape).copy()

    def _require_scene(self):
        if self.scene is None:
            raise ValueError("this array has no scene: only a map as render returns it has one")


def _coordinate(name):
    def get(self):
        return self._coordinates(name)

    get.__doc__ = f"Coordinate {name} of the pixels' middles, if the scene's plane has it; see `axes`."
    return property(get)


for _name in _flipmap.AXES:
    setattr(Map, _name, _coordinate(_name))


class Trace(Kept):
    """A structured array of rows: t, theta1, theta2, omega1, omega2, energy_error and, for other
    questions than ``flip``, their channels so far (``nan`` where there is no value yet)."""

    _NOTES = ("passes",)

    passes: list
    """All passes of the top, in order of time, as `Pass`."""


for _kind in (Map, Trace):
    _kind.__module__ = "flipmap"
