# SPDX-License-Identifier: Apache-2.0
"""The libraries of the pages are those that tools/vendor-pages.sh wrote."""

import gzip
import hashlib

from gateway.transport.static_files import PAGES

VENDOR = PAGES / "vendor"
HASHES = dict(reversed(line.split()) for line in (VENDOR / "SHA256SUMS").read_text().splitlines())


def test_each_has_its_hash_and_its_licence():
    served = {path.name for path in VENDOR.iterdir() if path.suffix in {".js", ".css"}}
    assert set(HASHES) == served
    for name, digest in HASHES.items():
        assert hashlib.sha256((VENDOR / name).read_bytes()).hexdigest() == digest
        assert (VENDOR / name).with_suffix(".LICENSE").exists()


def test_they_add_less_than_a_quarter_of_a_megabyte_to_a_wheel():
    assert sum(len(gzip.compress((VENDOR / name).read_bytes())) for name in HASHES) < 250_000
