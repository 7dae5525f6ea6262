# SPDX-License-Identifier: Apache-2.0
"""A name means one thing: no two public classes have the same."""

import ast
from collections import defaultdict
from pathlib import Path

ROOT = Path(__file__).parents[1]
GENERATED = ROOT / "schemas" / "models"
# words for which the field has others: connection, server, cause, counts, queue, values, chunks
UNUSUAL = {
    *("Acceptor", "Asker", "Crowd", "Door", "End", "Entrant", "Fact", "Held", "Heir", "Past"),
    *("Pieces", "Receiver", "Welcome", "Why", "TurnedAwayError"),
    *("acceptor", "asker", "crowd", "door", "doors", "entrant", "facts", "hasten", "heir", "spoil"),
    *("turn_away", "welcome"),
}


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


def test_no_name_has_a_word_for_which_the_field_has_another():
    found = set()
    for path in (ROOT / "gateway").rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            match node:
                case ast.ClassDef(name=name) | ast.FunctionDef(name=name) | ast.arg(arg=name):
                    found.add(name)
                case ast.Name(id=name) | ast.Attribute(attr=name):
                    found.add(name)
    assert {name for name in found if name.lstrip("_") in UNUSUAL} == set()
