# SPDX-License-Identifier: Apache-2.0
"""The text of the models."""

import pytest

from schemas.definition_text import parse_definition
from schemas.generate.catalogue import GENERATED, Catalogue
from schemas.generate.python_models import class_names, class_source, write
from schemas.installed import InstalledDefinitions
from schemas.models import sensor_msgs
from schemas.table import Row, Table


def source(text, purpose=None):
    definition = parse_definition("some_msgs/msg/Thing", text)
    return class_source(definition, "RIHS01_0", class_names([definition]), purpose)


@pytest.mark.parametrize(
    ("line", "expected"),
    [
        ("bool x", "x: ros.Bool = False"),
        ("byte x 3", "x: ros.UInt8 = 3"),
        ("float32 x", "x: ros.Float32 = 0.0"),
        ("float64 x nan", "x: ros.Float64 = None"),
        ("float64 x inf", 'x: ros.Float64 = float("inf")'),
        ("string x 'a'", 'x: ros.String = "a"'),
        ("string<=5 x", 'x: ros.Annotated[ros.String, ros.Utf8Bound(5)] = ""'),
        (
            "wstring<=5[] x",
            (
                "x: ros.Array[ros.Annotated[ros.WString, ros.Utf16Bound(5)]] = "
                "ros.Field(default_factory=list)"
            ),
        ),
        ("uint8[] x", "x: ros.Octets = b''"),
        (
            "char[2] x",
            "x: ros.Octets = ros.Field(default=bytes(2), min_length=2, max_length=2)",
        ),
        ("int8[<=2] x", "x: ros.Array[ros.Int8] = ros.Field(default_factory=list, max_length=2)"),
        (
            "int8[] x [1, 2]",
            "x: ros.Array[ros.Int8] = ros.Field(default_factory=ros.fresh([1, 2]))",
        ),
        ("a_msgs/A x", "x: A = ros.Field(default_factory=A)"),
        ("int8 from", 'from_: ros.Int8 = ros.Field(default=0, alias="from")'),
        ("int8 x # why", 'x: ros.Int8 = ros.Field(default=0, description="why")'),
    ],
)
def test_a_field_is_one_line_where_it_fits(line, expected):
    assert source(line).splitlines()[-1] == f"    {expected}"


def test_a_class_reads_from_words_to_fields_to_constants():
    assert source("# Words.\n\nint8 ONE=1 # first\nint8 x\n", "A thing") == (
        "class Thing(ros.Message):\n"
        '    """A thing.\n'
        "\n"
        "    Words.\n"
        '    """\n'
        "\n"
        '    ros_type: ros.ClassVar[str] = "some_msgs/msg/Thing"\n'
        '    ros_type_hash: ros.ClassVar[str] = "RIHS01_0"\n'
        "\n"
        "    x: ros.Int8 = 0\n"
        "\n"
        "    ONE: ros.ClassVar[int] = 1  # first\n"
    )


def test_no_control_character_of_a_comment_gets_into_the_source():
    text = source("# above \x1b[31m\x85\n\nint32 x  # beside \x00\x07\nint32 Y=1  # more \x08")
    assert [character for character in text if not character.isprintable()] == ["\n"] * (
        text.count("\n")
    )


def test_a_name_that_two_packages_share_is_prefixed_where_it_is_imported():
    definition = parse_definition("some_msgs/msg/A", "a_msgs/A x\nb_msgs/B y\nc_msgs/B z")

    assert class_names([definition]) == {
        "some_msgs/msg/A": "A",
        "a_msgs/msg/A": "AMsgsA",
        "b_msgs/msg/B": "B",
        "c_msgs/msg/B": "CMsgsB",
    }


def test_an_appended_row_leaves_the_other_classes_where_they_are():
    row = {"directions": "both", "purpose": "x"}
    rows = [
        Row(number=number, name=name, **row)
        for number, name in enumerate(
            ["std_msgs/msg/String", "std_msgs/msg/Bool", "std_msgs/msg/Empty"]
        )
    ]
    definitions = InstalledDefinitions()
    before, after = (
        write(Catalogue.of(Table.of(some), definitions))["schemas/models/std_msgs.py"]
        for some in (rows[:2], rows)
    )
    assert before.split("\n\n\n")[1:] == [
        part for part in after.split("\n\n\n")[1:] if "class Empty" not in part
    ]


def test_every_file_says_that_it_is_generated():
    files = write(Catalogue.of(Table.load(), InstalledDefinitions()))

    assert files
    assert all(text.splitlines()[1] == f"# {GENERATED}" for text in files.values())


def test_a_checked_in_model_carries_words_constants_and_hash():
    battery = sensor_msgs.BatteryState

    assert battery.__doc__.startswith("Voltage, charge and health of a battery.")
    assert battery.model_fields["voltage"].description == "Voltage in Volts (Mandatory)"
    assert battery.POWER_SUPPLY_STATUS_FULL == 4
    assert battery.ros_type == "sensor_msgs/msg/BatteryState"
    assert battery.ros_type_hash == InstalledDefinitions().get(battery.ros_type).type_hash
