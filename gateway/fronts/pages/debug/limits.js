// SPDX-License-Identifier: Apache-2.0
// The greeting of the gateway to a connection, in words with units.

import { bytes } from "../shared/dom.js";
import { language, say } from "../shared/language.js";

const count = (value) => value.toLocaleString(language);
const seconds = (value) => `${value} s`;
const rate = (value) => (value ? say("unit.rate", { count: count(value) }) : say("unit.unlimited"));
const share = (value) => (value < 1 ? say("unit.share", { percent: Math.round(value * 100) }) : say("unit.unlimited"));

/** How the value of each member of `hello` and of its `limits` is written. @type {Object<string, (value: any) => string>} */
const WRITERS = {
  server: String,
  version: String,
  protocol: String,
  ros_distro: String,
  domain_id: String,
  rmw: String,
  discovery: String,
  role: String,
  message_bytes: bytes,
  client_time_share: share,
  address_time_share: share,
  frames_per_s: rate,
  frames_burst: count,
  subscriptions: count,
  advertisements: count,
  pending_calls: count,
  goals: count,
  transforms: count,
  service_timeout_s: seconds,
  name_characters: (value) => say("unit.characters", { count: count(value) }),
  json_depth: (value) => say("unit.levels", { count: count(value) }),
  json_items: count,
  queue_length: (value) => say("unit.messages", { count: count(value) }),
  send_queue_bytes: bytes,
};

/** Return the words for a member and its value. Of one that is unknown here, its key and the bare value. */
export function worded(key, value) {
  return Object.hasOwn(WRITERS, key) ? { words: say(`limits.${key}`), value: WRITERS[key](value) } : { words: key, value: String(value) };
}
