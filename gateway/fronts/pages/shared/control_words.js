// SPDX-License-Identifier: Apache-2.0
// The state of a command topic, as a person who drives reads it.

import { say } from "./language.js";

const CAUSES = ["stop", "deadline", "disconnect", "takeover", "lease", "permission", "invalid_value", "backlog", "guard", "reader", "shutdown"];
const OWN_CAUSES = ["stop", "takeover"]; // of this page itself

/** Return why the robot was stopped, for a `control` frame, or "" if it was told to stand. */
export function reason({ cause, holder, isStopper }) {
  const isOwn = cause === "stop" ? isStopper : holder === "you";
  if (isOwn && OWN_CAUSES.includes(cause)) return say(`cause.own.${cause}`);
  return CAUSES.includes(cause) ? say(`cause.${cause}`) : "";
}

/** Return the sentence for a `control` frame. Its member `isStopper` is whether this page has pressed STOP. */
export function sentence(frame) {
  const { state, tripped, holder, guard, clamped } = frame;
  if (guard === "lost") return say("control.guard.lost");
  if (guard === "starting") return say("control.guard.starting");
  if (holder === "other") return tripped ? say("control.other.tripped") : say("control.other");
  if (state === "moving" && !tripped) return clamped ? say("control.limited") : say("control.driving");
  const why = reason(frame);
  if (tripped) return why ? say("control.tripped.why", { why }) : say("control.tripped");
  return why ? say("control.stopped.why", { why }) : say("control.stopped");
}

/**
 * Return the words for a `status`, without advice for programs. "" for the expected result of STOP.
 * @param {import("./gateway.js").Status} status
 */
export function refusal({ code, msg }) {
  if (code === "tripped" && msg.includes(" is stopped")) return say("control.refused");
  if (code === "stale_command" && msg.includes(" before a stop")) return "";
  if (code === "stale_command") return say("control.late");
  if (code !== "not_lease_holder") return msg;
  const [first] = msg.split(/; |: let go/);
  return `${first[0].toUpperCase()}${first.slice(1)}.`;
}

// By code, whether a refusal is no longer true.
const OVER = {
  not_lease_holder: ({ state }) => state !== null && state.holder !== "other",
  tripped: ({ state }) => state !== null && !state.tripped,
};

/**
 * Return when what a `status` says is over. By default, once the robot drives.
 * @param {import("./gateway.js").Status} status
 */
export const isOver = ({ code }) => OVER[code];
