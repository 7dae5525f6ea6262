# SPDX-License-Identifier: Apache-2.0
"""The ROS package, for `colcon build`. pip never runs it: pyproject.toml names another backend."""

from pathlib import Path
from xml.etree import ElementTree as ET

from setuptools import Distribution, setup

MANIFEST = Path(__file__).with_name("package.xml")
PACKAGES = ("gateway", "gateway_sim", "schemas")


class RosPackage(Distribution):
    """A distribution that setup.cfg describes, and pyproject.toml does not."""

    def parse_config_files(self, filenames: "list[str] | None" = None, **options: bool) -> None:
        """Read setup.cfg. Setuptools of Ubuntu 24.04 refuses the licence of pyproject.toml."""
        super().parse_config_files(filenames or self.find_config_files(), **options)


def files_of(package: str) -> list[str]:
    """Return the paths of all files of a package, those of its subpackages included."""
    root = Path(__file__).parent / package
    files = (path.relative_to(root) for path in root.rglob("*") if path.is_file())
    return [str(path) for path in files if "__pycache__" not in path.parts]


setup(
    distclass=RosPackage,
    version=ET.parse(MANIFEST).findtext("version"),  # noqa: S314  # our own
    package_data={package: files_of(package) for package in PACKAGES},
    zip_safe=False,
)
