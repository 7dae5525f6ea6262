# SPDX-License-Identifier: Apache-2.0

import os
from pathlib import Path

import pytest

from gateway.ros import fast_dds

NAMES = ("FASTRTPS_DEFAULT_PROFILES_FILE", "FASTDDS_DEFAULT_PROFILES_FILE")
OURS = Path("/ours.xml")


@pytest.fixture(autouse=True)
def environment(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in NAMES:
        monkeypatch.setenv(name, "")  # so that what follows is undone
        monkeypatch.delenv(name)


def test_both_generations_of_fast_dds_find_the_profile():
    with fast_dds.profile(OURS):
        assert [os.environ[name] for name in NAMES] == ["/ours.xml"] * 2


@pytest.mark.parametrize("name", NAMES)
def test_a_profile_that_the_environment_names_stays(name, monkeypatch):
    monkeypatch.setenv(name, "/theirs.xml")
    with fast_dds.profile(OURS):
        assert [os.environ.get(each) for each in NAMES if each != name] == [None]
        assert os.environ[name] == "/theirs.xml"
    assert os.environ[name] == "/theirs.xml"


def test_the_environment_is_as_before_afterwards():
    before = dict(os.environ)
    with pytest.raises(KeyError), fast_dds.profile(OURS):
        raise KeyError
    assert dict(os.environ) == before
