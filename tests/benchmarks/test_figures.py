# SPDX-License-Identifier: Apache-2.0
"""Only ratios are compared, and one is worse only if a second run confirms it."""

import pytest

from benchmarks import figures
from benchmarks.errors import BenchmarkError
from benchmarks.figures import Figure, compare, ratio


def judge(stored, now, again=None):
    asked = []

    def measure_again(scenario):
        asked.append(scenario)
        return [ratio(scenario, "cpu", again)]

    [verdict] = compare([ratio("x", "cpu", stored)], [ratio("x", "cpu", now)], measure_again)
    return verdict.word, asked


@pytest.mark.parametrize("now", [0.86, 1.0, 1.14])
def test_a_difference_within_the_noise_is_the_same(now):
    assert judge(1.0, now) == ("same", [])


def test_less_is_better():
    assert judge(1.0, 0.8) == ("better", [])


def test_a_ratio_that_is_worse_twice_is_worse():
    assert judge(1.0, 1.3, again=1.2) == ("WORSE", ["x"])


def test_a_ratio_that_is_worse_once_is_not_worse():
    assert judge(1.0, 1.2, again=1.0) == ("same", ["x"])


def test_the_median_of_both_runs_decides():
    assert judge(1.0, 1.5, again=1.0)[0] == "WORSE"
    assert judge(1.0, 1.5, again=0.79)[0] == "same"


def test_a_scenario_is_measured_again_once_for_all_that_looks_worse():
    asked = []
    stored = [ratio("x", name, 1.0) for name in "abc"]
    now = [ratio("x", "a", 2.0), ratio("x", "b", 2.0), ratio("x", "c", 1.0)]

    def measure_again(scenario):
        asked.append(scenario)
        return [ratio("x", name, 1.0) for name in "abc"]

    words = [one.word for one in compare(stored, now, measure_again)]
    assert words == ["WORSE", "WORSE", "same"]  # 1.5
    assert asked == ["x"]


@pytest.mark.parametrize(("stored_is_ratio", "now_is_ratio"), [(0, 0), (0, 1), (1, 0)])
def test_only_ratios_are_compared(stored_is_ratio, now_is_ratio):
    stored = [Figure("x", "cpu", 1.0, "", bool(stored_is_ratio))]
    now = [Figure("x", "cpu", 9.0, "", bool(now_is_ratio))]
    assert compare(stored, now, lambda _: []) == []


def test_a_ratio_without_a_stored_one_is_not_judged():
    assert compare([ratio("x", "other", 1.0)], [ratio("x", "cpu", 9.0)], lambda _: []) == []


def test_written_figures_are_read_again(tmp_path):
    written = [ratio("x", "cpu", 0.5), Figure("x", "p50", 0.25, "ms")]
    figures.write(tmp_path / "some.json", written)
    assert figures.read(str(tmp_path / "some.json")) == written


def test_a_name_is_looked_up_among_the_stored_ones(tmp_path, monkeypatch):
    monkeypatch.setattr(figures, "REFERENCES", tmp_path)
    figures.write(tmp_path / "ref.json", [ratio("x", "cpu", 0.5)])
    assert figures.read("ref") == [ratio("x", "cpu", 0.5)]
    with pytest.raises(BenchmarkError, match=r"no stored figures other.*there are: ref"):
        figures.read("other")


@pytest.mark.parametrize("text", ["{", "[1]", '[{"name":"x"}]', "5"])
def test_a_file_without_figures_is_refused(tmp_path, text):
    (tmp_path / "some.json").write_text(text)
    with pytest.raises(BenchmarkError, match="has no figures"):
        figures.read(str(tmp_path / "some.json"))
