# SPDX-License-Identifier: Apache-2.0
"""The simulated battery: a lithium polymer pack of three cells that the robot drains."""

from typing import Final

CAPACITY: Final = 1.8  # Ah, a TurtleBot3's
CELLS: Final = 3
_IDLE_CURRENT: Final = 0.9  # A: the computer, the lidar, the camera
_DRIVE_CURRENT: Final = 1.4  # A on top at full speed
_CHARGE_CURRENT: Final = 18.0  # A: full in minutes, so that people see it happen
_LOW: Final = 0.1  # below it a real pack is damaged: it is swapped


class Battery:
    """A charge that falls with time and driving, and rises in the bay. Time is an argument."""

    def __init__(self) -> None:
        self.charge = CAPACITY  # Ah left
        self.current = -_IDLE_CURRENT  # A, negative while discharging (sensor_msgs/BatteryState)
        self.charging = False
        self.swaps = 0

    @property
    def percentage(self) -> float:
        """The charge from 0 to 1."""
        return self.charge / CAPACITY

    @property
    def cell_voltage(self) -> float:
        """Volts of one cell: 3.3 when empty to 4.2 when full."""
        return 3.3 + 0.9 * self.percentage

    def step(self, seconds: float, effort: float, charging: bool) -> None:
        """Let time pass. *effort* is the share of full speed, from 0 to 1.

        A pack at 10 % is swapped for a full one, so that the robot runs for days.
        """
        self.charging = charging and self.charge < CAPACITY
        drain = _IDLE_CURRENT + _DRIVE_CURRENT * effort
        self.current = (_CHARGE_CURRENT if self.charging else 0.0) - drain
        self.charge = min(CAPACITY, self.charge + self.current * seconds / 3600)
        if self.percentage < _LOW:
            self.charge = CAPACITY
            self.swaps += 1
