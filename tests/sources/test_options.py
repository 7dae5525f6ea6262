# SPDX-License-Identifier: Apache-2.0
import pytest

from gateway.sources.options import RosOptions, check_room
from gateway.sources.source import RosError


def test_there_are_1280_entities_of_which_16_are_kept():
    check_room(1263, RosOptions(), is_reserved=False)
    with pytest.raises(RosError, match="at most 1280 ROS entities, of which 16 are kept"):
        check_room(1264, RosOptions(), is_reserved=False)
    check_room(1279, RosOptions(), is_reserved=True)
    with pytest.raises(RosError, match=r"^at most 1280 ROS entities: end some, or raise limits"):
        check_room(1280, RosOptions(), is_reserved=True)


def test_of_few_entities_at_most_a_quarter_is_reserved():
    check_room(5, RosOptions(max_entities=8), is_reserved=False)
    with pytest.raises(RosError, match="of which 2 are kept"):
        check_room(6, RosOptions(max_entities=8), is_reserved=False)
