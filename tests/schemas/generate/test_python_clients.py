# SPDX-License-Identifier: Apache-2.0
"""Pydantic models for clients: imported, type-checked, and fed with what the gateway sends."""

import importlib
import subprocess
import sys
from pathlib import Path

import pytest

from gateway.codec.json import dumps, loads
from gateway.codec.types import Types
from schemas.generate.python_clients import files, text
from schemas.generate.request import ClientCodeError
from schemas.installed import InstalledDefinitions
from tests.messages import RandomMessages, to_json
from tests.schemas.generate.client_code import (
    GENERATED,
    awkward_definitions,
    names_of_messages,
    request_of,
    request_of_everything,
    write_texts,
)
from tests.schemas.test_installed import write_definition

ROOT = Path(__file__).parents[3]
TIMEOUT_S = 500
NOW_NS = 1_700_000_000_123_456_789


@pytest.fixture(scope="module")
def definitions(tmp_path_factory):
    return awkward_definitions(tmp_path_factory.mktemp("definitions"))


@pytest.fixture(scope="module")
def written(definitions, tmp_path_factory):
    """Return a folder with a package and a module of all that is installed, and the awkward."""
    folder = tmp_path_factory.mktemp("models")
    request = request_of_everything(definitions)
    write_texts(folder / "robot_models", files(request))
    (folder / "all_models.py").write_text(text(request), encoding="utf-8")
    return folder


@pytest.fixture
def imported(written, monkeypatch):
    monkeypatch.syspath_prepend(str(written))
    return importlib.import_module


def models_in(module):
    return {
        model.ros_type: model
        for model in vars(module).values()
        if getattr(model, "ros_type", None) and model.__module__ == module.__name__
    }


def test_each_message_that_the_gateway_sends_fits_its_model(definitions, imported):
    models = models_in(imported("all_models"))
    types = Types(definitions)
    assert sorted(models) == sorted(names_of_messages(definitions))
    for name, model in models.items():
        for seed in range(3):
            values = to_json(RandomMessages(definitions, seed, longest=2).message(name))
            cdr = types.get(name).encode(values, now_ns=NOW_NS)
            sent = loads(dumps(types.get(name).decode(cdr)))
            held = model.model_validate(sent, context={"now_ns": NOW_NS})
            assert types.get(name).encode(held.model_dump(by_alias=True), NOW_NS) == cdr


def test_the_package_has_a_module_for_each_package(definitions, imported, written):
    by_name = {}
    for path in (written / "robot_models").glob("*.py"):
        by_name |= models_in(imported(f"robot_models.{path.stem}".removesuffix(".__init__")))
    assert sorted(by_name) == sorted(names_of_messages(definitions))
    pose = by_name["geometry_msgs/msg/PoseStamped"]
    assert isinstance(pose().header, by_name["std_msgs/msg/Header"])


def test_a_misfit_is_refused(imported):
    model = models_in(imported("all_models"))["geometry_msgs/msg/Twist"]
    with pytest.raises(ValueError, match="linear"):
        model.model_validate({"linear": {"x": "fast"}})


def test_names_of_python_make_room(imported):
    models = imported("all_models")
    assert models.None_.ros_type == "awkward_msgs/msg/None"
    assert models.Awkward.model_fields["from_"].alias == "from"
    assert imported("robot_models.import_").Thing().thing.header.frame_id == ""


def test_types_that_share_a_name_have_their_package_before_it(imported):
    models = imported("all_models")
    assert models.StdMsgsString.ros_type == "std_msgs/msg/String"
    assert models.AwkwardMsgsString.ros_type == "awkward_msgs/msg/String"
    assert not hasattr(models, "String")


@pytest.mark.long
def test_mypy_finds_nothing_in_any_type(written):
    for what in (("-p", "robot_models"), ("all_models.py",)):
        checked = subprocess.run(
            [
                *(sys.executable, "-m", "mypy", "--strict", "--no-incremental"),
                *("--config-file", str(ROOT / "pyproject.toml"), *what),
            ],
            cwd=written,
            env={"MYPYPATH": str(ROOT), "PATH": ""},
            capture_output=True,
            text=True,
            timeout=TIMEOUT_S,
            check=False,
        )
        assert checked.returncode == 0, checked.stdout + checked.stderr


def test_packages_that_nest_each_other_are_one_text_only(tmp_path, monkeypatch):
    write_definition(tmp_path, "one_msgs/msg/A", "two_msgs/B b\n")
    write_definition(tmp_path, "one_msgs/msg/C", "")
    write_definition(tmp_path, "two_msgs/msg/B", "one_msgs/C c\n")
    request = request_of("one_msgs/msg/A", definitions=InstalledDefinitions([tmp_path]))
    with pytest.raises(ClientCodeError, match="packages one_msgs, two_msgs nest types of each"):
        files(request)
    (tmp_path / "round_models.py").write_text(text(request))
    monkeypatch.syspath_prepend(str(tmp_path))
    assert importlib.import_module("round_models").A().b.c is not None


def test_each_file_says_how_it_was_made():
    request = request_of("std_msgs/msg/String")
    for source in [*files(request).values(), text(request)]:
        assert source.startswith(f"# {GENERATED}\n")
        assert GENERATED not in source[len(GENERATED) + 3 :]
