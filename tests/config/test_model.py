# SPDX-License-Identifier: Apache-2.0
"""The model of the configuration and its reference page."""

import re
from pathlib import Path
from typing import get_args

import pytest
from pydantic import ValidationError

from gateway.config.model import TAKEN_PATHS, Config, ImagesConfig
from gateway.config.reference import example, reference
from gateway.config.settings import load, settings
from gateway.fronts.pictures import requests as picture_requests
from gateway.fronts.rosbridge.operations.topics import IMAGE_FORMATS
from gateway.transport import health

ROOT = Path(__file__).parents[2]


def test_the_default_configuration_serves_this_machine_alone():
    config = Config()
    assert (config.host, config.port, config.path) == ("127.0.0.1", 9090, "/")


def test_a_configuration_cannot_be_changed():
    config = Config()
    with pytest.raises(ValidationError, match="frozen"):
        config.port = 1  # type: ignore[misc]  # what is tested
    with pytest.raises(ValidationError, match="frozen"):
        config.limits.max_clients = 1  # type: ignore[misc]  # what is tested


def test_every_setting_has_a_description_and_an_expectation():
    for setting in settings():
        assert setting.description, setting.key
        assert setting.expectation, setting.key


def test_a_description_is_short():
    for setting in settings():
        assert len(setting.description.split()) <= 25, setting.key


def test_every_time_and_size_has_its_unit_in_its_name():
    for setting in settings():
        for start, suffix in {"Time ": "_s", "Maximum size": "_bytes"}.items():
            if setting.description.startswith(start):
                assert setting.key.endswith(suffix)


def test_the_reference_page_has_the_settings_of_the_model():
    page = (ROOT / "docs/reference/configuration.md").read_text(encoding="utf-8")
    assert reference() in page, "run: make docs"


def test_the_example_has_each_setting_and_without_its_marks_all_defaults(tmp_path: Path):
    path = tmp_path / "config.toml"
    path.write_text(example())
    assert load(file=path).config == Config()
    assert set(load(file=path).origins.values()) == {"default"}
    path.write_text(re.sub("^#(?=[a-z])", "", example(), flags=re.MULTILINE))
    loaded = load(file=path)
    assert loaded.config == Config()
    unset = {key for key, origin in loaded.origins.items() if origin == "default"}
    assert unset == {each.key for each in settings() if each.field.default is None}
    for setting in settings():
        assert setting.description in " ".join(example().replace("\n#", "").split())


def test_the_example_says_the_unit_of_each_setting_that_has_one():
    for setting in settings():
        end = setting.key.rpartition("_")[2]
        assert bool(setting.unit) == (end in {"s", "bytes"}), setting.key
    assert "# A number from" not in example()
    assert "Values: a number from 0.1 to 2, in seconds." in " ".join(
        example().replace("\n#", "").split()
    )


def test_the_taken_paths_are_those_that_the_server_answers_itself():
    assert set(TAKEN_PATHS) == {*health.PATHS, *picture_requests.PATHS, "/metrics", "/version"}


def test_each_format_of_images_can_be_the_default():
    assert get_args(ImagesConfig.model_fields["default_format"].annotation) == IMAGE_FORMATS
