# SPDX-License-Identifier: Apache-2.0
"""The stage itself: what runs the C# tests tells failures from successes, and the stub behaves."""

import pytest

from tests.unity import mono, stage

needs_mono = pytest.mark.skipif(bool(mono.missing()), reason=mono.missing())


@pytest.mark.parametrize("tests", stage.parameters())
def test_stage(tests, check_csharp):
    check_csharp(tests)


@pytest.mark.timeout(1800)  # the first one waits for the translation
@pytest.mark.parametrize("tests", stage.parameters())
def test_stage_ahead_of_time(tests, check_ahead_of_time):
    check_ahead_of_time(tests)


@needs_mono
@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("Comparison", "one is not two"),
        ("Exception", "caused by System.FormatException: inner"),
        ("Logged_error", r"unhandled log message: \[Error\] nobody expected this"),
        ("Deadlock", "still running after 0.3 s"),
        ("Death", "InvalidOperationException: in a thread"),
    ],
)
def test_failure_is_told_with_its_reason(name, words, mono_runner):
    with pytest.raises(pytest.fail.Exception, match=words):
        mono_runner.check(stage.test(f"FailingTest.{name}"))


@needs_mono
def test_after_a_test_that_kills_its_process_the_next_one_runs(mono_runner):
    with pytest.raises(pytest.fail.Exception, match="the process ended"):
        mono_runner.check(stage.test("FailingTest.Death"))
    [first, *_] = stage.parameters()
    mono_runner.check(first.values[0][0])


@needs_mono
def test_ahead_of_time_there_is_no_compiler_at_run_time(mono_runner, ahead_of_time_runner):
    jit = stage.test("JitTest.Code_is_made_at_run_time")
    mono_runner.check(jit)
    with pytest.raises(pytest.fail.Exception, match=r"(?i)jit"):
        ahead_of_time_runner.check(jit)


@needs_mono
def test_a_warning_is_an_error(tmp_path):
    source = tmp_path / "Warning.cs"
    source.write_text("class Warning { int Unused() { int x; return 1; } }")
    with pytest.raises(mono.CompileError, match="CS0168"):
        mono.compile_assembly("Warning", [source])


def test_names_of_tests_are_unique():
    names = [test.name for parameter in stage.parameters() for test in parameter.values[0]]
    assert len(names) == len(set(names))
