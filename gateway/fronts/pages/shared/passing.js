// SPDX-License-Identifier: Apache-2.0

// Codes for messages that stay away for a while. A pale view says so, until they are back.
const PASSING = ["messages_lost", "publisher_gone", "liveliness_lost", "deadline_missed", "stale", "fresh"];

/**
 * Return what tells a person a status of the gateway, unless it is over by itself and seen elsewhere.
 * @param {(words: string) => void} tell
 * @returns {(status: import("./gateway.js").Status) => void}
 */
export function lasting(tell) {
  return ({ code, msg }) => {
    if (!PASSING.includes(code)) tell(msg);
  };
}

/** The next message ends these. */
export const OF_SILENCE = ["not_found", "publisher_gone", "liveliness_lost", "deadline_missed", "invalid_value"];
