"""Maps drawn with Matplotlib."""

import numpy as np

# Neighbours closer than this many last digits of a coordinate are drawn by their distance from
# the centre.
_LAST_DIGITS = 16


def draw(of, frame, ax, channel, options):
    """Draw a channel of a map and return what Matplotlib made."""
    if ax is None:
        try:
            import matplotlib.pyplot as pyplot
        except ImportError as error:
            raise ImportError("plot needs Matplotlib: install it with pip install matplotlib") from error
        ax = pyplot.gca()
    name = next(iter(of.units)) if channel is None else channel
    if name not in of.dtype.names:
        raise ValueError(f"`channel` is {channel!r}; the map has {', '.join(of.dtype.names)}")
    is_deep = _is_deep(frame)
    first = frame["first_from_center"] if is_deep else frame["first"]
    if frame["is_upright"]:
        options = {"aspect": "auto" if frame["has_units_apart"] else "equal", **options}
        options = {"extent": edges(frame, first), "origin": "upper", **options}
        drawn = ax.imshow(of[name], **options)
    else:
        drawn = ax.pcolormesh(*_corners(frame, first), of[name], **options)
        ax.set_aspect("auto" if frame["has_units_apart"] else "equal")
    for place, label in enumerate((ax.set_xlabel, ax.set_ylabel)):
        center = f" − {_short(frame['center'][place])}" if is_deep else ""
        label(f"{frame['names'][place]}{center}, {frame['units'][place]}")
    return drawn


def edges(frame, first):
    """Return left, right, bottom and top, given the middle of the top left pixel."""
    (across, _), (_, down) = frame["right"], frame["down"]
    height, width = frame["shape"]
    left, top = first[0] - across / 2, first[1] - down / 2
    return left, left + width * across, top + height * down, top


def _is_deep(frame):
    """Return true if floats hardly tell neighbouring pixels apart."""
    steps = [np.hypot(*frame[step]) for step in ("right", "down")]
    return min(steps) < _LAST_DIGITS * np.spacing(np.abs(frame["first"]).max())


def _corners(frame, first):
    """Return both coordinates of all corners of the pixels."""
    height, width = frame["shape"]
    column, row = np.meshgrid(np.arange(width + 1) - 0.5, np.arange(height + 1) - 0.5)
    steps = zip(first, frame["right"], frame["down"])
    return [origin + column * right + row * down for origin, right, down in steps]


def _short(center, most=12):
    return center if len(center) <= most else center[:most] + "…"
