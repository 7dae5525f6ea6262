// SPDX-License-Identifier: Apache-2.0
// The greeting of the gateway to a connection, in words with units.

import { bytes } from "../shared/dom.js";

const count = (value) => value.toLocaleString("en");
const seconds = (value) => `${value} s`;
const rate = (value) => (value ? `${count(value)} per second` : "no limit");
const share = (value) => (value < 1 ? `${Math.round(value * 100)} % of the gateway's time` : "no limit");

/** Of each member of `hello` and of its `limits` what it means, and how its value is written. @type {Object<string, [string, (value: any) => string]>} */
const WORDS = {
  server: ["Server", String],
  version: ["Version", String],
  protocol: ["Protocol", String],
  ros_distro: ["ROS 2 distribution", String],
  domain_id: ["ROS domain", String],
  rmw: ["Middleware", String],
  discovery: ["Reach of the discovery", String],
  role: ["Role of this page", String],
  message_bytes: ["Largest frame that this page may send", bytes],
  client_time_share: ["Work for this page, before the gateway slows it down", share],
  address_time_share: ["Work for all clients of this computer", share],
  frames_per_s: ["Frames that this page may send, on average", rate],
  frames_burst: ["Frames that it may send at once", count],
  subscriptions: ["Topics that it may subscribe to", count],
  advertisements: ["Topics that it may advertise", count],
  pending_calls: ["Service calls at once", count],
  goals: ["Action goals at once", count],
  transforms: ["Transforms that it may follow", count],
  service_timeout_s: ["Time for a service to answer", seconds],
  name_characters: ["Longest name", (value) => `${count(value)} characters`],
  json_depth: ["Deepest nesting of its JSON", (value) => `${count(value)} levels`],
  json_items: ["Values in one frame of JSON", count],
  queue_length: ["Longest queue of a topic", (value) => `${count(value)} messages`],
  send_queue_bytes: ["Data that waits for this page, before the oldest is dropped", bytes],
};

/** Return the words for a member and its value. Of one that is unknown here, its key and the bare value. */
export function worded(key, value) {
  const [words, write] = Object.hasOwn(WORDS, key) ? WORDS[key] : [key, String];
  return { words, value: write(value) };
}
