# SPDX-License-Identifier: Apache-2.0
"""The pages' modules, read by TypeScript: an undefined name is found without a browser."""

import subprocess
from pathlib import Path

import pytest

from tests.clients.driver import INSTALLED

PAGES = Path(__file__).parents[2] / "gateway/fronts/pages"
COMPILER = INSTALLED / "typescript-5.9.3/node_modules/typescript/bin/tsc"
STRICTNESS = (
    *("--allowJs", "--checkJs", "--noEmit", "--target", "es2022", "--module", "esnext"),
    *("--moduleResolution", "bundler", "--lib", "dom,dom.iterable,es2022", "--pretty", "false"),
)


@pytest.mark.skipif(not COMPILER.exists(), reason="no TypeScript: sh tools/make-clients.sh VENV")
def test_every_module_uses_what_there_is():
    modules = [each for each in PAGES.rglob("*.js") if each.parent.name != "vendor"]
    assert len(modules) > 30
    command = ["node", str(COMPILER), *STRICTNESS, *map(str, modules)]
    finished = subprocess.run(command, capture_output=True, text=True, cwd=PAGES, check=False)
    lines = finished.stdout.splitlines()
    # errors in a library are not ours. An indented line continues the line before
    assert [each for each in lines if not each.startswith(("vendor/", " "))] == []
