# SPDX-License-Identifier: Apache-2.0
"""The C# message classes against the gateway's own codecs and models: every type, both ways."""

import json

import pytest

from gateway.codec.json import dumps, loads
from gateway.codec.types import Types
from gateway_sim.content import Inventor
from schemas.generate.catalogue import Catalogue
from schemas.generate.csharp_messages import CSHARP_FOLDER, packaged, write
from schemas.installed import InstalledDefinitions, installed_prefixes
from schemas.table import InterfaceRow, Row, Table
from tests.messages import RandomMessages, to_json
from tests.schemas.test_installed import write_definition
from tests.unity import mono, package
from tests.unity.probe import Probe, Refusal

pytestmark = pytest.mark.skipif(mono.missing() != "", reason=mono.missing())

NOW_NS = 1_700_000_000_123_456_789
TABLE = Catalogue.of(Table.load(), InstalledDefinitions())
TABLE_TYPES = [one.name for one in packaged(TABLE)]
ROWS = [row for row in TABLE.rows if row.name in TABLE_TYPES]

# Names that C#, the generated classes or their methods have for themselves, and every default.
AWKWARD = """\
int8 class
int8 Type
int8 type
int8 Type_
string Read
bool reader
bool writer
int8 member
int8 this
float32 AwkwardMsg
int8 GetType
std_msgs/String[2] Members
std_msgs/String[] Array
geometry_msgs/Point System
string[2] two
string[] many ["a", 'b"', "\\\\"]
string text "say \\"hello\\" \\\\n"
wstring wide "grüße \U0001f916"
bool yes true
int64 least -9223372036854775808
uint64 most 18446744073709551615
uint32 large 4294967295
float32 tenth 0.1
float32[3] floats [1.5, nan, 1e30]
float64 nothing nan
float64 small 5e-324
uint8[3] octets [1, 2, 255]
byte[<=4] few
char letter 65
int8 Write=5
int8 ACTION=1
string TEXT="a\\"b\\\\"
float32 TENTH=0.1
float64 ENDLESS=inf
uint64 ALL=18446744073709551615
int64 LEAST=-9223372036854775808
"""


@pytest.fixture(scope="module")
def definitions(tmp_path_factory):
    prefix = tmp_path_factory.mktemp("awkward")
    write_definition(prefix, "awkward_msgs/msg/Awkward", AWKWARD)
    return InstalledDefinitions([prefix, *installed_prefixes()])


@pytest.fixture(scope="module")
def types(definitions):
    return Types(definitions)


@pytest.fixture(scope="module")
def probe():
    """The classes that are checked in."""
    probe = Probe(package.compiled("Ros2Gateway.Core", package.EDITOR))
    yield probe
    probe.close()


@pytest.fixture(scope="module")
def everything(definitions):
    """Return a catalogue of all that is installed, with the awkward."""
    rows = [
        Row(number=number, name=name, directions="both", purpose="Something")
        for number, name in enumerate(definitions.names())
    ]
    interfaces = [
        InterfaceRow(name=name, purpose="Something")
        for kind in ("srv", "action")
        for name in definitions.names(kind=kind)
    ]
    return Catalogue.of(Table.of(rows, interfaces), definitions)


@pytest.fixture(scope="module")
def probe_of_everything(everything, tmp_path_factory):
    root = tmp_path_factory.mktemp("everything")
    for path, text in write(everything).items():
        (root / path).parent.mkdir(parents=True, exist_ok=True)
        (root / path).write_text(text)
    folders = (package.CLIENT / "Runtime" / name for name in ("Json", "Messages"))
    sources = [path for folder in folders for path in folder.glob("*.cs")]
    generated = (root / CSHARP_FOLDER).glob("*.cs")
    probe = Probe(mono.compile_assembly("Everything", sorted([*sources, *generated])))
    yield probe
    probe.close()


def as_the_gateway_sends(message_type, values):
    """Return CDR of a message, and the JSON that the gateway makes of it."""
    cdr = message_type.encode(values, now_ns=NOW_NS)
    return cdr, dumps(message_type.decode(cdr))


def as_the_gateway_takes(message_type, text):
    return message_type.encode(loads(text), now_ns=0)


def check_round_trip(probe, message_type, values):
    cdr, text = as_the_gateway_sends(message_type, values)
    answer = probe.ask(f"read:{message_type.name}", text)
    assert not isinstance(answer, Refusal), answer
    assert as_the_gateway_takes(message_type, answer) == cdr


@pytest.mark.parametrize("name", TABLE_TYPES)
def test_a_message_of_the_table_comes_back_as_it_went(name, probe, types):
    message_type = types.get(name)
    for seed in range(3):
        values = to_json(RandomMessages(InstalledDefinitions(), seed).message(name))
        check_round_trip(probe, message_type, values)


@pytest.mark.timeout(1800)  # the first test waits for the translation
@pytest.mark.skipif(
    mono.missing_ahead_of_time() != "", reason=mono.missing_ahead_of_time() or "nothing is missing"
)
def test_messages_come_back_without_a_jit_compiler_too(types):
    core = package.compiled("Ros2Gateway.Core", package.ANDROID)
    probe = Probe(core, full_aot=True)
    try:
        for name in TABLE_TYPES:
            values = to_json(RandomMessages(InstalledDefinitions(), 4).message(name))
            check_round_trip(probe, types.get(name), values)
    finally:
        probe.close()


@pytest.mark.parametrize("name", [row.name for row in ROWS])
def test_messages_of_the_mock_system_come_back_as_they_went(name, probe, types):
    values = to_json(Inventor(InstalledDefinitions()).values(name, 3, NOW_NS))
    check_round_trip(probe, types.get(name), values)


@pytest.mark.parametrize("name", TABLE_TYPES)
def test_a_new_message_has_the_defaults_of_its_definition(name, probe, types):
    message_type = types.get(name)
    text = probe.ask(f"new:{name}")
    defaults = message_type.encode({}, now_ns=0)
    assert as_the_gateway_takes(message_type, text) == bytes(defaults)


def test_messages_outside_the_table_have_classes_by_the_same_generator(
    everything, probe_of_everything, types, definitions
):
    for name in (one.name for one in packaged(everything)):
        message_type = types.get(name)
        values = to_json(RandomMessages(definitions, 1, longest=2).message(name))
        check_round_trip(probe_of_everything, message_type, values)


def test_awkward_names_and_defaults_are_those_of_the_definition(probe_of_everything, types):
    awkward = types.get("awkward_msgs/msg/Awkward")
    text = probe_of_everything.ask("new:awkward_msgs/Awkward")
    assert as_the_gateway_takes(awkward, text) == as_the_gateway_sends(awkward, {})[0]


@pytest.mark.parametrize(("text", "count"), [(b"[{}]", 1), (b"[]", 0), (b"[{},{},{}]", 3)])
def test_a_fixed_number_of_messages_is_checked(probe_of_everything, text, count):
    answer = probe_of_everything.ask("read:awkward_msgs/Awkward", b'{"Members":' + text + b"}")
    end = len(text) + 12
    assert answer == Refusal(f"Members: expected 2 elements, got {count} (byte {end})")


def test_null_is_nan(probe, types):
    scan = types.get("sensor_msgs/msg/LaserScan")
    answer = probe.ask(f"read:{scan.name}", b'{"scan_time":null,"ranges":[null,1.5]}')
    message = json.loads(answer)
    assert message["scan_time"] is None
    assert message["ranges"] == [None, 1.5]


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        (b'{"pose":null}', "pose: expected an object, got null (byte 9)"),
        (b'{"header":{"frame_id":null}}', "header.frame_id: expected a string, got null (byte 23)"),
        (
            b'{"pose":{"covariance":[1,2]}}',
            "pose.covariance: expected 36 elements, got 2 (byte 28)",
        ),
        (
            b'{"pose":{"covariance":[1,null,"x"]}}',
            "pose.covariance[2]: expected a number or null, got a string (byte 31)",
        ),
        (
            b'{"header":{"stamp":{"sec":0,"nanosec":-1}}}',
            ("header.stamp.nanosec: expected an integer from 0 to 4294967295, got -1 (byte 39)"),
        ),
        (b"[]", "expected an object, got an array (byte 1)"),
    ],
)
def test_a_value_that_does_not_fit_is_refused_with_its_path(probe, text, reason):
    assert probe.ask("read:geometry_msgs/msg/PoseWithCovarianceStamped", text) == Refusal(reason)


def test_unknown_members_are_skipped(probe):
    text = b'{"new":{"a":[1,"}"]},"data":"x","\\u0064ata":"y"}'
    assert probe.ask("read:std_msgs/msg/String", text) == b'{"data":"y"}'


def test_a_header_without_a_stamp_is_left_to_be_stamped(probe, types):
    header = types.get("std_msgs/msg/Header")
    text = probe.ask("new:std_msgs/msg/Header")
    assert text == b'{"frame_id":""}'
    stamp = header.decode(header.encode(loads(text), now_ns=NOW_NS))["stamp"]
    assert (stamp["sec"], stamp["nanosec"]) == divmod(NOW_NS, 10**9)


@pytest.mark.parametrize("row", ROWS, ids=lambda row: row.name)
def test_a_type_is_known_by_its_number_and_its_short_name(probe, row):
    package_name, _, name = row.name.split("/")
    by_name = probe.ask(f"new:{row.name}")
    assert probe.ask(f"new:{row.number}") == by_name
    assert probe.ask(f"new:{package_name}/{name}") == by_name
