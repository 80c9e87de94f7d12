"""The machine that something was measured on."""

from __future__ import annotations

import os
import platform
from importlib.metadata import version
from pathlib import Path


def machine() -> dict[str, str]:
    """Processor, system and versions, by what they are called."""
    return {
        "processor": processor(),
        "cores": str(os.cpu_count()),
        "system": platform.platform(terse=True),
        "Python": platform.python_version(),
        **{name: version(name) for name in ("numpy", "scipy", "tyrefrf")},
    }


def processor() -> str:
    """The processor's name, on Linux from where the kernel says it."""
    cpuinfo = Path("/proc/cpuinfo")
    rows = cpuinfo.read_text().splitlines() if cpuinfo.exists() else []
    names = [row.partition(":")[2].strip() for row in rows if row.startswith("model name")]
    return names[0] if names else platform.processor() or platform.machine()


def blas() -> str:
    """The BLAS libraries of this process, with their threads."""
    from threadpoolctl import threadpool_info

    found = [pool for pool in threadpool_info() if pool["user_api"] == "blas"]
    words = {f"{p['internal_api']} {p['version']}, {p['num_threads']} thread(s)" for p in found}
    return "; ".join(sorted(words))
