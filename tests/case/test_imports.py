"""Reading a case must not cost the import of numpy, scipy, h5py or matplotlib."""

from __future__ import annotations

import doctest
import importlib
import subprocess
import sys

import pytest


def test_the_case_package_imports_nothing_heavy():
    code = (
        "import sys, tyrefrf.case; "
        "print({'numpy', 'scipy', 'h5py', 'matplotlib'} & set(sys.modules) or 'light')"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "light"


@pytest.mark.parametrize("module", ["faults"])
def test_examples_in_docstrings_run(module):
    failed, tried = doctest.testmod(importlib.import_module(f"tyrefrf.case.{module}"))
    assert tried
    assert not failed
