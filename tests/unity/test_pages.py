# SPDX-License-Identifier: Apache-2.0
"""The packages' pages name only menus and packages that their readers have."""

import json
import re

import pytest

from tests.unity.package import CLIENT, PACKAGES, installed_with
from tests.unity.pages import PAGES, installed_for

CHOICE = (CLIENT / "Documentation~/packages.md").read_text("utf-8")


@pytest.mark.parametrize("page", PAGES, ids=lambda page: f"{page.parent.name}-{page.stem}")
def test_each_menu_on_a_page_is_of_a_package_that_its_reader_has(page):
    sources = [path for one in installed_for(page) for path in (one / "Editor").glob("*.cs")]
    there = {
        name
        for source in sources
        for name in re.findall(r'MenuItem\(Path \+ "([^"]+)"', source.read_text("utf-8"))
    }
    text = " ".join(page.read_text("utf-8").split())
    assert set(re.findall(r"\*GameObject > ROS 2 Gateway > ([^*]+)\*", text)) <= there


def test_each_choice_is_a_package_with_what_it_needs():
    cells = re.findall(r"^\|.*\| (`client`.*) \|$", CHOICE, re.MULTILINE)
    rows = [re.findall(r"`(\w+)`", cell) for cell in cells]
    needed = [sorted(one.name for one in installed_with(package)) for package in PACKAGES]
    assert all(row in needed for row in rows)
    assert all(row in rows for row in needed)


def test_the_lines_to_copy_install_every_package():
    (block,) = re.findall(r"^```json\n(.*?)^```$", CHOICE, re.DOTALL | re.MULTILINE)
    names = {json.loads((one / "package.json").read_text("utf-8"))["name"]: one for one in PACKAGES}
    assert json.loads(block)["dependencies"] == {
        name: f"ADDRESS?path=unity_client/{one.name}" for name, one in names.items()
    }
