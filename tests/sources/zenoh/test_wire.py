# SPDX-License-Identifier: Apache-2.0
"""The wire of rmw_zenoh, compared with recordings of the real one."""

import contextlib
import json
import struct
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from gateway.sources.source import Qos
from gateway.sources.zenoh.attachment import Attachment, read_attachment
from gateway.sources.zenoh.keys import (
    NO_TYPE_HASH,
    DataKey,
    WireError,
    parse_key,
)
from gateway.sources.zenoh.qos_text import TokenQos, parse_qos, qos_text
from gateway.sources.zenoh.tokens import (
    EndpointToken,
    NodeToken,
    endpoint_token,
    gid_of,
    parse_token,
)
from tests.sources.zenoh.recordings import NAMES, of_robot, recording, tokens

STRING_HASH = "RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18"
STRING_KEY = DataKey(46, "/a/b", "std_msgs/msg/String", STRING_HASH)
NODE = NodeToken(46, "7372a0de", 0, "/ns/talker")
# any profile that we may have, and the real one may
TOKEN = endpoint_token(NODE, 3, "MP", STRING_KEY, Qos(depth=10))


def written(token: str) -> str:
    """Return what this package writes for what it reads."""
    read = parse_token(token)
    if isinstance(read, NodeToken):
        return read.text
    qos = read.qos
    ours = Qos(
        qos.reliability,
        qos.durability,
        qos.history,
        qos.depth,
        qos.deadline_ns,
        qos.lifespan_ns,
        qos.lease_ns,
    )
    return endpoint_token(read.of, read.entity_id, read.kind, read.key, ours)


@pytest.mark.parametrize("name", NAMES)
def test_each_token_of_the_real_one_is_read_and_written_byte_for_byte(name):
    found = tokens(name)
    assert len(found) >= 11
    for token in found:
        # nothing here is manual, nor "best available"
        expected = token.replace("/4:4:,", "/::,").replace(":3,", ":,")
        assert written(token) == expected


def test_profiles_are_read_as_the_real_graph_reads_them():
    known = {
        (token.kind, token.key.name): token
        for token in map(parse_token, tokens("3_listener_qos"))
        if isinstance(token, EndpointToken)
    }
    seen = 0
    for line in of_robot("3_listener_qos", "event"):
        note = json.loads(line["note"])
        if "real_graph_says" not in note:
            continue
        token = known[note["kind"], note["topic"]]
        assert token.gid.hex() == note["gid"]
        assert as_rmw(token.qos) == normal(note["real_graph_says"])
        seen += 1
    assert seen >= 30


FOREVER = 2**63 - 1


def as_rmw(qos: TokenQos) -> list[object]:
    times = [FOREVER if each is None else each for each in (qos.deadline_ns, qos.lifespan_ns)]
    lease = FOREVER if qos.lease_ns is None else qos.lease_ns
    kind = "MANUAL_BY_TOPIC" if qos.is_manual else "AUTOMATIC"
    kept = [qos.reliability.upper(), qos.durability.upper(), qos.history.upper(), qos.depth]
    return [*kept, *times, kind, lease]


def normal(said: list[object]) -> list[object]:
    """Return what rmw's graph says of a profile, where it says no more than its name."""
    values = {0: "RELIABLE", 1: "VOLATILE"}
    return [
        values.get(index, each) if each == "BEST_AVAILABLE" else each
        for index, each in enumerate(said)
    ]


@pytest.mark.parametrize("name", NAMES)
def test_each_sample_names_its_publisher_and_its_key_that_of_the_token(name):
    by_gid = {
        token.gid: token
        for token in map(parse_token, tokens(name))
        if isinstance(token, EndpointToken)
    }
    samples = [line for line in of_robot(name, "put") if line["attachment"]]
    assert samples
    for line in samples:
        attachment = bytes.fromhex(line["attachment"])
        read = read_attachment(attachment)
        assert read.packed == attachment
        key = parse_key(line["key"])
        assert key.text == line["key"]
        assert by_gid[read.gid].key == key


def test_the_names_of_nodes_and_topics_are_those_of_ros():
    found = {
        (token.of.node, token.key.name, token.key.type_name)
        for token in map(parse_token, tokens("7_names"))
        if isinstance(token, EndpointToken)
    }
    assert ("/ns/sub/inner", "/rosout", "rcl_interfaces/msg/Log") in found
    domains = {parse_token(token).domain_id for token in tokens("7_names")
               if isinstance(parse_token(token), NodeToken)}  # fmt: skip
    assert domains == {46, 47}


def test_a_token_may_end_in_parts_of_a_later_version():
    for more, has_buffers in (("backends:cpu:", True), ("later:1/backends:cpu:", False)):
        changed = {"gid": gid_of(f"{TOKEN}/{more}"), "has_buffers": has_buffers}
        assert parse_token(f"{TOKEN}/{more}") == replace(parse_token(TOKEN), **changed)


def test_the_older_attachment_is_read():
    gid = bytes(range(16))
    old = b"".join(
        (
            *(b"\x0fsequence_number", struct.pack("<q", 7)),
            *(b"\x10source_timestamp", struct.pack("<q", 8)),
            *(b"\x0asource_gid", b"\x10", gid),
        )
    )
    assert read_attachment(old) == Attachment(7, 8, gid)
    with pytest.raises(WireError, match="77 bytes"):
        read_attachment(old.replace(b"gid", b"xid"))


def test_an_action_has_types_of_several_words():
    name = "test_msgs/action/Fibonacci_SendGoal"
    key = DataKey(0, "/fib/_action/send_goal", name, NO_TYPE_HASH)
    assert key.text == (
        "0/fib/_action/send_goal/test_msgs::action::dds_::Fibonacci_SendGoal_/TypeHashNotSupported"
    )
    assert parse_key(key.text) == key


durations = st.none() | st.integers(0, 2**63 - 2)
profiles = st.builds(
    Qos,
    st.sampled_from(["reliable", "best_effort"]),
    st.sampled_from(["volatile", "transient_local"]),
    st.sampled_from(["keep_last", "keep_all"]),
    st.integers(1, 2**31),
    durations,
    durations,
    durations,
)


@given(profiles)
def test_each_profile_that_is_written_is_read(qos):
    read = parse_qos(qos_text(qos))
    as_ours = (read.reliability, read.durability, read.history, read.depth)
    assert as_ours == (qos.reliability, qos.durability, qos.history, qos.depth)
    assert (read.deadline_ns, read.lifespan_ns, read.lease_ns) == (
        qos.deadline_ns,
        qos.lifespan_ns,
        qos.lease_ns,
    )


@st.composite
def nearly_tokens(draw):
    """Return a token with a few of its parts replaced by what a peer may think of."""
    parts = TOKEN.split("/")
    odd = st.text(max_size=40) | st.sampled_from(
        ["", "%", "%%", "$*", "**", "*", "9" * 21, "-1", "²", "a::msg::dds_::B_", ":" * 9, ",,"]
    )
    for index in draw(st.sets(st.integers(0, len(parts) - 1), max_size=3)):
        parts[index] = draw(odd)
    return "/".join(parts[: draw(st.integers(0, len(parts)))])


@given(nearly_tokens() | st.text())
def test_all_that_a_peer_declares_is_a_token_or_an_error(text):
    with contextlib.suppress(WireError):
        parse_token(text)


@given(st.text() | st.from_regex(r"[0-9]{1,30}(/[a-z%$*]{0,5}){0,9}"))
def test_each_key_is_a_data_key_or_an_error(text):
    try:
        key = parse_key(text)
    except WireError:
        return
    assert parse_key(key.text) == key


@given(st.binary(max_size=100) | st.binary(min_size=33, max_size=33))
def test_each_attachment_is_read_or_an_error(data):
    try:
        read = read_attachment(data)
    except WireError:
        return
    assert len(read.gid) == 16


def test_texts_of_any_length_are_refused_without_being_looked_at():
    for parse in (parse_token, parse_key):
        with pytest.raises(WireError, match="at most 2048"):
            parse(TOKEN + "x" * 2048)
    parse_token(TOKEN + "/" + "x" * (2048 - len(TOKEN) - 1))


def test_other_keys_are_refused():
    for key in ("", "46", "46/a", "46/a/std_msgs::msg::dds_::String_", "46//std/RIHS01_0"):
        with pytest.raises(WireError):
            parse_key(key)
    assert recording("1_talker")
