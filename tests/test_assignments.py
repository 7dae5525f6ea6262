# SPDX-License-Identifier: Apache-2.0
"""An object is complete when it is made: only its own module assigns its attributes later."""

import ast
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).parents[1]
# objects of libraries: some of their attributes have the names of ours
FOREIGN = {
    "in_c",  # a C structure
    "info.stamp",  # builtin_interfaces/msg/Time
    "message",  # rcl_serialized_message_t, and action_msgs/msg/GoalStatusArray
    "record",  # logging.LogRecord
    "request",  # websockets.http11.Request
    "response",  # websockets.http11.Response, and responses of services
    "response.stamp",
    "self._message",
}
EXCEPTIONS = {
    # a call for each client would be most of what a further client costs
    "gateway/core/topics/fan_out.py": {
        "queue.sent",
        "queue.sent_bytes",
        "socket.room_bytes",
        "subscription.offered",
    },
}


def attributes(tree: ast.AST) -> Iterator[str]:
    """Yield the names of the attributes that the classes of a module have."""
    for each in (node for node in ast.walk(tree) if isinstance(node, ast.ClassDef)):
        for node in ast.walk(each):
            match node:
                case ast.AnnAssign(target=ast.Name(id=name)):
                    yield name
                case ast.Attribute(value=ast.Name(id="self"), attr=name, ctx=ast.Store()):
                    yield name


def assigned_elsewhere(trees: dict[str, ast.AST]) -> dict[str, set[str]]:
    """Return the assignments to attributes that only classes of other modules have."""
    own = {file: set(attributes(tree)) for file, tree in trees.items()}
    ours = set().union(*own.values())
    found: dict[str, set[str]] = {}
    for file, tree in trees.items():
        for node in ast.walk(tree):
            if not isinstance(node, ast.Attribute) or isinstance(node.ctx, ast.Load):
                continue
            owner = ast.unparse(node.value)
            is_other = node.attr in ours and node.attr not in own[file]
            if is_other and owner not in {"self", "cls", *FOREIGN}:
                found.setdefault(file, set()).add(ast.unparse(node))
    return found


def test_no_attribute_is_assigned_from_another_file():
    files = {path.relative_to(ROOT).as_posix(): path for path in (ROOT / "gateway").rglob("*.py")}
    trees = {file: ast.parse(path.read_text("utf-8")) for file, path in files.items()}
    assert assigned_elsewhere(trees) == EXCEPTIONS


def test_an_assignment_to_an_object_of_another_module_is_found():
    texts = {
        "a.py": "class A:\n def __init__(self):\n  self.x = 1\n\ndef change(a: A):\n a.x = 2",
        "b.py": "def change(a):\n a.x += 1\n a.y = 1\n del a.b.x",
    }
    trees = {name: ast.parse(text) for name, text in texts.items()}
    assert assigned_elsewhere(trees) == {"b.py": {"a.x", "a.b.x"}}
