# SPDX-License-Identifier: Apache-2.0
"""The tool that breaks code on purpose: its rules, its runs, and its waivers."""

import random
import re
import subprocess

import pytest

from tools.mutants.__main__ import MIN_KILLED, MutantError, Trial, run, verdict
from tools.mutants.rules import EVERYWHERE, IN_SAFETY, mutants_of
from tools.mutants.selection import (
    ELSEWHERE,
    ROOT,
    SAFETY,
    all_mutants,
    select,
    stages_of,
    waivers,
)

RULES = EVERYWHERE | IN_SAFETY
DOUBLE = "number (4 * 2 + 1)"
SOURCE = """\
LIMIT = 3
MAX_COUNT: Final = 3


def is_allowed(count):
    return count <= LIMIT


def is_wide(count):
    return count + 2 > 5
"""
TEST = "import thing\n\n\ndef test_three_are_allowed():\n    assert thing.is_allowed(3)\n"


@pytest.fixture(scope="module")
def everything():
    return list(all_mutants())


@pytest.mark.parametrize(
    ("line", "made"),
    [
        ("MAX: Final = 64", {"bound 128", "bound 32"}),
        ("SHARE: Final[float] = 0.5", {"bound 1.0", "bound 0.25"}),
        ("A_BYTES: Final = 4 * MIB", {"bound (4 * MIB) * 2", "bound (4 * MIB) // 2", DOUBLE}),
        ("DUE_S = FAST_S / 4", {"bound (FAST_S / 4) * 2", "bound (FAST_S / 4) / 2", DOUBLE}),
        ("most: Count = Field(8, description='')", {"bound 16", "bound 4"}),
        ("FIRST: Final = 0", set()),
        ("OTHER: Final = MAX", set()),
        ("n <= MAX", {"limit n < MAX"}),
        ("0 < n <= m", {"off_by_one 0 <= n <= m", "off_by_one 0 < n < m"}),
        ("a is None", {"opposite a is not None"}),
        ("a not in b", {"opposite a in b"}),
        ("min(a, b)", {"extreme max", "call None"}),
        ("x = a / 4", {DOUBLE}),
        ("x = a + b", {"sign a - b"}),
        ("x = a + 'b'", set()),
        ("if a: raise B", {"refusal False"}),
        ("def f():\n    if a: return", {"early_end False"}),
        ("if a: return_it = a\nelse: raise B", set()),
        ("x = a and b and c", {"operand (a and b)", "operand (a and c)", "operand (b and c)"}),
        ("x = not (a or b)", {"negation (a or b)", "operand (a)", "operand (b)"}),
        ("x = f(True)", {"flag False"}),
        ("await stop()", {"call None"}),
        ("logger.info('%d', 1 < 2)", set()),
        ("assert a is None", set()),
        ("@dataclass(frozen=True)\nclass A: pass", set()),
    ],
)  # fmt: skip
def test_each_rule_breaks_what_it_is_for(line, made):
    source = line.encode()
    mutants = list(mutants_of("gateway/x.py", source, RULES))
    assert {f"{mutant.rule} {mutant.new}" for mutant in mutants} == made
    assert all(mutant.broken(source) != source for mutant in mutants)


def test_a_part_is_replaced_where_it_is_and_named_by_its_function():
    source = "x = 'ä'\nclass A:\n    def f(self):\n        return 'ä' if a \\\n  <= b else 0\n"
    [mutant] = mutants_of("gateway/x.py", source.encode(), RULES)
    assert mutant.name == "gateway/x.py A.f: a <= b -> a < b"
    assert mutant.broken(source.encode()).decode() == source.replace("a \\\n  <= b", "a < b")


def test_all_rules_are_used_and_what_they_make_is_python(everything):
    assert {mutant.rule for mutant in everything} == RULES.keys()
    for mutant in random.Random(1).sample(everything, 100):
        compile(mutant.broken((ROOT / mutant.file).read_bytes()), mutant.file, "exec")


def test_rules_of_safety_are_for_files_that_move_a_robot(everything):
    strict = {mutant.file for mutant in everything if mutant.rule in IN_SAFETY}
    assert all(file.startswith(SAFETY) for file in strict)
    assert all(any(file.startswith(path) for file in strict) for path in SAFETY)


def test_each_waiver_is_of_a_mutant(everything):
    unknown = waivers().keys() - {mutant.name for mutant in everything}
    advice = "no rule makes these mutants: remove them from tools/mutants/waivers.toml"
    assert not unknown, "\n".join([advice, *sorted(unknown)])


def test_a_sample_is_the_same_for_the_same_seed(everything):
    chosen = select(everything, ["gateway/drive"], ["bound", "limit"], 9, 3)
    assert len(set(chosen)) == 9
    assert chosen == select(everything, ["gateway/drive"], ["bound", "limit"], 9, 3)
    assert chosen != select(everything, ["gateway/drive"], ["bound", "limit"], 9, 4)
    assert {mutant.rule for mutant in chosen} <= {"bound", "limit"}
    assert all(mutant.file.startswith("gateway/drive/") for mutant in chosen)


def test_the_nearest_tests_come_first_and_none_twice(everything):
    assert stages_of("gateway/core/outbox.py")[0] == ["tests/core/test_outbox.py"]
    assert "tests/drive/test_drive.py" in stages_of("gateway/drive/burst.py")[0]  # has no mirror
    for file in {mutant.file for mutant in everything}:
        tests = [test for stage in stages_of(file) for test in stage]
        assert tests, file
        assert len(tests) == len(set(tests))


def test_the_table_of_other_tests_names_files():
    paths = [path.rstrip("/") for path in (*ELSEWHERE, *sum(ELSEWHERE.values(), ()))]
    assert [path for path in paths if not list(ROOT.glob(f"{path}*"))] == []


def test_the_page_describes_each_rule():
    page = (ROOT / "docs/contributing/mutants.md").read_text()
    assert dict(re.findall(r"^\| `(\w+)` \| (.*?) \|$", page, re.MULTILINE)) == {
        rule: effect[0].upper() + effect[1:] for rule, effect in RULES.items()
    }


@pytest.fixture
def tree(tmp_path):
    folder = tmp_path / "tests/tools"
    folder.mkdir(parents=True)
    (tmp_path / "tools").mkdir()
    (tmp_path / "thing.py").write_text("from tools.thing import *\n")
    (tmp_path / "tools/thing.py").write_text(SOURCE.replace(": Final", ""))
    (folder / "test_thing.py").write_text(TEST)
    subprocess.run(["git", "init", "--quiet"], cwd=tmp_path, check=True)
    return tmp_path


def trials(tree, lines):
    source = (tree / "tools/thing.py").read_bytes()
    mutants = list(mutants_of("tools/thing.py", source, {"limit": "", "number": ""}))
    return run(mutants, 1, tree, lines.append)


def test_a_mutant_that_a_test_notices_is_killed_and_one_that_none_notices_survives(tree):
    before = {path: path.read_bytes() for path in tree.rglob("*.py")}
    lines = []
    killed, survived = trials(tree, lines)
    assert (killed.killer, survived.killer) == ("tests/tools/test_thing.py", None)
    assert "\n-    return count + 2 > 5\n+    return count + (2 * 2 + 1) > 5" in survived.difference
    assert "[1/2] limit: tools/thing.py is_allowed: count <= LIMIT -> count < LIMIT" in lines[0]
    assert "SURVIVED" in lines[1]
    assert {path: path.read_bytes() for path in tree.rglob("*.py")} == before


def test_tests_that_fail_without_a_mutant_kill_none(tree):
    (tree / "tests/tools/test_thing.py").write_text(TEST.replace("(3)", "(4)"))
    with pytest.raises(MutantError, match=r"test_thing\.py fails without any mutant"):
        trials(tree, [])


@pytest.mark.parametrize("survivors", [0, 1, 2, 3])
def test_enough_must_be_killed_and_survivors_are_shown(survivors):
    [mutant] = mutants_of("tools/thing.py", b"a <= B", {"limit": ""})
    killers = [None] * survivors + ["tests/tools/test_thing.py"] * (20 - survivors)
    lines = []
    is_good = verdict([Trial(mutant, killer, 1.0, "- a") for killer in killers], lines.append)
    assert is_good is (20 - survivors >= 20 * MIN_KILLED)
    words = f"all 20 mutants {20 - survivors} killed {100 - 5 * survivors}%"
    assert " ".join(lines[-1].split()) == words
    assert lines.count("\n- a") == survivors
