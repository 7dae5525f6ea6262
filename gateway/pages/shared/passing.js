// SPDX-License-Identifier: Apache-2.0

// What tells of messages that stay away for a while: a view that turns pale says so, and no longer when they are back.
const PASSING = ["messages_lost", "publisher_gone", "liveliness_lost", "deadline_missed", "stale", "fresh"];

/** Return what tells a person a status of the gateway, unless it is over by itself and seen elsewhere. */
export function lasting(tell) {
  return ({ code, msg }) => {
    if (!PASSING.includes(code)) tell(msg);
  };
}

/** What is over with the next message. */
export const OF_SILENCE = ["not_found", "publisher_gone", "liveliness_lost", "deadline_missed", "invalid_value"];
