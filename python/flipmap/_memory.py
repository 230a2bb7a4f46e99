"""Finds out how much memory a map can have."""

import os
from pathlib import Path

_MEMINFO = Path("/proc/meminfo")
_GROUPS = Path("/sys/fs/cgroup")


def available():
    """Return the bytes of memory that this process can still have, or None where nothing says."""
    known = [room for room in (_machine(), _container()) if room is not None]
    return min(known, default=None)


def _machine():
    """Return the machine's available memory; where only its whole memory is known, that."""
    try:
        for line in _MEMINFO.read_text().splitlines():
            if line.startswith("MemAvailable:"):
                return int(line.split()[1]) * 1024
    except (OSError, ValueError, IndexError):
        pass
    try:
        return os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
    except (AttributeError, OSError, ValueError):
        return None


def _container():
    """Return what a container's limit leaves, if it has one; files in its cache can go."""
    try:
        limit = int((_GROUPS / "memory.max").read_text())
        used = int((_GROUPS / "memory.current").read_text())
        counts = dict(line.split() for line in (_GROUPS / "memory.stat").read_text().splitlines())
    except (OSError, ValueError):
        return None
    return max(0, limit - used + int(counts.get("inactive_file", 0)))
