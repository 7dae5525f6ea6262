// SPDX-License-Identifier: Apache-2.0
// The token of a page, which is kept until its tab is closed.

const KEY = "ros2-gateway.token";

/** Return a token as people paste it, without what belongs to the header of HTTP. */
export const cleaned = (text) => text.trim().replace(/^Bearer\s+/i, "");

/** Return whether a token can be sent: a subprotocol takes no other characters, and none that the gateway makes has them. */
export const isToken = (token) => /^[!#$%&'*+\-.^_`|~0-9A-Za-z]+$/.test(token);

/** Return the token: that behind # in the address, as a QR code has it, or the one kept for this tab. */
export function take() {
  const given = new URLSearchParams(location.hash.slice(1));
  const token = given.get("token");
  if (!token) return sessionStorage.getItem(KEY);
  given.delete("token"); // nobody should copy it with the address
  history.replaceState(null, "", `${location.pathname}#${given}`);
  return cleaned(token);
}

/** Keep a token that the gateway knows, or none. */
export function keep(token) {
  if (token) sessionStorage.setItem(KEY, token);
  else sessionStorage.removeItem(KEY);
}
