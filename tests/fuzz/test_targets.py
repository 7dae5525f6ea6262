# SPDX-License-Identifier: Apache-2.0
"""The targets of `make fuzz`, briefly and without atheris: their seeds, and changes of them."""

import pytest

from tests.fuzz.faults import fault_of, shortest
from tests.fuzz.mutations import mutations
from tests.fuzz.target import check
from tests.fuzz.targets import NAMES, load

# as many as take a second or so
CHANGES = {
    "operations": 120,
    "connection": 300,
    "cdr_decoder": 200,
    "fragments": 600,
    "zenoh_peers": 600,
    "driving": 300,
}
OTHER_CHANGES = 2000


@pytest.mark.parametrize("name", NAMES)
def test_the_product_keeps_its_promise_for_seeds_and_for_changes_of_them(name: str):
    target = load(name)
    seeds = list(target.seeds())
    for data in (*seeds, *mutations(seeds, CHANGES.get(name, OTHER_CHANGES), number=1)):
        try:
            target.run(data)
        except Exception as error:
            call = f"load({name!r}).run({shortest(target.run, data)!r})"
            raise AssertionError(call) from error


def test_a_fault_is_found_and_shortened():
    def run(data: bytes) -> None:
        check(b"x" not in data or b"y" not in data)

    assert fault_of(run, b"plain") is None
    assert shortest(run, b"a long text with x in it, and later y as well") == b"xy"


def test_changes_are_the_same_each_time():
    assert list(mutations([b"seed"], 9, 1)) == list(mutations([b"seed"], 9, 1))
    assert list(mutations([b"seed"], 9, 1)) != list(mutations([b"seed"], 9, 2))
