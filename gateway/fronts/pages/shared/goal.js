// SPDX-License-Identifier: Apache-2.0
// A goal of an action that this page has sent. STOP cancels it, or the robot would go on.

/** @typedef {{cancel: () => void, end: () => void}} Goal */

/**
 * Send a goal. Return it, or null without a connection.
 * @param {import("./gateway.js").Gateway} gateway
 * @param {{action: string, action_type: string, [member: string]: any}} request
 * @param {Object<string, string>} json as for `send`
 * @param {(frame: any) => void} heard gets what the gateway says of it, until `end`
 * @returns {Goal|null}
 */
export function sendGoal(gateway, request, json, heard) {
  const { id, end: unlisten } = gateway.listen(heard);
  const cancel = () => {
    gateway.send({ op: "cancel_action_goal", id, action: request.action });
  };
  const forget = gateway.on("stopping", cancel);
  const end = () => {
    forget();
    unlisten();
  };
  if (gateway.send({ op: "send_action_goal", id, feedback: true, ...request }, json)) return { cancel, end };
  end();
  return null;
}

/** Return whether a frame says that there is no goal: a refused cancel leaves it. */
export const isRefusal = ({ op, level, request }) => op === "status" && level === "error" && request === "send_action_goal";
