# SPDX-License-Identifier: Apache-2.0
"""The text of /metrics, read by the library that Prometheus' own tests use."""

import re
from collections import Counter
from pathlib import Path

from prometheus_client.parser import text_string_to_metric_families

from gateway.metrics.families import FAMILIES, PREFIX
from gateway.metrics.page import PIECE_HISTOGRAMS, PIECE_SAMPLES, pieces
from gateway.metrics.state import State, seen_by
from tests.metrics.states import client_state, state, summary


def samples(of: State) -> dict[tuple[str, ...], float]:
    """Return the values by name and labels. Each must come once."""
    read = [
        ((sample.name, *(f"{k}={v}" for k, v in sorted(sample.labels.items()))), sample.value)
        for family in text_string_to_metric_families("".join(pieces(of)))
        for sample in family.samples
    ]
    assert len(dict(read)) == len(read)
    return dict(read)


def test_the_values_of_a_state_are_read_back():
    read = samples(state())
    labels = ("client=10.0.0.0#0", "topic=/topic0")
    for name, value in {
        "received_total": 10,
        "sent_total": 5,
        "sent_bytes_total": 50,
        "coalesced_total": 1,
        "dropped_total": 2,
        "pending": 2,
    }.items():
        assert read[(f"ros2_gateway_client_messages_{name}", *labels)] == value
        assert read[f"ros2_gateway_topic_messages_{name}", "topic=/topic0"] == value
    assert read["ros2_gateway_topic_received_total", "topic=/topic0"] == 10
    published = ("client=10.0.0.0#0", "topic=/cmd_vel")
    assert read[("ros2_gateway_client_published_total", *published)] == 7
    ended = ("by=client", "code=1000", "reason=closed")
    assert read[("ros2_gateway_connections_ended_total", *ended)] == 2
    assert read["ros2_gateway_handshakes_refused_total", "reason=origin"] == 2
    assert read["ros2_gateway_clients",] == 1
    assert read["ros2_gateway_ros_entities",] == 2
    assert read["ros2_gateway_tasks",] == 4
    assert read["ros2_gateway_relayed_malformed_total",] == 3
    assert read["ros2_gateway_relayed_tokens_refused_total",] == 4
    assert read["ros2_gateway_relayed_dropped_total",] == 5
    assert read["ros2_gateway_drive_guarded", "topic=/cmd_vel"] == 1
    assert read["ros2_gateway_client_latency_seconds_count", "client=10.0.0.0#0"] == 0
    assert read["ros2_gateway_client_link_bytes_per_second", "client=10.0.0.0#0"] == 50_000
    assert read["ros2_gateway_client_round_trip_seconds", "client=10.0.0.0#0"] == 0.25
    assert read["process_resident_memory_bytes",] > 1e6


def test_a_client_without_measurements_has_no_speed_and_no_round_trip_time():
    fast = client_state()._replace(link_bytes_per_s=None, round_trip_s=None)
    read = samples(State(summary(clients=(fast,)), state().traffic))
    assert not [name for name, *_ in read if "link" in name or "round_trip" in name]


def test_a_family_of_several_pieces_is_introduced_once():
    large = state(clients=8, topics=64)
    text = "".join(pieces(large))
    heads = Counter(line for line in text.splitlines() if line.startswith("# "))
    assert set(heads.values()) == {1}
    assert len(samples(large)) > 8 * 64 * 6


def test_no_piece_has_more_samples_than_the_bound():
    assert (PIECE_SAMPLES, PIECE_HISTOGRAMS) == (256, 16)
    for piece in pieces(state(clients=16, topics=64)):
        lines = [line for line in piece.splitlines() if not line.startswith("#")]
        assert len(lines) <= 256


def test_the_alerts_of_the_monitoring_page_use_existing_metrics():
    page = (Path(__file__).parents[2] / "docs/how-to/monitor.md").read_text("utf-8")
    used = set(re.findall(r"\bros2_gateway_\w+", page))
    known = {f"{PREFIX}{each.name}{'_total' * (each.kind == 'counter')}" for each in FAMILIES}
    assert used - known == set()
    assert len(used) > 5


def test_topics_hidden_from_a_role_are_not_on_its_page():
    seen = seen_by(state(topics=3), lambda name: name != "/topic1")
    text = "".join(pieces(seen))
    assert "/topic1" not in text
    assert "/topic2" in text
    assert "/cmd_vel" not in "".join(pieces(seen_by(state(), lambda _: False)))
