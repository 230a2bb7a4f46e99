import os
from collections.abc import Callable, Sequence
from decimal import Decimal
from enum import IntEnum
from typing import Any, Literal, NamedTuple, SupportsIndex

import numpy as np
import numpy.typing as npt

__version__: str
SCENES: tuple[str, ...]

_Number = int | float | str | Decimal
_Numbers = str | Sequence[_Number]
_Size = SupportsIndex | Sequence[SupportsIndex]
_Scene = str | os.PathLike[str] | None

class Status(IntEnum):
    UNFLIPPED = 0
    FLIPPED = 1
    FORBIDDEN = 2
    FAILED = 3

class Trust(IntEnum):
    UNCHECKED = 0
    AGREED = 1
    CONFIRMED = 2
    SETTLED = 3
    UNCERTAIN = 4

class Pass(NamedTuple):
    bob: int
    time: float
    anticlockwise: bool

class Map(np.ndarray[Any, Any]):
    seconds: float
    units: dict[str, str]
    engine: str
    scene: str
    @property
    def uncertain(self) -> npt.NDArray[np.bool_]: ...
    @property
    def channels(self) -> npt.NDArray[np.float64]: ...
    @property
    def axes(self) -> dict[str, npt.NDArray[np.float64]]: ...
    @property
    def from_center(self) -> dict[str, npt.NDArray[np.float64]]: ...
    @property
    def center(self) -> tuple[str, str]: ...
    @property
    def extent(self) -> tuple[float, float, float, float]: ...
    @property
    def theta1(self) -> npt.NDArray[np.float64]: ...
    @property
    def theta2(self) -> npt.NDArray[np.float64]: ...
    @property
    def omega1(self) -> npt.NDArray[np.float64]: ...
    @property
    def omega2(self) -> npt.NDArray[np.float64]: ...
    @property
    def momentum2(self) -> npt.NDArray[np.float64]: ...
    def plot(self, ax: Any = None, channel: str | None = None, **options: Any) -> Any: ...
    def to_xarray(self) -> Any: ...

class Tile(NamedTuple):
    rows: slice
    columns: slice
    scene: str
    @property
    def size(self) -> tuple[int, int]: ...
    def render(self, **options: Any) -> Map: ...

class Film(NamedTuple):
    path: str
    frames: int
    fps: float
    size: tuple[int, int]
    seconds: float
    engine: str

class Trace(np.ndarray[Any, Any]):
    passes: list[Pass]

def render(
    scene: _Scene = None,
    size: _Size = (512, 512),
    accuracy: Literal["lesson", "fast", "balanced", "exact"] | None = None,
    *,
    method: str | None = None,
    step: _Number | None = None,
    tolerance: _Number | None = None,
    precision: Literal["f32", "df32", "f64", "dd"] | None = None,
    verify: bool = False,
    engine: Literal["cpu", "gpu"] | None = None,
    adapter: str | None = None,
    threads: int | None = None,
    progress: Callable[[int, int], object] | None = None,
    center: _Numbers | None = None,
    width: _Number | None = None,
    rotate: _Number | None = None,
    stretch: _Number | None = None,
    budget: _Number | None = None,
    rule: str | None = None,
    kind: str | None = None,
    masses: _Numbers | None = None,
    lengths: _Numbers | None = None,
    gravity: _Number | None = None,
    friction: _Numbers | None = None,
    ask: str | None = None,
    at: _Number | None = None,
    count: int | None = None,
    plane: str | None = None,
    origin: _Numbers | None = None,
    energy: _Number | None = None,
) -> Map: ...
def film(
    output: str | os.PathLike[str],
    scenes: _Scene | Sequence[_Scene],
    size: _Size = (1280, 720),
    accuracy: Literal["lesson", "fast", "balanced", "exact"] | None = None,
    *,
    secs: float | None = None,
    frames: int | None = None,
    fps: float | None = None,
    palette: str | None = None,
    quality: int | None = None,
    full_chroma: bool = False,
    samples: str | os.PathLike[str] | None = None,
    method: str | None = None,
    step: _Number | None = None,
    tolerance: _Number | None = None,
    precision: Literal["f32", "df32", "f64", "dd"] | None = None,
    verify: bool = False,
    engine: Literal["cpu", "gpu"] | None = None,
    adapter: str | None = None,
    threads: int | None = None,
    progress: Callable[[int, int], object] | None = None,
    center: _Numbers | None = None,
    width: _Number | None = None,
    rotate: _Number | None = None,
    stretch: _Number | None = None,
    budget: _Number | None = None,
    rule: str | None = None,
    kind: str | None = None,
    masses: _Numbers | None = None,
    lengths: _Numbers | None = None,
    gravity: _Number | None = None,
    friction: _Numbers | None = None,
    ask: str | None = None,
    at: _Number | None = None,
    count: int | None = None,
    plane: str | None = None,
    origin: _Numbers | None = None,
    energy: _Number | None = None,
) -> Film: ...
def tiles(
    scene: _Scene = None,
    size: _Size = (512, 512),
    accuracy: Literal["lesson", "fast", "balanced", "exact"] | None = None,
    *,
    across: int = 4,
    down: int = 4,
    method: str | None = None,
    step: _Number | None = None,
    tolerance: _Number | None = None,
    precision: Literal["f32", "df32", "f64", "dd"] | None = None,
    verify: bool = False,
    center: _Numbers | None = None,
    width: _Number | None = None,
    rotate: _Number | None = None,
    stretch: _Number | None = None,
    budget: _Number | None = None,
    rule: str | None = None,
    kind: str | None = None,
    masses: _Numbers | None = None,
    lengths: _Numbers | None = None,
    gravity: _Number | None = None,
    friction: _Numbers | None = None,
    ask: str | None = None,
    at: _Number | None = None,
    count: int | None = None,
    plane: str | None = None,
    origin: _Numbers | None = None,
    energy: _Number | None = None,
) -> list[Tile]: ...
def trace(
    start: _Numbers,
    until: _Number = 30.0,
    every: _Number = 0.01,
    scene: _Scene = None,
    *,
    rule: str | None = None,
    kind: str | None = None,
    masses: _Numbers | None = None,
    lengths: _Numbers | None = None,
    gravity: _Number | None = None,
    friction: _Numbers | None = None,
    ask: str | None = None,
    budget: _Number | None = None,
    at: _Number | None = None,
    count: int | None = None,
) -> Trace: ...
