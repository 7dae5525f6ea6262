# SPDX-License-Identifier: Apache-2.0
"""The tool that breaks lines on purpose, and its list."""

import subprocess
from dataclasses import replace

import pytest

from tools.mutants.__main__ import MIN_KILLED, Fate, Trial, run, verdict
from tools.mutants.mutant import ROOT, Mutant, MutantError, load, page

SOURCE = "LIMIT = 3\n\n\ndef is_allowed(count):\n    return count <= LIMIT\n"
TEST = "import thing\n\n\ndef test_three_are_allowed():\n    assert thing.is_allowed(3)\n"

KILLED = Mutant("thing.py", "three are allowed", "<= LIMIT", "< LIMIT", ("tests/test_thing.py",))
SURVIVOR = replace(KILLED, rule="four are not", old="LIMIT = 3", new="LIMIT = 4")


@pytest.fixture
def tree(tmp_path):
    (tmp_path / "tests").mkdir()
    (tmp_path / "thing.py").write_text(SOURCE)
    (tmp_path / "tests/test_thing.py").write_text(TEST)
    subprocess.run(["git", "init", "--quiet"], cwd=tmp_path, check=True)
    return tmp_path


def test_a_mutant_that_a_test_notices_is_killed_and_one_that_none_notices_survives(tree):
    lines = []
    trials = run([KILLED, SURVIVOR], 1, tree, lines.append)
    assert [outcome.fate for outcome in trials] == [Fate.KILLED, Fate.SURVIVED]
    assert "[2/2] SURVIVED  thing.py: four are not" in lines[-1]
    assert (tree / "thing.py").read_text() == SOURCE
    assert (tree / "tests/test_thing.py").read_text() == TEST


@pytest.mark.parametrize(
    ("source", "count"), [(SOURCE.replace("<=", "<"), 0), (SOURCE + "# <= LIMIT\n", 2)]
)
def test_a_line_that_has_changed_is_named(tree, source, count):
    (tree / "thing.py").write_text(source)
    with pytest.raises(MutantError, match=rf"thing.py: three .* update the list: .* {count} times"):
        run([KILLED], 1, tree)


def test_a_broken_line_must_be_python(tree):
    with pytest.raises(MutantError, match=r"^thing\.py: three are allowed: invalid"):
        run([replace(KILLED, new="<= <=")], 1, tree)


def test_tests_that_fail_without_a_mutant_kill_none(tree):
    (tree / "tests/test_thing.py").write_text(TEST.replace("(3)", "(4)"))
    with pytest.raises(MutantError, match=r"test_thing\.py fails without any mutant"):
        run([KILLED], 1, tree)


@pytest.mark.parametrize(
    ("survivors", "why", "is_good"),
    [(0, None, True), (1, None, False), (1, "a reason", True), (3, "a reason", False)],
)
def test_enough_must_be_killed_and_each_survivor_have_a_reason(survivors, why, is_good):
    killed = Trial(KILLED, Fate.KILLED, 1.0)
    survived = Trial(replace(SURVIVOR, survives=why), Fate.SURVIVED, 1.0)
    lines = []
    trials = [killed] * (20 - survivors) + [survived] * survivors
    assert verdict(trials, lines.append) is is_good
    share = 100 - 5 * survivors
    assert lines[-1].strip() == (
        f"20 mutants, {20 - survivors} killed ({share} %), {survivors} survive"
    )


def test_the_list_fits_the_code():
    for mutant in load():
        mutant.broken(ROOT)


def test_the_page_tells_of_the_list_and_its_survivors():
    expected = page(load(), MIN_KILLED)
    assert (ROOT / "docs/contributing/mutants.md").read_text() == expected, "run make docs"


def test_an_entry_that_is_incomplete_or_names_no_test_is_refused(tmp_path):
    table = tmp_path / "some.toml"
    for entry, reason in (
        ('rule = "r"\nold = "a"\n', r"missing \['new'\]"),
        ('rule = "r"\nold = "a"\nnew = "a"\n', "nothing is broken"),
        ('rule = "r"\nold = "a"\nnew = "b"\n', "there is no tests/core/test_nothing.py"),
    ):
        table.write_text(f'[["gateway/core/nothing.py"]]\n{entry}')
        with pytest.raises(MutantError, match=reason):
            load([table])
