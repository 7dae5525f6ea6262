# SPDX-License-Identifier: Apache-2.0
"""The profile that Fast DDS, the middleware of ROS' wheels, reads in a process of ours."""

import contextlib
import ctypes
import functools
import os
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Final

# rmw reads the first as well where it uses Fast DDS 3.
_VARIABLES: Final = ("FASTRTPS_DEFAULT_PROFILES_FILE", "FASTDDS_DEFAULT_PROFILES_FILE")

_RCUTILS: Final = "librcutils.so"
_RMW: Final = "librmw_fastrtps_shared_cpp.so"
# exported by rmw if it uses Fast DDS 2, as up to Jazzy
_OF_2: Final = (
    "_ZN23rmw_fastrtps_shared_cpp20register_type_objectEPK29rosidl_message_type_support_t"
    "RKNSt7__cxx1112basic_stringIcSt11char_traitsIcESaIcEEE"
)

_GATEWAYS: Final = Path(__file__).with_name("fastdds2_profile.xml")
# A generation refuses a whole file for one word of the other's.
_GATEWAYS_OF_3: Final = Path(__file__).with_name("fastdds3_profile.xml")
# of `eprosima::fastdds::dds::Log`, in both generations
_CLEAR_CONSUMERS: Final = "_ZN8eprosima7fastdds3dds3Log14ClearConsumersEv"
_FLUSH: Final = "_ZN8eprosima7fastdds3dds3Log5FlushEv"
_RESET: Final = "_ZN8eprosima7fastdds3dds3Log5ResetEv"


@contextlib.contextmanager
def profile(path: Path = _GATEWAYS, path_of_3: Path = _GATEWAYS_OF_3) -> Iterator[None]:
    """Let Fast DDS read a file, by default the gateway's, unless the environment names one itself.

    *path_of_3* is for Fast DDS 3. It is read once in a process, when the first node is created. The
    environment is as before afterwards: what this process starts chooses for itself.
    """
    if any(name in os.environ for name in _VARIABLES):
        yield
        return
    of_2, of_3 = _VARIABLES
    name, chosen = (of_2, path) if is_second() else (of_3, path_of_3)
    os.environ[name] = str(chosen)
    try:
        yield
    finally:
        os.environ.pop(name, None)


@contextlib.contextmanager
def silence() -> Iterator[None]:
    """Keep Fast DDS from reporting anything, unless the environment names a profile.

    That may say where it reports, which nothing here could restore. So enter this before `profile`.
    """
    if any(name in os.environ for name in _VARIABLES):
        yield
        return
    try:
        library = ctypes.CDLL(_RMW)
        clear, flush, reset = (library[name] for name in (_CLEAR_CONSUMERS, _FLUSH, _RESET))
    except (OSError, AttributeError):  # rmw uses something else
        yield
        return
    clear()
    try:
        yield
    finally:
        flush()  # it reports by a thread
        reset()


def forget_error() -> None:
    """Forget what rmw has noted as an error in this thread. Call it where nothing has failed.

    With Fast DDS 3 it notes one for each entity of a made type, does not use it, and writes fifteen
    lines to stderr when the next one comes.
    """
    if not is_second():
        _reset_error()()


@functools.cache
def _reset_error() -> Callable[[], object]:
    try:
        return ctypes.CDLL(_RCUTILS).rcutils_reset_error
    except (OSError, AttributeError):
        return bool  # that does nothing


@functools.cache
def is_second() -> bool:
    """Return whether rmw uses Fast DDS 2, which calls things otherwise than Fast DDS 3 does."""
    try:
        return hasattr(ctypes.CDLL(_RMW), _OF_2)
    except OSError:  # rmw uses something else
        return False
