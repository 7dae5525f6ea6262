# SPDX-License-Identifier: Apache-2.0
"""``python -m benchmarks [WHAT ...]``: what the gateway and the Unity client cost.

A kind of message (``odometry`` ...) is received by the gateway and by a bare rclpy subscriber, the
floor, from the same publisher in alternating rounds; figures are medians, CPU time is user and
system time of the whole process. ``fan-out`` measures many clients of one topic, ``codec`` what
rendering costs, as JSON and as CBOR, ``unity`` what the Unity client does. Read ratios: the times
are those of one machine in one mood.
"""

import argparse
import json
import os
from pathlib import Path

from benchmarks import codec, fan_out, unity
from benchmarks.beside_floor import Comparison, compare, table
from benchmarks.picture import encoder_share
from benchmarks.samples import SAMPLES

WHAT = (*SAMPLES, "fan-out", "codec", "unity")


def main() -> None:
    """Run what the command line names."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("what", nargs="*", default=list(WHAT), choices=WHAT, metavar="WHAT")
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--seconds", type=float, default=8.0, help="of each measurement")
    parser.add_argument("--json", type=Path, metavar="FILE", help="write the figures there, too")
    arguments = parser.parse_args()
    os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"
    os.environ["ROS_DOMAIN_ID"] = str(1 + os.getpid() % 100)
    comparisons: list[Comparison] = []
    for name in arguments.what:
        if name in SAMPLES:
            print(f"measuring {name} ...", flush=True)
            comparisons.append(compare(name, arguments.rounds, arguments.seconds))
    if comparisons:
        print(f"\none client; of each two columns the first is the floor's\n{table(comparisons)}")
    for one in comparisons:
        if one.name == "image":
            print(encoder_share(one.gateway.cpu_us_per_message))
    if arguments.json is not None:
        figures = [one.as_json() for one in comparisons]
        arguments.json.write_text(json.dumps(figures, indent=1) + "\n")
    if "fan-out" in arguments.what:
        fan_out.main()
    if "codec" in arguments.what:
        codec.main()
    if "unity" in arguments.what:
        unity.main()


if __name__ == "__main__":
    main()
