# SPDX-License-Identifier: Apache-2.0
"""`python -m schemas.generate`."""

import importlib.util
import json
import re
from pathlib import Path

import pytest

from schemas.backports import tomllib
from schemas.generate.__main__ import main
from schemas.generate.csharp_messages import CSHARP_FOLDER
from schemas.installed import InstalledDefinitions, installed_prefixes

REPOSITORY = Path(__file__).parents[3]
TABLE = """\
messages = [
  { number = 0, name = "std_msgs/msg/String", directions = "both", purpose = "Text" },
  # more
]
"""
NEW_ROW = '{ number = 1, name = "made_up_msgs/msg/Lamp", directions = "both", purpose = "A lamp" },'


INTERFACES = """\
interfaces = [
  { name = "test_msgs/action/Fibonacci", purpose = "Counts rabbits" },
  { name = "std_srvs/srv/SetBool", purpose = "Switches" },
]
"""


@pytest.fixture
def tree(tmp_path):
    """Return the arguments that generate from a table in tmp_path into a tree there."""
    (tmp_path / "messages.toml").write_text(TABLE)
    return ["--table", str(tmp_path / "messages.toml"), "--root", str(tmp_path / "tree")]


@pytest.fixture
def made_up(tmp_path):
    folder = tmp_path / "share" / "made_up_msgs" / "msg"
    folder.mkdir(parents=True)
    (folder / "Lamp.msg").write_text(
        "# Says how bright.\n\nstd_msgs/Header header\nuint8 level 7\n"
    )
    return InstalledDefinitions([tmp_path, *installed_prefixes()])


def files(tmp_path):
    root = tmp_path / "tree"
    return sorted(str(path.relative_to(root)) for path in root.rglob("*") if path.is_file())


def generated_module(tmp_path, package):
    path = tmp_path / "tree" / "schemas" / "models" / f"{package}.py"
    spec = importlib.util.spec_from_file_location(f"{package}_models", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_the_rows_that_the_page_shows_work_on_the_types_that_the_wheels_have(tmp_path):
    page = (REPOSITORY / "docs/how-to/own-messages.md").read_text(encoding="utf-8")
    message, interface = re.findall(r"^```toml\n(  \{ .*\},)\n^```", page, re.MULTILINE)
    table = (REPOSITORY / "schemas/messages.toml").read_text(encoding="utf-8")
    messages, _, interfaces = table.partition("\n]\n")
    ends = interfaces.rstrip().removesuffix("]")
    (tmp_path / "messages.toml").write_text(f"{messages}\n{message}\n]\n{ends}{interface}\n]\n")
    arguments = ["--table", str(tmp_path / "messages.toml"), "--root", str(tmp_path / "tree")]
    assert main(arguments) == 0
    written = (
        tmp_path / "tree/docs/reference/messages.md",
        tmp_path / "tree/docs/reference/services.md",
    )
    for row, path in zip((message, interface), written, strict=True):
        name = tomllib.loads(f"rows = [{row}]")["rows"][0]["name"]
        assert name not in table
        assert name in path.read_text(encoding="utf-8")


def test_the_files_in_the_repository_are_up_to_date(capsys):
    assert main(["--check"]) == 0, capsys.readouterr().out


def test_it_writes_models_schemas_classes_and_the_reference_page(tmp_path, tree, capsys):
    assert main(tree) == 0
    assert files(tmp_path) == [
        "docs/reference/messages.md",
        "docs/reference/services.md",
        "schemas/json/std_msgs/String.json",
        "schemas/models/__init__.py",
        "schemas/models/std_msgs.py",
        f"{CSHARP_FOLDER}/MessageTable.cs",
        f"{CSHARP_FOLDER}/StdMsgs.cs",
    ]
    assert capsys.readouterr().out.count("wrote ") == 7


def test_a_second_run_changes_nothing(tree, capsys):
    main(tree)
    capsys.readouterr()

    assert main(tree) == 0
    assert main([*tree, "--check"]) == 0
    assert capsys.readouterr().out == ""


def test_one_row_more_generates_its_type(tmp_path, tree, made_up):
    main(tree, made_up)
    table = tmp_path / "messages.toml"
    table.write_text(TABLE.replace("# more", NEW_ROW))

    assert main([*tree, "--check"], made_up) == 1
    assert main(tree, made_up) == 0
    module = generated_module(tmp_path, "made_up_msgs")
    lamp = module.Lamp.model_validate({"header": {"seq": 1, "frame_id": "hall"}})
    assert (lamp.header.frame_id, lamp.level) == ("hall", 7)
    assert module.Lamp.__doc__.split("\n\n")[0] == "A lamp."
    schema = json.loads((tmp_path / "tree/schemas/json/made_up_msgs/Lamp.json").read_bytes())
    assert schema["properties"]["level"]["default"] == 7
    assert (
        "| 1 | [made_up_msgs/msg/Lamp]"
        in (tmp_path / "tree/docs/reference/messages.md").read_text()
    )
    classes = tmp_path / "tree" / CSHARP_FOLDER
    assert "public byte level = 7;" in (classes / "MadeUpMsgs.cs").read_text()
    assert '=> "made_up_msgs/msg/Lamp",' in (classes / "MessageTable.cs").read_text()


def test_one_row_more_generates_its_service_or_action(tmp_path, tree):
    main(tree)
    table = tmp_path / "messages.toml"
    table.write_text(TABLE + INTERFACES)

    assert main([*tree, "--check"]) == 1
    assert main(tree) == 0
    request = generated_module(tmp_path, "std_srvs").SetBool_Request
    goal = generated_module(tmp_path, "test_msgs").Fibonacci_Goal
    assert request.model_validate({"data": True}).data is True
    assert request.__doc__ == "The request of std_srvs/srv/SetBool."
    assert goal.model_validate({"order": 3}).order == 3
    schemas = tmp_path / "tree" / "schemas" / "json"
    service = json.loads((schemas / "std_srvs" / "srv" / "SetBool.json").read_bytes())
    action = json.loads((schemas / "test_msgs" / "action" / "Fibonacci.json").read_bytes())
    assert list(service["properties"]) == ["request", "response"]
    assert list(action["properties"]) == ["goal", "result", "feedback"]
    page = (tmp_path / "tree" / "docs/reference/services.md").read_text()
    assert "| [std_srvs/srv/SetBool](#std_srvs-srv-setbool) | Switches |" in page
    assert "| [test_msgs/action/Fibonacci](#test_msgs-action-fibonacci) | Counts rabbits |" in page


def test_a_service_that_no_row_names_any_more_is_removed(tmp_path, tree):
    table = tmp_path / "messages.toml"
    table.write_text(TABLE + INTERFACES)
    main(tree)
    before = files(tmp_path)
    table.write_text(TABLE)

    assert main(tree) == 0
    assert {*before} - {*files(tmp_path)} == {
        "schemas/json/std_srvs/srv/SetBool.json",
        "schemas/json/test_msgs/action/Fibonacci.json",
        "schemas/models/std_srvs.py",
        "schemas/models/test_msgs.py",
        f"{CSHARP_FOLDER}/StdSrvs.cs",
        f"{CSHARP_FOLDER}/TestMsgs.cs",
    }


def test_check_names_each_file_that_differs_and_writes_nothing(tmp_path, tree, capsys):
    main(tree)
    root = tmp_path / "tree"
    (root / "docs/reference/messages.md").write_text("edited")
    (root / "schemas/json/std_msgs/String.json").unlink()
    (root / "schemas/models/gone_msgs.py").write_text("stale")
    capsys.readouterr()

    assert main([*tree, "--check"]) == 1
    output = capsys.readouterr()
    assert output.out.splitlines() == [
        "differs: docs/reference/messages.md",
        "differs: schemas/json/std_msgs/String.json",
        "differs: schemas/models/gone_msgs.py",
    ]
    assert "3 files differ; run make docs" in output.err
    assert (root / "docs/reference/messages.md").read_text() == "edited"


def test_files_without_a_row_are_removed(tmp_path, tree):
    main(tree)
    stale = tmp_path / "tree" / "schemas" / "models" / "gone_msgs.py"
    stale.write_text("stale")

    assert main(tree) == 0
    assert not stale.exists()


def test_a_missing_package_is_named_with_the_ways_to_get_it(tmp_path, tree, capsys):
    (tmp_path / "messages.toml").write_text(TABLE.replace("# more", NEW_ROW))

    assert main(tree, InstalledDefinitions()) == 2
    error = capsys.readouterr().err
    assert error.startswith("no definition of made_up_msgs/msg/Lamp is installed: ")
    assert "apt install" in error
    assert "pip install" in error
    assert files(tmp_path) == []


@pytest.mark.parametrize("text", ["messages = 3", "not toml", "messages = [{}]"])
def test_a_bad_table_is_reported_in_one_line(tmp_path, tree, capsys, text):
    (tmp_path / "messages.toml").write_text(text)

    assert main(tree) == 2
    assert len(capsys.readouterr().err.splitlines()) == 1


def test_a_table_that_is_not_there_is_reported(tmp_path, tree, capsys):
    (tmp_path / "messages.toml").unlink()

    assert main(tree) == 2
    assert "messages.toml" in capsys.readouterr().err
