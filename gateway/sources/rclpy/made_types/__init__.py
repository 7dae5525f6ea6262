# SPDX-License-Identifier: Apache-2.0
"""Types made at run time by ctypes: of packages that are not installed, and of services.

This is the riskiest code of the gateway, because a mistake ends the process. It relies on this:

- rclpy finds the functions and the structure of a type in capsules that are attributes of the
  metaclass of its class. It calls those functions with the GIL.
- Of a type's structure ``rmw_fastrtps_cpp`` reads its name, its REP-2011 hash, its description,
  that its size is not bounded, and how it is written and read.
- rmw and rcl keep pointers to structures, so these are never freed (`type_supports.keep`).
- rmw calls some functions of a type under a lock of DDS. No bytecode may run in those, because
  Python could pass the GIL to another thread. If that one then waits for the lock, as when it
  creates an entity, neither ever continues. So they are C all the way, put together from what
  Python and Fast CDR have.
- The structures are those since Jazzy (`type_supports`), and Fast CDR has the functions that
  `fast_cdr` finds. No exception of C++ passes through Python.

Another process tries all of it first (`check`), because a difference in C may end it.
"""
