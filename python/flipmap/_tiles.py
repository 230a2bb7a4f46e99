"""Maps cut into tiles, each a map of its own that any process can render."""

from decimal import Decimal, localcontext
from fractions import Fraction
from typing import NamedTuple

from . import _arguments, _flipmap

# Digits of a tile's centre beyond its first one: more than any answer depends on.
_MAX_DIGITS = 400


class Tile(NamedTuple):
    """A part of a map, with all that is needed to render it elsewhere."""

    rows: slice
    """Its rows in the whole map."""
    columns: slice
    """Its columns in the whole map."""
    scene: str
    """Its scene and settings, as TOML."""

    @property
    def size(self):
        """Width and height in pixels."""
        return self.columns.stop - self.columns.start, self.rows.stop - self.rows.start

    def render(self, **options):
        """Render it; `options` are those of `flipmap.render` that say where: engine, threads, …"""
        from . import render

        return render(self.scene, self.size, **options)


def tiles(
    scene=None,
    size=(512, 512),
    accuracy=None,
    *,
    across=4,
    down=4,
    method=None,
    step=None,
    tolerance=None,
    precision=None,
    verify=False,
    **words,
):
    """Cut the map that `render` would make of the same arguments into tiles.

    Returns a list of `across` times `down` tiles, by rows from the top, whose sizes differ by a
    pixel at most. Their scenes hold everything but the engine. The view must be upright.
    """
    sides = _arguments.size(size)
    counts = [
        _arguments.whole(name, count, 1, side)
        for name, count, side in (("across", across, sides[0]), ("down", down, sides[1]))
    ]
    run = _arguments.run({
        "accuracy": accuracy, "method": method, "step": step, "tolerance": tolerance,
        "precision": precision, "verify": verify, "engine": None, "adapter": None, "threads": None,
    })
    whole = _flipmap.whole(_arguments.scene(scene), _arguments.words(words), sides, run)
    if not whole[-1]:
        raise ValueError("`rotate` is not 0; only an upright map can be cut into tiles")
    columns, rows = (_cuts(side, count) for side, count in zip(sides, counts))
    return [_tile(whole, sides, row, column) for row in rows for column in columns]


def _cuts(side, count):
    """Return slices that share out a side."""
    edges = [side * k // count for k in range(count + 1)]
    return [slice(*pair) for pair in zip(edges, edges[1:])]


def _tile(whole, sides, rows, columns):
    scene, center, width, stretch, _ = whole
    across = Fraction(width) / sides[0]
    steps = across, -across / Fraction(stretch)
    middles = [
        Fraction(middle) + (Fraction(part.start + part.stop, 2) - Fraction(side, 2)) * pixel
        for middle, part, side, pixel in zip(center, (columns, rows), sides, steps)
    ]
    size = [columns.stop - columns.start, rows.stop - rows.start]
    texts = [_decimal(number) for number in middles]
    return Tile(rows, columns, _flipmap.part(scene, texts, _decimal(across * size[0]), size))


def _decimal(number):
    """Return a fraction as a decimal number, exactly if its digits end."""
    with localcontext() as context:
        context.prec = _MAX_DIGITS
        return format(Decimal(number.numerator) / Decimal(number.denominator), "f")
