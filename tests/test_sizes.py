# SPDX-License-Identifier: Apache-2.0
"""No file and no function is longer than the longest that was accepted."""

import ast
from pathlib import Path

REPOSITORY = Path(__file__).parents[1]
ROOTS = ("gateway", "gateway_sim", "schemas", "benchmarks", "tools")
GENERATED = "schemas/models/"
MAX_FILE_LINES = 350
# files that read best as one
LONGER = {
    "gateway/core/requests.py": 450,  # a catalogue: a class for each request, and their union
}
MAX_FUNCTION_LINES = 77  # Router.__init__ of gateway/core/router.py, one statement per part
ONE_CASE_EACH = "_carry_out"  # grows by each operation, and stays as simple


def source_files():
    files = (path for root in ROOTS for path in (REPOSITORY / root).rglob("*.py"))
    names = (path.relative_to(REPOSITORY).as_posix() for path in files)
    return sorted(name for name in names if not name.startswith(GENERATED))


def too_long(name, source):
    """Return a line for each thing in *source* that exceeds its limit."""
    found = []
    file_lines = len(source.splitlines())
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            lines = node.end_lineno - node.lineno + 1
            if node.name == ONE_CASE_EACH:
                file_lines -= lines
            elif lines > MAX_FUNCTION_LINES:
                found.append(
                    f"{name}:{node.lineno}: {node.name} has {lines} lines,"
                    f" at most {MAX_FUNCTION_LINES}"
                )
    most = LONGER.get(name, MAX_FILE_LINES)
    if file_lines > most:
        found.insert(0, f"{name}: {file_lines} lines, at most {most}: split it by idea")
    return found


def test_no_file_or_function_is_too_long():
    texts = {name: (REPOSITORY / name).read_text(encoding="utf-8") for name in source_files()}
    found = [line for name, text in texts.items() for line in too_long(name, text)]
    assert not found, "\n".join(found)


def test_a_long_file_and_a_long_function_are_found():
    source = "def work():\n" + "    pass\n" * MAX_FILE_LINES

    assert too_long("one.py", source) == [
        f"one.py: {MAX_FILE_LINES + 1} lines, at most {MAX_FILE_LINES}: split it by idea",
        f"one.py:1: work has {MAX_FILE_LINES + 1} lines, at most {MAX_FUNCTION_LINES}",
    ]


def test_a_function_of_one_case_for_each_operation_does_not_count():
    source = f"def {ONE_CASE_EACH}():\n" + "    pass\n" * MAX_FILE_LINES

    assert too_long("one.py", source) == []


def test_a_file_that_was_split_is_no_longer_among_the_longer_ones():
    lengths = {name: len((REPOSITORY / name).read_text("utf-8").splitlines()) for name in LONGER}
    assert {name for name, lines in lengths.items() if lines <= MAX_FILE_LINES} == set()
