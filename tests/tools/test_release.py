# SPDX-License-Identifier: Apache-2.0
"""The checks that `make release` does before it builds."""

import json
import shutil
from pathlib import Path

import pytest

from tools import release

FILES = (
    *("pyproject.toml", "package.xml", "CHANGELOG.md", "unity_client/client/CHANGELOG.md"),
    *(f"unity_client/{one}/package.json" for one in ("client", "displays", "robots")),
)


@pytest.fixture
def tree(tmp_path: Path) -> Path:
    """Return a copy of the files that name a version."""
    for name in FILES:
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(release.ROOT / name, tmp_path / name)
    return tmp_path


def test_every_file_of_this_tree_names_the_same_version():
    assert set(release.versions()) == set(FILES)
    assert release.the_version(release.versions()) != "none"


def test_places_that_differ_are_listed_with_their_versions(tree: Path):
    path = tree / "unity_client/displays/package.json"
    path.write_text(json.dumps(json.loads(path.read_text()) | {"version": "9.9.9"}))
    with pytest.raises(release.ReleaseError) as caught:
        release.the_version(release.versions(tree))
    assert "9.9.9  unity_client/displays/package.json" in str(caught.value)
    assert "  pyproject.toml" in str(caught.value)


def test_the_newest_release_of_a_changelog_counts(tree: Path):
    path = tree / "CHANGELOG.md"
    path.write_text(path.read_text().replace("\n## ", "\n## 9.9.9\n\n- Add it.\n\n## ", 1))
    assert release.versions(tree)["CHANGELOG.md"] == "9.9.9"


@pytest.mark.parametrize("folder", ["changes", "changes/unity"])
def test_a_change_that_waits_for_the_changelog_is_named_with_the_command(tmp_path, folder):
    (tmp_path / folder).mkdir(parents=True)
    (tmp_path / folder / "README.md").touch()
    release.check_fragments("9.9.9", tmp_path)
    (tmp_path / folder / "+port.added.md").touch()
    with pytest.raises(release.ReleaseError, match=r"\+port\.added\.md: run .+ 9\.9\.9"):
        release.check_fragments("9.9.9", tmp_path)
