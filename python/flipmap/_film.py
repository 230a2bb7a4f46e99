"""Films: zooms through scenes, and files of keys."""

import os
from typing import NamedTuple

from . import _arguments, _flipmap


class Film(NamedTuple):
    """A film that was made."""

    path: str
    frames: int
    fps: float
    size: tuple
    seconds: float
    engine: str


def film(
    output,
    scenes,
    size=(1280, 720),
    accuracy=None,
    *,
    secs=None,
    frames=None,
    fps=None,
    palette=None,
    quality=None,
    full_chroma=False,
    samples=None,
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
    """Make a film.

    `output` is an .mp4, an .mkv (lossless), a .gif or a .webp, which take ffmpeg, or a folder of
    numbered pictures. `scenes` is one scene, to which the film zooms from the whole map, a list of
    scenes, through which it zooms, or the path or the text of a file of keys; scenes are those of
    `render`. It lasts `secs`, or 1.5 s a decade, and has `frames`, or `fps` (30) of them per second.
    `quality` is 1 to 100, for an .mp4 or .webp; `full_chroma` keeps the colours of an .mp4 at full
    resolution. What is computed is kept in the folder `samples` (OUTPUT.samples by default): the same
    call goes on after a stop. `progress` is called with the numbers done and in all, of samples and
    then of frames. Other arguments are those of `render`, and so are errors; `OSError` is raised for
    what cannot be written. Returns a `Film`.
    """
    making = {
        "output": _arguments.path("output", output),
        "scenes": _arguments.scenes(scenes),
        "size": _arguments.size(size),
        "secs": _arguments.between("secs", secs, 0.01, 1e6),
        "frames": frames
        if frames is None
        else _arguments.whole("frames", frames, 1, _flipmap.MAX_FRAMES),
        "fps": _arguments.between("fps", fps, *_flipmap.FPS),
        "palette": _arguments.name("palette", palette, "a palette's name, or colours"),
        "quality": quality if quality is None else _arguments.whole("quality", quality, 1, 100),
        "full_chroma": _arguments.flag("full_chroma", full_chroma),
        "samples": samples if samples is None else _arguments.path("samples", samples),
    }
    run = _arguments.run({
        "accuracy": accuracy, "method": method, "step": step, "tolerance": tolerance,
        "precision": precision, "verify": verify, "engine": engine, "adapter": adapter,
        "threads": threads,
    })
    words, progress = _arguments.words(words), _arguments.progress(progress)
    made = _flipmap.film(making, words, run, progress)
    return Film(os.fspath(output), made["frames"], made["fps"], tuple(made["size"]),
                made["seconds"], made["engine"])
