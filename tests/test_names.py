# SPDX-License-Identifier: Apache-2.0
"""A name means one thing: no two public classes have the same."""

import ast
from collections import defaultdict
from pathlib import Path

ROOT = Path(__file__).parents[1]
GENERATED = ROOT / "schemas" / "models"


def test_no_two_public_classes_have_one_name():
    files = defaultdict(list)
    for room in ("gateway", "gateway_sim", "schemas"):
        for path in (ROOT / room).rglob("*.py"):
            if GENERATED in path.parents:
                continue
            for node in ast.parse(path.read_text("utf-8")).body:
                if isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
                    files[node.name].append(path.relative_to(ROOT).as_posix())
    assert len(files) > 300
    # an operation of rosbridge has the name of the request that it makes
    operations, requests = "gateway/fronts/rosbridge/operations/", "gateway/core/requests.py"
    for paths in files.values():
        if requests in paths:
            paths[:] = [each for each in paths if not each.startswith(operations)]
    assert {name: paths for name, paths in files.items() if len(paths) > 1} == {}
