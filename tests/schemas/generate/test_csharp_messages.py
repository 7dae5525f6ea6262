# SPDX-License-Identifier: Apache-2.0
"""The text of the C# messages. That it compiles and does what it should is tested with Mono."""

import re

import pytest

from schemas.generate.catalogue import Catalogue
from schemas.generate.csharp_messages import CSHARP_FOLDER, write
from schemas.installed import InstalledDefinitions, installed_prefixes
from schemas.table import InterfaceRow, Row, Table
from tests.schemas.test_installed import write_definition

THING = "some_msgs/msg/Thing"


@pytest.fixture
def generate(tmp_path):
    """Return a function from the text of some_msgs/msg/Thing to that of its C# file."""

    def from_text(text):
        write_definition(tmp_path, THING, text)
        row = Row(number=0, name=THING, directions="both", purpose="A thing")
        definitions = InstalledDefinitions([tmp_path, *installed_prefixes()])
        return write(Catalogue.of(Table.of([row]), definitions))[f"{CSHARP_FOLDER}/SomeMsgs.cs"]

    return from_text


def of_interfaces(*names):
    rows = [InterfaceRow(name=name, purpose="Something") for name in names]
    return write(Catalogue.of(Table.of([], rows), InstalledDefinitions()))


@pytest.mark.parametrize(
    ("line", "expected"),
    [
        ("bool x", "bool x"),
        ("bool x true", "bool x = true"),
        ("byte x 3", "byte x = 3"),
        ("int8 x", "sbyte x"),
        ("uint64 x 18446744073709551615", "ulong x = 18446744073709551615UL"),
        ("float32 x", "float x"),
        ("float32 x 0.1", "float x = 0.1f"),
        ("float32 x 1e39", "float x = float.PositiveInfinity"),
        ("float64 x nan", "double x = double.NaN"),
        ("string x", 'string x = ""'),
        ("string<=5 x 'a\"b'", 'string x = "a\\"b"'),
        ("wstring x 'ü'", 'string x = "\\u00fc"'),
        ("string x 'a~\x7f'", 'string x = "a~\\u007f"'),
        ("uint8[] x", "byte[] x = Array.Empty<byte>()"),
        ("char[2] x", "byte[] x = new byte[2]"),
        ("int8[<=2] x", "sbyte[] x = Array.Empty<sbyte>()"),
        ("int8[] x [1, 2]", "sbyte[] x = new sbyte[] { 1, 2 }"),
        ("string[2] x", 'string[] x = new string[] { "", "" }'),
        ("std_msgs/Bool x", "StdMsgs.BoolMsg x = new()"),
        (
            "std_msgs/Bool[2] x",
            "StdMsgs.BoolMsg[] x = NestedMessages.Make(2, () => new StdMsgs.BoolMsg())",
        ),
        ("int8 X=-1", "const sbyte X = -1"),
        ("string X=a", 'const string X = "a"'),
    ],
)
def test_a_member_has_its_type_and_its_default(generate, line, expected):
    assert f"        public {expected};\n" in generate(line)


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("x", "x"),
        ("class", "@class"),
        ("class_", "class_"),
        ("Type", "Type_"),
        ("Type_", "Type__"),
        ("Read", "Read_"),
        ("Service", "Service_"),
        ("ThingMsg", "ThingMsg_"),
        ("Thing", "Thing"),
        ("GetHashCode", "GetHashCode_"),
    ],
)
def test_a_name_that_csharp_or_the_class_needs_makes_room_for_it(generate, name, expected):
    source = generate(f"int8 {name}\n")
    assert f"public sbyte {expected};" in source
    assert f'"{name}"' in source  # the name on the wire stays


def test_a_constant_makes_room_for_a_field_of_its_name(generate):
    source = generate("int8 X\nint16 X=1\n")
    assert "public sbyte X;" in source
    assert "public const short X_ = 1;" in source


def test_words_become_documentation(generate):
    source = generate("# Less < more & so on\n\nint8 x # a\tb\nint8[<=3] y\nint8[<=3] z # few\n")
    assert "    /// A thing.\n    ///\n    /// Less &lt; more &amp; so on\n" in source
    assert "/// <summary>a    b</summary>\n        public sbyte x;" in source
    assert "/// <summary><c>int8[&lt;=3]</c></summary>\n        public sbyte[] y" in source
    assert "/// <summary>few (<c>int8[&lt;=3]</c>)</summary>\n        public sbyte[] z" in source


def test_the_parts_of_services_and_actions_name_what_they_are_parts_of():
    files = of_interfaces("std_srvs/srv/SetBool", "test_msgs/action/Fibonacci")
    services = files[f"{CSHARP_FOLDER}/StdSrvs.cs"]
    actions = files[f"{CSHARP_FOLDER}/TestMsgs.cs"]
    classes = re.findall(r"class (\w+) ", services + actions)
    assert classes[:2] == ["SetBoolRequest", "SetBoolResponse"]
    assert classes[2:] == ["FibonacciGoal", "FibonacciResult", "FibonacciFeedback"]
    assert 'const string Type = "std_srvs/srv/SetBool_Request";' in services
    assert services.count('const string Service = "std_srvs/srv/SetBool";') == 2
    assert actions.count('const string Action = "test_msgs/action/Fibonacci";') == 3
