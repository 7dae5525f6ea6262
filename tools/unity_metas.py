# SPDX-License-Identifier: Apache-2.0
"""Keep a ``.meta`` next to every asset of the Unity packages: ``python -m tools.unity_metas``.

Without it Unity ignores a file of a package installed by git, for packages are read-only. A new
asset's GUID is the md5 of its path. Once written it never changes, since scenes refer to it. So if
you move an asset, move its ``.meta`` with it.
"""

import argparse
import hashlib
import re
import sys
from collections.abc import Iterator
from itertools import chain
from pathlib import Path
from typing import Final

HOME: Final = Path(__file__).resolve().parents[1] / "unity_client"
PACKAGES: Final = tuple(HOME / name for name in ("client", "displays", "robots"))

_NAMESPACE: Final = "com.ros2-json-gateway/"
# Unity imports nothing below a folder that ends so, but it copies samples into a project, which
# then has their GUIDs: the one such folder with metas (in it, none next to it).
_SAMPLES: Final = "Samples~"
_GUID: Final = re.compile(r"^guid: ([0-9a-f]{32})$", re.MULTILINE)

_PLAIN: Final = """\
  externalObjects: {}
  userData:
  assetBundleName:
  assetBundleVariant:
"""
_SCRIPT: Final = """\
  externalObjects: {}
  serializedVersion: 2
  defaultReferences: []
  executionOrder: 0
  icon: {instanceID: 0}
  userData:
  assetBundleName:
  assetBundleVariant:
"""
_WEBGL_PLUGIN: Final = """\
  externalObjects: {}
  serializedVersion: 2
  iconMap: {}
  executionOrder: {}
  defineConstraints: []
  isPreloaded: 0
  isOverridable: 0
  isExplicitlyReferenced: 0
  validateReferences: 1
  platformData:
  - first:
      Any:
    second:
      enabled: 0
      settings: {}
  - first:
      Editor: Editor
    second:
      enabled: 0
      settings:
        DefaultValueInitialized: true
  - first:
      WebGL: WebGL
    second:
      enabled: 1
      settings: {}
  userData:
  assetBundleName:
  assetBundleVariant:
"""
_NATIVE: Final = """\
  externalObjects: {}
  mainObjectFileID: %d
  userData:
  assetBundleName:
  assetBundleVariant:
"""
_SHADER: Final = """\
  externalObjects: {}
  defaultTextures: []
  nonModifiableTextures: []
  preprocessorOverride: 0
  userData:
  assetBundleName:
  assetBundleVariant:
"""
_IMPORTERS: Final = {
    ".cs": ("MonoImporter", _SCRIPT),
    ".asmdef": ("AssemblyDefinitionImporter", _PLAIN),
    ".md": ("TextScriptImporter", _PLAIN),
    ".txt": ("TextScriptImporter", _PLAIN),
    ".json": ("TextScriptImporter", _PLAIN),
    ".xml": ("TextScriptImporter", _PLAIN),
    ".mat": ("NativeFormatImporter", _NATIVE % 2100000),
    ".asset": ("NativeFormatImporter", _NATIVE % 11400000),
    ".prefab": ("PrefabImporter", _PLAIN),
    ".shader": ("ShaderImporter", _SHADER),
    ".jslib": ("PluginImporter", _WEBGL_PLUGIN),
}


def main(arguments: list[str] | None = None) -> int:
    """Write missing metas and remove orphans, or with ``--check`` report errors."""
    parser = argparse.ArgumentParser(description="Keep a .meta next to every asset.")
    parser.add_argument("--check", action="store_true", help="change nothing, exit 1 if needed")
    check = parser.parse_args(arguments).check
    problems = list(wrong(*PACKAGES) if check else chain.from_iterable(map(update, PACKAGES)))
    for problem in problems:
        print(problem)  # noqa: T201  # a command's output
    return 1 if check and problems else 0


def update(package: Path) -> Iterator[str]:
    """Write missing metas and remove orphans. Yield each change."""
    expected = {meta_of(asset): asset for asset in assets(package)}
    for meta, asset in expected.items():
        if not meta.exists():
            meta.write_text(content(package, asset))
            yield f"wrote {meta.relative_to(package.parent)}"
    for meta in sorted(set(package.rglob("*.meta")) - set(expected)):
        meta.unlink()
        yield f"removed {meta.relative_to(package.parent)}"


def wrong(*packages: Path) -> Iterator[str]:
    """Yield what `update` would do, and errors beyond it: a GUID that is duplicate or missing."""
    owners: dict[str, Path] = {}
    for package in packages:
        yield from _wrong(package, owners)


def _wrong(package: Path, owners: dict[str, Path]) -> Iterator[str]:
    expected = {meta_of(asset): asset for asset in assets(package)}
    present = set(package.rglob("*.meta"))
    for meta in sorted(set(expected) - present):
        yield f"missing: {meta.relative_to(package.parent)}"
    for meta in sorted(present - set(expected)):
        yield f"without an asset: {meta.relative_to(package.parent)}"
    for meta in sorted(present & set(expected)):
        name = meta.relative_to(package.parent)
        found = _GUID.search(meta.read_text())
        if found is None:
            yield f"without a GUID: {name}"
        elif (other := owners.setdefault(found[1], name)) != name:
            yield f"same GUID as {other}: {name}"


def assets(package: Path) -> Iterator[Path]:
    """Yield every file and folder that Unity imports, and those of the samples."""
    yield from _below(package)
    if (samples := package / _SAMPLES).is_dir():
        yield from _below(samples)


def meta_of(asset: Path) -> Path:
    """Return the path of an asset's meta."""
    return asset.with_name(f"{asset.name}.meta")


def content(package: Path, asset: Path) -> str:
    """Return the text of a new meta."""
    path = asset.relative_to(package.parent).as_posix()
    # Unity wants a GUID, and only that it is unique: no security in it
    guid = hashlib.md5(f"{_NAMESPACE}{path}".encode(), usedforsecurity=False).hexdigest()
    kind = "folderAsset: yes\n" if asset.is_dir() else ""
    importer, settings = ("DefaultImporter", _PLAIN) if asset.is_dir() else _importer(path)
    return f"fileFormatVersion: 2\nguid: {guid}\n{kind}{importer}:\n{settings}"


def _importer(path: str) -> tuple[str, str]:
    if Path(path).name == "package.json":
        return "PackageManifestImporter", _PLAIN
    return _IMPORTERS.get(Path(path).suffix, ("DefaultImporter", _PLAIN))


def _below(folder: Path) -> Iterator[Path]:
    for entry in sorted(folder.iterdir()):
        # Unity ignores these, besides the metas themselves
        hidden = entry.name.startswith(".") or entry.name.endswith("~")
        if hidden or entry.name.lower() == "cvs" or entry.suffix in {".meta", ".tmp"}:
            continue
        yield entry
        if entry.is_dir():
            yield from _below(entry)


if __name__ == "__main__":
    sys.exit(main())
