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


@pytest.mark.parametrize(
    ("now", "again", "verdict"),
    [
        (0.86, None, "same"),
        (1.14, None, "same"),
        (0.8, None, "better"),
        (1.3, 1.2, "WORSE"),
        (1.2, 1.0, "same"),
        (1.5, 1.0, "WORSE"),  # by the median of both runs
        (1.5, 0.79, "same"),
    ],
)
def test_a_ratio_is_judged_beyond_the_noise_and_measured_again_where_it_looks_worse(
    now, again, verdict
):
    assert judge(1.0, now, again) == (verdict, [] if again is None else ["x"])


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


@pytest.mark.parametrize(
    "stored", [Figure("x", "cpu", 1.0, ""), ratio("x", "other", 1.0)], ids=["time", "other"]
)
def test_only_ratios_with_a_stored_one_are_compared(stored):
    assert compare([stored], [ratio("x", "cpu", 9.0)], lambda _: []) == []
    assert compare([ratio("x", "cpu", 1.0)], [Figure("x", "cpu", 9.0, "")], lambda _: []) == []


def test_written_figures_are_read_again_by_file_and_by_name(tmp_path, monkeypatch):
    monkeypatch.setattr(figures, "REFERENCES", tmp_path)
    written = [ratio("x", "cpu", 0.5), Figure("x", "p50", 0.25, "ms")]
    figures.write(tmp_path / "ref.json", written)
    assert figures.read(str(tmp_path / "ref.json")) == figures.read("ref") == written
    with pytest.raises(BenchmarkError, match=r"no stored figures other.*there are: ref"):
        figures.read("other")


@pytest.mark.parametrize("text", ["{", "[1]", '[{"name":"x"}]', "5"])
def test_a_file_without_figures_is_refused(tmp_path, text):
    (tmp_path / "some.json").write_text(text)
    with pytest.raises(BenchmarkError, match="has no figures"):
        figures.read(str(tmp_path / "some.json"))
