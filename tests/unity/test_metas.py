# SPDX-License-Identifier: Apache-2.0
"""Every asset has its meta, and every GUID one asset."""

import pytest

from tools import unity_metas

ASSETS = ("package.json", "Runtime/Core/A.cs", "Runtime/Unity/Socket.jslib", "Samples~/One/B.cs")
IGNORED = ("Documentation~/index.md", ".hidden", "Runtime/.git/x", "Runtime/Old~/C.cs")


@pytest.fixture
def package(tmp_path):
    for name in (*ASSETS, *IGNORED):
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.touch()
    return tmp_path


def metas(package):
    return {path.relative_to(package).as_posix() for path in package.rglob("*.meta")}


def test_the_package_is_complete():
    assert list(unity_metas.wrong(*unity_metas.PACKAGES)) == [], "run python -m tools.unity_metas"


def test_every_asset_and_folder_gets_one_and_what_unity_ignores_none(package):
    list(unity_metas.update(package))
    folders = {"Runtime", "Runtime/Core", "Runtime/Unity", "Samples~/One"}
    assert metas(package) == {f"{name}.meta" for name in (*ASSETS, *folders)}
    assert list(unity_metas.wrong(package)) == []


def test_the_importer_fits_the_kind(package):
    list(unity_metas.update(package))
    assert "PackageManifestImporter:" in (package / "package.json.meta").read_text()
    assert "MonoImporter:" in (package / "Runtime/Core/A.cs.meta").read_text()
    assert "folderAsset: yes" in (package / "Runtime.meta").read_text()
    plugin = (package / "Runtime/Unity/Socket.jslib.meta").read_text()
    assert "WebGL: WebGL\n    second:\n      enabled: 1" in plugin
    assert plugin.count("enabled: 1") == 1


def test_a_guid_once_written_stays(package):
    meta = package / "package.json.meta"
    meta.write_text(f"fileFormatVersion: 2\nguid: {'a' * 32}\n")
    list(unity_metas.update(package))
    assert "a" * 32 in meta.read_text()
    assert list(unity_metas.update(package)) == []


def test_a_meta_without_its_asset_is_removed(package):
    list(unity_metas.update(package))
    (package / "Runtime/Core/A.cs").unlink()
    meta = f"{package.name}/Runtime/Core/A.cs.meta"
    assert list(unity_metas.wrong(package)) == [f"without an asset: {meta}"]
    assert list(unity_metas.update(package)) == [f"removed {meta}"]


def test_a_guid_that_is_there_twice_is_told(package):
    list(unity_metas.update(package))
    one, other = package / "package.json.meta", package / "Samples~/One/B.cs.meta"
    other.write_text(one.read_text())
    assert list(unity_metas.wrong(package)) == [
        f"same GUID as {package.name}/Samples~/One/B.cs.meta: {package.name}/package.json.meta"
    ]
