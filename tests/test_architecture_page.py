# SPDX-License-Identifier: Apache-2.0
"""The pages about the code name files, classes, and methods that exist."""

import ast
import re
from pathlib import Path

ROOT = Path(__file__).parents[1]
PAGE = ROOT / "docs/contributing/architecture.md"
PATHS = ROOT / "docs/contributing/data-paths.md"
TERMS = ROOT / "docs/contributing/code-terms.md"
ROW = re.compile(r"^\| `([\w.<>]+)` \| `([^`]+)` \|", re.MULTILINE)


def rows() -> list[tuple[str, str]]:
    return ROW.findall(PATHS.read_text("utf-8"))


def names_in(file: str) -> set[str]:
    """Return the functions and classes of a file, methods as ``Class.method``."""
    names = set()
    for node in ast.parse((ROOT / file).read_text("utf-8")).body:
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
            names.add(node.name)
        if isinstance(node, ast.ClassDef):
            functions = (ast.FunctionDef, ast.AsyncFunctionDef)
            names |= {f"{node.name}.{f.name}" for f in node.body if isinstance(f, functions)}
    return names


def test_every_function_of_the_ways_is_where_the_page_says():
    there = {file: names_in(file) for _, file in rows() if not file.startswith("<")}  # generated
    assert len(rows()) > 50
    for function, file in rows():
        if file in there:
            assert function.partition(".<locals>")[0] in there[file], f"{function} of {file}"


def test_every_file_that_is_named_exists():
    text = PAGE.read_text("utf-8") + PATHS.read_text("utf-8")
    named = re.findall(r"`((?:gateway|gateway_sim|schemas|tests)/[\w/.*]*)`", text)
    assert len(named) > 40
    assert [name for name in named if not list(ROOT.glob(name.rstrip("/")))] == []


def test_each_term_is_explained_once_in_order():
    rows = re.findall(r"^\| (.+?) \| ", TERMS.read_text("utf-8"), re.MULTILINE)
    words = [word.replace("`", "").lower() for word in rows]
    assert len(words) > 60
    assert words[1:] == sorted(set(words[1:]))


def test_every_class_and_method_that_is_named_exists():
    files = (path.relative_to(ROOT) for path in (ROOT / "gateway").rglob("*.py"))
    defined = {name for file in files for name in names_in(str(file))}
    text = "".join(page.read_text("utf-8") for page in (PAGE, PATHS, TERMS))
    named = set(re.findall(r"`([A-Z]+[a-z]\w*(?:\.\w+)?)`", text))
    assert len(named) > 120
    assert named - defined == set()


def test_the_docstrings_of_the_packages_point_to_the_page():
    names = "access cli codec config core core/rosapi fronts/rosbridge sources/rclpy tf transport"
    for name in ("", *names.split()):
        text = (ROOT / "gateway" / name / "__init__.py").read_text("utf-8")
        assert "docs/contributing/architecture.md" in (ast.get_docstring(ast.parse(text)) or "")
