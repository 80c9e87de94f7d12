"""The complete case, every default written out: what the results file keeps."""

from __future__ import annotations

import hashlib
import json
from typing import Any

import tomli_w

from tyrefrf.case.digest import file_digests
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

    `[sweep]` has no part in it: no result of the case itself depends on that table. The content
    of files that the case names has. Raises CaseError where one of them cannot be read.
    """
    data = _unswept(resolved(case))
    files = file_digests(case)
    hashed = {**data, "files": files} if files else data
    canonical = json.dumps(hashed, sort_keys=True, separators=(",", ":"))
    return hashlib.sha256(canonical.encode()).hexdigest()
