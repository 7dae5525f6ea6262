# SPDX-License-Identifier: Apache-2.0
"""The one place that uses rclpy and rcl beyond their documented API.

A change of rclpy that breaks the gateway most likely breaks something in this list.
``tests/sources/rclpy/test_rclpy_private.py`` checks each item against the rclpy that is installed
and runs before all other tests. All of it is so in rclpy 7.1 and rcl 9.2 (Jazzy).

Handles: the objects of the extension module ``rclpy._rclpy_pybind11`` behind rclpy's classes. As
context managers they keep rcl's object alive, and ``pointer`` is its address in C.

``Subscription.handle.take_message(type, raw)``
    Returns ``None`` or ``(bytes, {"received_timestamp": nanoseconds, "source_timestamp": ...,
    "publication_sequence_number": ...})``. rclpy's own way to a sample is an executor. Without it:
    no subscriptions.
``Publisher.handle.publish_raw(bytes)``
    `rclpy.publisher.Publisher.publish` also takes bytes, after checks in Python.
``Client.handle.send_request(request)``
    Returns the request's number. Without it, or without one of the next three: no services, no
    actions, no parameters. rclpy's own way needs an executor (see
    `gateway.sources.rclpy.requester`).
``Client.handle.take_response(type)``
    Returns ``(info, response)`` with ``info.request_id.sequence_number``, or ``(None, None)``, also
    for a response that cannot be read.
``Service.handle.service_take_request(type)``
    Returns ``(request, info)`` with ``info.request_id``, or ``(None, None)``, as above.
``Service.handle.service_send_response(response, request_id)``
    Warns with the text `RESPONSE_TIMED_OUT` if rmw has not found the client in time.
``rclpy.impl.implementation_singleton.rclpy_implementation.EventHandle(handle, kind)``
    With ``take_event()``, which returns rcl's count and the change since the last call,
    and ``destroy_when_not_in_use()``. Raises ``UnsupportedEventTypeError`` where the middleware
    lacks a kind. rclpy's own way needs an executor. Without it: nobody hears of missed deadlines
    and lost messages (`gateway.sources.rclpy.qos_events`), and a robot that joins while a client
    drives is noticed a little later.
``Clock.handle.get_now().nanoseconds``
    `rclpy.clock.Clock.now` returns the same, wrapped in a ``Time``.
``RCLError`` and ``InvalidHandle`` are RuntimeErrors
    Handles raise them. Otherwise they pass for errors of the gateway (see
    `gateway.sources.rclpy.errors`).

Functions of ``librcl.so``, by ctypes. Each takes the address of an entity:

``rcl_subscription_set_on_new_message_callback``, ``rcl_client_set_on_new_response_callback``,
``rcl_service_set_on_new_request_callback``
    Take ``(entity, callback, user_data)`` and call ``callback(user_data, count)`` on a thread of
    DDS. Without one of them, or on a middleware that lacks them: the gateway does not start.

``rcl_take_serialized_message``
    Takes ``(subscription, rcl_serialized_message_t, rmw_message_info_t, NULL)`` and returns 0, or
    401 where nothing is there. The layouts of both structures, with the publisher's GUID, and
    ``rcutils_get_default_allocator``, ``rcutils_get_error_string`` and ``rcutils_reset_error`` of
    ``librcutils.so``, go with it. Without them: ``take_message`` also for large samples, with two
    more copies of each and the GIL held, and samples that come to two readers are delivered twice.

``rcl_node_get_graph_guard_condition``, ``rcl_wait_set_add_guard_condition``
    Without one of them: the gateway does not start.

Wait sets: ``rclpy.impl.implementation_singleton.rclpy_implementation.WaitSet``, with six counts and
a context, its ``clear_entities``, ``add_guard_condition``, ``pointer``, ``wait`` and
``destroy_when_not_in_use``, with ``GuardCondition.handle``, ``Node.handle`` and ``Context.handle``.
Without them: as without ``rcl_wait_set_add_guard_condition``.

``rclpy.experimental.events_executor.EventsExecutor``
    Since Jazzy. Without it: ``SingleThreadedExecutor``, which looks at every entity at each turn.

Two other places use the layers below rclpy (rmw, rosidl and the middleware), and say what they
rely on: `gateway.sources.rclpy.fast_dds` (functions of rcutils and rmw), and
`gateway.sources.rclpy.made_types`. Without them: no types that are not installed.
"""
