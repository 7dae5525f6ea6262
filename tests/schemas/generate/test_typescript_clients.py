# SPDX-License-Identifier: Apache-2.0
"""The text of the TypeScript interfaces. That it compiles and fits is tested with tsc."""

import pytest

from schemas.generate.typescript_clients import files, text
from schemas.installed import InstalledDefinitions, installed_prefixes
from tests.schemas.generate.client_code import (
    GENERATED,
    awkward_definitions,
    request_of,
)
from tests.schemas.test_installed import write_definition

THING = "some_msgs/msg/Thing"


@pytest.fixture
def generate(tmp_path):
    """Return a function from the text of some_msgs/msg/Thing to that of its module."""

    def from_text(definition, wire="json"):
        write_definition(tmp_path, THING, definition)
        definitions = InstalledDefinitions([tmp_path, *installed_prefixes()])
        return files(request_of(THING, definitions=definitions, wire=wire))["some_msgs.ts"]

    return from_text


@pytest.mark.parametrize(
    ("line", "json", "cbor"),
    [
        ("bool x", "boolean", "boolean"),
        ("bool[] x", "boolean[]", "boolean[]"),
        ("int8 x", "number", "number"),
        ("byte x", "number", "number"),
        ("int64 x", "number", "number | bigint"),
        ("uint64[] x", "number[]", "globalThis.BigUint64Array"),
        ("int16[2] x", "number[]", "globalThis.Int16Array"),
        ("float32 x", "number | null", "number"),
        ("float32[] x", "(number | null)[]", "globalThis.Float32Array"),
        ("float64[<=3] x", "(number | null)[]", "globalThis.Float64Array"),
        ("uint8[] x", "string", "globalThis.Uint8Array"),
        ("byte[4] x", "string", "globalThis.Uint8Array"),
        ("char[<=4] x", "string", "globalThis.Uint8Array"),
        ("uint8 x", "number", "number"),
        ("string x", "string", "string"),
        ("wstring<=5[] x", "string[]", "string[]"),
        ("std_msgs/String x", "std_msgs.String", "std_msgs.String"),
        ("std_msgs/String[3] x", "std_msgs.String[]", "std_msgs.String[]"),
        ("time x", "builtin_interfaces.Time", "builtin_interfaces.Time"),
    ],
)
def test_a_field_has_the_type_that_the_wire_brings(generate, line, json, cbor):
    assert f"\n  x: {json};\n" in generate(line)
    assert f"\n  x: {cbor};\n" in generate(line, "cbor")


@pytest.mark.parametrize(
    ("line", "remark"),
    [
        ("float64[3] x", "`float64[3]`, null is NaN or an infinity"),
        ("uint8[<=9] x", "`uint8[<=9]`, base64"),
        ("int64 x", "`int64`, rounded beyond 2^53"),
        ("string<=5 x", "`string<=5`"),
    ],
)
def test_comments_say_what_a_type_does_not_show(generate, line, remark):
    assert f"/** {remark} */" in generate(line)


@pytest.mark.parametrize(
    ("line", "expected"),
    [
        ("int8 X=-1", "X: -1,"),
        ("bool X=true", "X: true,"),
        ('string X="a\'\u00fc"', 'X: "a\'\\u00fc",'),
        ("float64 X=nan", "X: NaN,"),
        ("float64 X=-inf", "X: -Infinity,"),
        ("float32 X=0.1", "X: 0.1,"),
        ("uint64 X=18446744073709551615", "X: 18446744073709551615,"),
    ],
)
def test_constants_are_values_next_to_the_type(generate, line, expected):
    source = generate(line)
    assert f"export const Thing = {{\n  {expected}\n}} as const;" in source


def test_a_comment_cannot_end_before_its_end(generate):
    source = generate("# one */ two\n\nint8 x  # three */ four\n")
    assert "one * / two" in source
    assert "three * / four" in source


def test_a_message_without_fields_is_an_object_without_members(generate):
    assert "export interface Thing {\n  [name: string]: never;\n}" in generate("")


def test_a_package_is_a_module_that_imports_others():
    made = files(request_of("nav_msgs/srv/GetPlan"))
    assert sorted(made) == [
        "builtin_interfaces.ts",
        "geometry_msgs.ts",
        "nav_msgs.ts",
        "std_msgs.ts",
    ]
    source = made["nav_msgs.ts"]
    assert source.startswith(f"// {GENERATED}\n")
    assert 'import type * as geometry_msgs from "./geometry_msgs.js";\n' in source
    assert "export interface GetPlan_Request {" in source
    assert "  plan: Path;" in source
    assert "  start: geometry_msgs.PoseStamped;" in source


def test_a_package_is_a_name_space_in_one_text():
    source = text(request_of("nav_msgs/srv/GetPlan"))
    assert source.startswith(f"// {GENERATED}\n")
    assert "\nexport namespace nav_msgs {\n" in source
    assert "import" not in source
    assert "    start: geometry_msgs.PoseStamped;" in source


def test_a_package_that_is_a_keyword_gets_an_underscore(tmp_path):
    definitions = awkward_definitions(tmp_path)
    made = files(request_of("import/msg/Thing", definitions=definitions))
    assert {"import_.ts", "default_.ts"} <= set(made)
    assert 'import type * as default_ from "./default_.js";' in made["import_.ts"]
    assert "  thing: default_.Thing;" in made["import_.ts"]
