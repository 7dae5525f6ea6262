# SPDX-License-Identifier: Apache-2.0
"""The battery drains, charges and is swapped."""

import pytest

from gateway_sim.battery import CAPACITY, Battery


def test_it_drains_with_time_and_faster_when_driving():
    idle, driving = Battery(), Battery()
    for _ in range(600):
        idle.step(1, 0.0, charging=False)
        driving.step(1, 1.0, charging=False)
    assert 1 > idle.percentage > driving.percentage > 0.5
    assert driving.current < idle.current < 0
    assert driving.cell_voltage < idle.cell_voltage < 4.2


def test_it_charges_in_the_bay_until_it_is_full():
    battery = Battery()
    battery.step(1800, 1.0, charging=False)
    battery.step(60, 0.0, charging=True)
    assert battery.charging
    assert battery.current > 0
    battery.step(3600, 0.0, charging=True)
    assert battery.charge == CAPACITY
    battery.step(1, 0.0, charging=True)
    assert not battery.charging


def test_an_empty_one_is_swapped():
    battery = Battery()
    lowest = 1.0
    while not battery.swaps:
        lowest = battery.percentage
        battery.step(60, 0.0, charging=False)
    assert lowest == pytest.approx(0.1, abs=0.02)
    assert battery.percentage == 1
