# SPDX-License-Identifier: Apache-2.0
"""Build a release and try it: `make release`. Nothing is uploaded.

It installs both files as a user does, each in a separate environment with an empty home, and starts
a gateway from each.
"""

import json
import os
import re
import subprocess
import sys
import tempfile
import threading
import tomllib
from collections.abc import Mapping, Sequence
from pathlib import Path
from xml.etree import ElementTree as ET

ROOT = Path(__file__).parents[1]
DIST = ROOT / "dist"
DOMAIN = "199"  # nobody else's, so that no robot of this network is seen
START_S = 120
TOWNCRIER = {
    "changes": "towncrier build --version",
    "changes/unity": "towncrier build --dir . --config changes/unity/towncrier.toml --version",
}
# Runs in the new environment: asks the gateway at an address whether it works, and for its version.
ASK = """
import json, sys, urllib.request
from websockets.sync.client import connect
address = sys.argv[1]
urllib.request.urlopen(address.replace("ws:", "http:") + "healthz")
with connect(address) as gateway:
    gateway.send('{"op":"hello"}')
    print(json.loads(gateway.recv())["version"])
"""


class ReleaseError(Exception):
    """The release is not ready: the text says why, and what to do."""


def versions(root: Path = ROOT) -> dict[str, str]:
    """Return the version that each file of the tree names, by the file's path."""
    changelogs = ("CHANGELOG.md", "unity_client/client/CHANGELOG.md")
    found = {path: _newest_release((root / path).read_text("utf-8")) for path in changelogs}
    packages = [f"unity_client/{one}/package.json" for one in ("client", "displays", "robots")]
    manifests = {path: json.loads((root / path).read_text("utf-8")) for path in packages}
    project = tomllib.loads((root / "pyproject.toml").read_text("utf-8"))["project"]
    ros_package = ET.parse(root / "package.xml")  # noqa: S314  # our own
    return {
        "pyproject.toml": project["version"],
        "package.xml": ros_package.findtext("version", "none"),
        **{path: manifest["version"] for path, manifest in manifests.items()},
        **found,
    }


def _newest_release(changelog: str) -> str:
    heading = re.search(r"^## (\S+)", changelog, re.MULTILINE)
    return heading[1] if heading else "none"


def the_version(found: Mapping[str, str]) -> str:
    """Return the version on which all places agree.

    Raises:
        ReleaseError: they do not agree.
    """
    if len(set(found.values())) > 1:
        places = "\n".join(f"  {version}  {place}" for place, version in found.items())
        raise ReleaseError(f"versions differ: give all of these the same one\n{places}")
    return next(iter(found.values()))


def check_fragments(version: str, root: Path = ROOT) -> None:
    """Check that no change waits for the changelogs.

    Raises:
        ReleaseError: one does.
    """
    for folder, command in TOWNCRIER.items():
        if waiting := sorted(path.name for path in (root / folder).glob("+*.md")):
            raise ReleaseError(
                f"{folder}/ has changes that the changelog lacks, {', '.join(waiting)}:"
                f" run .venv/bin/{command} {version}"
            )


def _run(command: Sequence[str | Path], cwd: Path, home: Path | None = None) -> str:
    environment = dict(os.environ) if home is None else _bare(home)
    finished = subprocess.run(
        command, cwd=cwd, env=environment, capture_output=True, text=True, check=False
    )
    if finished.returncode != 0:
        raise ReleaseError(f"{' '.join(map(str, command))} failed:\n{finished.stderr}")
    return finished.stdout


def _bare(home: Path) -> dict[str, str]:
    """Return the environment of a user whose only settings are those of pip."""
    kept = {name: value for name, value in os.environ.items() if name.startswith("PIP_")}
    return {
        **kept,
        "PATH": os.environ["PATH"],
        "HOME": str(home),
        "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
        "ROS_DOMAIN_ID": DOMAIN,
    }


def build() -> list[Path]:
    """Write the source archive and the wheel into `dist/`."""
    for old in DIST.glob("ros2_json_gateway-*"):
        old.unlink()
    _run([sys.executable, "-m", "hatchling", "build", "-d", DIST], ROOT)
    return sorted(DIST.glob("ros2_json_gateway-*"))


def try_it(archive: Path, version: str, home: Path) -> None:
    """Install an archive into a new environment, start a gateway from it, and ask for its version.

    Raises:
        ReleaseError: one of these fails.
    """
    venv = home / "gateway"
    _run(["sh", ROOT / "tools/make-venv.sh", venv], home, home)
    _run([venv / "bin/python", "-m", "pip", "install", "-q", f"{archive}[ros]"], home, home)
    found = {"pyproject.toml": version}
    printed = _run([venv / "bin/ros2-gateway", "--version"], home, home).split()[-1]
    found[f"ros2-gateway --version of {archive.name}"] = printed
    found[f"hello of {archive.name}"] = _version_of_gateway(venv, home)
    the_version(found)


def _version_of_gateway(venv: Path, home: Path) -> str:
    """Start a gateway, check its health, and return the version that it sends to a client."""
    serve = [venv / "bin/ros2-gateway", "serve", "--port", "0"]
    log = home / "gateway.log"
    with (
        log.open("w") as errors,
        subprocess.Popen(
            serve, cwd=home, env=_bare(home), stdout=subprocess.PIPE, stderr=errors, text=True
        ) as gateway,
    ):
        timer = threading.Timer(START_S, gateway.kill)
        timer.start()
        try:
            addresses = (re.search(r"ws://\S+", line) for line in gateway.stdout or ())
            address = next((each[0] for each in addresses if each), None)
            if address is None:
                raise ReleaseError(f"the gateway did not start:\n{log.read_text()}")
            return _run([venv / "bin/python", "-c", ASK, address], home, home).strip()
        finally:
            timer.cancel()
            gateway.terminate()


REMAINING = """
{version} is ready in dist/. Nothing was uploaded. What remains, in this directory:
  1. Test what is released: make test ALL=1, then make kilted
  2. Tag it: git tag v{version}, then git push origin v{version}
  3. Upload it, if you publish to an index: twine upload dist/ros2_json_gateway-{version}*
  4. Unity projects take the packages in unity_client/ from the tag: no upload is needed
"""


def main() -> int:
    """Build and try a release, and return the exit code."""
    try:
        version = the_version(versions())
        check_fragments(version)
        for archive in build():
            print(f"trying {archive.name} ...", flush=True)
            with tempfile.TemporaryDirectory() as home:
                try_it(archive, version, Path(home))
    except ReleaseError as error:
        print(error, file=sys.stderr)
        return 1
    print(REMAINING.format(version=version).lstrip())
    return 0


if __name__ == "__main__":
    sys.exit(main())
