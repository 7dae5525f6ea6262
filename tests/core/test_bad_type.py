# SPDX-License-Identifier: Apache-2.0
from pathlib import Path

import pytest

from gateway.codec.error_text import MAX_ECHO
from gateway.core.bad_type import bad_type
from schemas.definition import DefinitionError
from schemas.installed import InstalledDefinitions, UnknownTypeError
from schemas.table import TypeNameError


def test_an_unknown_type_is_refused_with_the_nearest_name() -> None:
    definitions = InstalledDefinitions()
    with pytest.raises(UnknownTypeError) as caught:
        definitions.get("nav_msgs/msg/Odometri")
    refusal = bad_type(caught.value, definitions)
    assert refusal.code == "bad_type"
    assert str(refusal) == (
        "type: no definition of nav_msgs/msg/Odometri is installed; "
        "did you mean nav_msgs/msg/Odometry?"
    )


def test_the_guess_is_for_what_is_missing_not_for_what_nests_it(tmp_path: Path) -> None:
    messages = tmp_path / "share" / "my_msgs" / "msg"
    messages.mkdir(parents=True)
    (messages / "C.msg").write_text("other_msgs/D d", encoding="utf-8")
    definitions = InstalledDefinitions([tmp_path])
    with pytest.raises(UnknownTypeError) as caught:
        definitions.closure(["my_msgs/msg/C"])
    assert str(bad_type(caught.value, definitions)) == (
        "type: no definition of other_msgs/msg/D is installed: install its package, or name a"
        " folder that has the definition in types.paths"
    )


def test_an_invalid_type_name_is_refused_with_a_suggestion() -> None:
    error = TypeNameError("'twist' is not a valid message type", "twist")
    assert str(bad_type(error, InstalledDefinitions())) == (
        "type: 'twist' is not a valid message type; did you mean geometry_msgs/msg/Twist?"
    )
    error = TypeNameError("'set_bool' is not a valid service type", "set_bool", "srv")
    assert str(bad_type(error, InstalledDefinitions())).endswith("mean std_srvs/srv/SetBool?")


@pytest.mark.parametrize(("kind", "most"), [(DefinitionError, 512), (TypeNameError, MAX_ECHO)])
def test_other_faults_are_told_as_they_are_but_shortened(
    kind: type[DefinitionError] | type[TypeNameError], most: int
) -> None:
    definitions = InstalledDefinitions()
    assert str(bad_type(kind("A nests itself"), definitions)) == "type: A nests itself"
    assert len(str(bad_type(kind("x" * 10_000), definitions))) == len("type: ") + most


def test_idl_that_cannot_be_read_is_told_with_its_place_and_a_way_out(tmp_path: Path) -> None:
    messages = tmp_path / "share" / "my_robots_perception_msgs" / "msg"
    messages.mkdir(parents=True)
    text = "module my_robots_perception_msgs { module msg {\n  enum Colour { RED };\n}; };"
    (messages / "ColouredObstacle.idl").write_text(text, encoding="utf-8")
    definitions = InstalledDefinitions([tmp_path])
    with pytest.raises(DefinitionError) as caught:
        definitions.get("my_robots_perception_msgs/msg/ColouredObstacle")
    assert str(bad_type(caught.value, definitions)) == (
        "type: my_robots_perception_msgs/msg/ColouredObstacle.idl, line 2, column 3: rosidl has no"
        " enums; use an integer, and constants in a module NAME_Constants"
    )
