"""The complete case, every default written out: what the results file keeps."""

from __future__ import annotations

import hashlib
import json
from typing import Any

import tomli_w

from tyrefrf.case.files import file_digests
from tyrefrf.case.model import Case


def resolved(case: Case) -> dict[str, Any]:
    """Return the case as plain data; keys without a value are left out."""
    data = case.model_dump(exclude_none=True)
    return data if case.sweep else _unswept(data)


def _unswept(data: dict[str, Any]) -> dict[str, Any]:
    return {key: value for key, value in data.items() if key != "sweep"}


def resolved_toml(case: Case) -> str:
    """Return the complete case as TOML, in SI; parsed again it gives an equal case."""
    return tomli_w.dumps(resolved(case))


def case_hash(case: Case) -> str:
    """Return the SHA-256 of the resolved case, however its file is written.

    The content of files that the case names counts, not where they are. `[sweep]` has no part in
    it: no result of the case itself depends on that table. Raises CaseError for files that cannot
    be read.
    """
    data = _unswept(resolved(case))
    if files := file_digests(case):
        data["files"] = files
    canonical = json.dumps(data, sort_keys=True, separators=(",", ":"))
    return hashlib.sha256(canonical.encode()).hexdigest()
