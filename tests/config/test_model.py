# SPDX-License-Identifier: Apache-2.0
"""The model of the configuration and its reference page."""

from pathlib import Path
from typing import get_args

import pytest
from pydantic import ValidationError

from gateway.config.model import TAKEN_PATHS, Config, ImagesConfig
from gateway.config.reference import reference
from gateway.config.settings import settings
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


def test_the_taken_paths_are_those_that_the_server_answers_itself():
    assert set(TAKEN_PATHS) == {*health.PATHS, *picture_requests.PATHS, "/metrics", "/version"}


def test_each_format_of_images_can_be_the_default():
    assert get_args(ImagesConfig.model_fields["default_format"].annotation) == IMAGE_FORMATS
