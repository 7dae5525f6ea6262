# SPDX-License-Identifier: Apache-2.0
"""Which faults of samples are reported."""

from gateway.core.topics.sample_faults import SampleFaults

SECOND = 1_000_000_000
MAX_AT_ONCE = 16
REPORTS_EACH_S = 5
REPEATS_AFTER_S = 60


def test_the_first_faults_are_reported_at_once_and_then_one_each_five_seconds():
    faults = SampleFaults(0)
    reported = [number for number in range(100) if faults.note(f"fault {number}", 0)]
    assert reported == list(range(MAX_AT_ONCE))
    assert faults.note("later", REPORTS_EACH_S * SECOND - 1) is None
    assert faults.note("later", REPORTS_EACH_S * SECOND + 1) is not None
    assert faults.note("next", REPORTS_EACH_S * SECOND + 2) is None


def test_the_same_fault_is_reported_again_after_a_minute_with_the_number_of_those_between():
    faults = SampleFaults(0)
    assert faults.note("broken", 0) == "broken"
    for now_s in range(1, REPEATS_AFTER_S):
        assert faults.note("broken", now_s * SECOND) is None
    again = faults.note("broken", REPEATS_AFTER_S * SECOND)
    assert again == "broken (59 more since the last warning)"
    assert faults.note("broken", (2 * REPEATS_AFTER_S - 1) * SECOND) is None


def test_a_fault_is_reported_again_to_a_new_subscriber():
    faults = SampleFaults(0)
    assert faults.note("broken", 0)
    faults.forget()
    assert faults.note("broken", 1) == "broken"


def test_no_more_texts_are_kept_than_are_reported_at_once():
    faults = SampleFaults(0)
    for number in range(10 * MAX_AT_ONCE):
        faults.note(f"fault {number}", number * REPORTS_EACH_S * SECOND)
    assert len(faults._reported) == MAX_AT_ONCE
