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
  shutdown: "the gateway ended",
};

/** Return why the robot was stopped, for a `control` frame, or "" if it was told to stand. */
export const reason = ({ cause, holder }) => (cause === "takeover" && holder === "you" ? "you took over" : CAUSES[cause] ?? "");

/** Return the sentence for a `control` frame. */
export function sentence(frame) {
  const { state, tripped, holder, guard, clamped } = frame;
  if (guard === "lost") return "Nothing moves: the process that would stop the robot was lost; a new one is starting.";
  if (guard === "starting") return "Nothing moves yet: the process that would stop the robot is starting.";
  if (holder === "other") return "Another client drives.";
  if (state === "moving" && !tripped) return clamped ? "Driving, slower than you ask: the gateway limits the speed." : "Driving.";
  const why = reason(frame);
  if (tripped) return `Stopped${why && `: ${why}`}. Let go of everything, then drive on.`;
  return why ? `Stopped: ${why}.` : "Stopped.";
}

/** Return what a `status` says, without what only programs can do about it. */
export function refusal({ code, msg }) {
  if (code === "tripped") return "The robot was stopped, and took no command since. Let go of everything, then drive on.";
  if (code !== "not_lease_holder") return msg;
  const [first] = msg.split(";");
  return `${first[0].toUpperCase()}${first.slice(1)}.`;
}
