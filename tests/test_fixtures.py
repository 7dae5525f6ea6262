# SPDX-License-Identifier: Apache-2.0
"""Shared fixtures end when their tests have ended."""

import re
from pathlib import Path

OF_A_PACKAGE = re.compile(r"\bscope=[\"']package[\"']")


def test_a_fixture_of_a_package_stands_in_its_conftest():
    """Of a module pytest keeps it for the session: a gateway would be in later tests' domain."""
    modules = [path for path in Path(__file__).parent.rglob("*.py") if path.name != "conftest.py"]
    assert [path.name for path in modules if OF_A_PACKAGE.search(path.read_text("utf-8"))] == []
