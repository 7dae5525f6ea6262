// SPDX-License-Identifier: Apache-2.0
// The state of a command topic, as a person who drives reads it.

const CAUSES = {
  stop: "another client pressed STOP",
  deadline: "commands stopped arriving",
  disconnect: "the client that drove disconnected",
  takeover: "another client took over",
  lease: "control was lost",
  permission: "this role may no longer drive",
  invalid_value: "a command was invalid",
  backlog: "commands arrived late",
  guard: "the guard process ended or hung",
  reader: "another node began to listen",
  shutdown: "the gateway shut down",
};

// The same, where this page is the cause.
const OWN_CAUSES = { stop: "you pressed STOP", takeover: "you took over" };

/** Return why the robot was stopped, for a `control` frame, or "" if it was told to stand. */
export function reason({ cause, holder, isStopper }) {
  const isOwn = cause === "stop" ? isStopper : holder === "you";
  return (isOwn && OWN_CAUSES[cause]) || (CAUSES[cause] ?? "");
}

/** Return the sentence for a `control` frame. Its member `isStopper` is whether this page has pressed STOP. */
export function sentence(frame) {
  const { state, tripped, holder, guard, clamped } = frame;
  if (guard === "lost") return "Nothing moves because the guard process ended or hung. A new one is starting: wait, then press again.";
  if (guard === "starting") return "Nothing moves yet because the guard process is starting. Wait a moment.";
  if (holder === "other") return tripped ? "Stopped. Another client has control." : "Another client drives.";
  if (state === "moving" && !tripped) return clamped ? "Driving, but the gateway limits the speed." : "Driving.";
  const why = reason(frame);
  if (tripped) return `Stopped${why && `: ${why}`}. To drive on, let go of everything, then press again.`;
  return why ? `Stopped: ${why}.` : "Stopped.";
}

/**
 * Return the words for a `status`, without advice for programs. "" for the expected result of STOP.
 * @param {import("./gateway.js").Status} status
 */
export function refusal({ code, msg }) {
  if (code === "tripped" && msg.includes(" is stopped")) return "The robot was stopped. To drive on, let go of everything, then press again.";
  if (code === "stale_command" && msg.includes(" before a stop")) return "";
  if (code === "stale_command") return "Your command arrived late and was not carried out, because the connection or this device is slow. Let go, then press again.";
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
