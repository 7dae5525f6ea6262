// SPDX-License-Identifier: Apache-2.0
// The state of a command topic, as a person who drives reads it.

const CAUSES = {
  stop: "somebody pressed STOP",
  deadline: "commands ceased",
  disconnect: "the client that drove has left",
  takeover: "another client took over",
  lease: "control was lost",
  permission: "this role may not drive any more",
  invalid_value: "a command was wrong",
  backlog: "commands came late",
  guard: "the process that would stop it was lost",
  reader: "another program began to listen",
  shutdown: "the gateway ended",
};

// The same, where this page is the cause.
const OWN_CAUSES = { stop: "you pressed STOP", takeover: "you took over" };

/** Return why the robot was stopped, for a `control` frame, or "" if it was told to stand. */
export function reason({ cause, holder, isStopper }) {
  const isOwn = cause === "stop" ? isStopper : holder === "you";
  return (isOwn && OWN_CAUSES[cause]) || (CAUSES[cause] ?? "");
}

/** Return the sentence for a `control` frame; its member `isStopper` is whether this page has pressed STOP. */
export function sentence(frame) {
  const { state, tripped, holder, guard, clamped } = frame;
  if (guard === "lost") return "Nothing moves: the process that would stop the robot was lost; a new one is starting.";
  if (guard === "starting") return "Nothing moves yet: the process that would stop the robot is starting.";
  if (holder === "other") return tripped ? "Stopped; another client has control." : "Another client drives.";
  if (state === "moving" && !tripped) return clamped ? "Driving, slower than you ask: the gateway limits the speed." : "Driving.";
  const why = reason(frame);
  if (tripped) return `Stopped${why && `: ${why}`}. Let go of everything, then drive on.`;
  return why ? `Stopped: ${why}.` : "Stopped.";
}

/** Return what a `status` says, without what only programs can do about it; "" for what somebody expects who pressed STOP. */
export function refusal({ code, msg }) {
  if (code === "tripped" && msg.includes(" is stopped, ")) return "The robot was stopped, and took no command since. Let go of everything, then drive on.";
  if (code === "stale_command" && msg.includes(" before a stop, ")) return "";
  if (code === "stale_command") return "What you held came late and was not carried out: the connection or this device is slow.";
  if (code !== "not_lease_holder") return msg;
  const [first] = msg.split(";");
  return `${first[0].toUpperCase()}${first.slice(1)}.`;
}

// By code, whether a refusal is no longer true.
const OVER = {
  not_lease_holder: ({ state }) => state !== null && state.holder !== "other",
  tripped: ({ state }) => state !== null && !state.tripped,
};

/** Return when what a `status` says is over; by default, once the robot drives. */
export const isOver = ({ code }) => OVER[code];
