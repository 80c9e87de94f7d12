"""The complete case, every default written out: what the results file keeps."""

from __future__ import annotations

import hashlib
import json
from typing import Any

import tomli_w

from tyrefrf.case.model import Case


def resolved(case: Case) -> dict[str, Any]:
    """Return the case as plain data; keys without a value are left out."""
    return case.model_dump(exclude_none=True)


def resolved_toml(case: Case) -> str:
    """Return the complete case as TOML, in SI; parsed again it gives an equal case."""
    return tomli_w.dumps(resolved(case))


def case_hash(case: Case) -> str:
    """Return the SHA-256 of the resolved case, however its file is written."""
    canonical = json.dumps(resolved(case), sort_keys=True, separators=(",", ":"))
    return hashlib.sha256(canonical.encode()).hexdigest()
