// SPDX-License-Identifier: Apache-2.0
// What every page has at its top: the connection in words, the token that may be asked for, and STOP.

const WORDS = {
  open: () => "connected",
  connecting: () => "connecting",
  closed: (reason) => `not connected${reason ? `: ${reason}` : ""}; trying again`,
  token: () => "a token is needed",
};

const find = (id) => document.getElementById(id);

/** Show a sentence to everybody, or nothing. */
export function tell(text) {
  find("notice").textContent = text;
  find("notice").hidden = !text;
}

/** Stop the robot, whoever drives it. */
export async function stop(gateway) {
  try {
    const { topics } = await gateway.ask({ op: "stop" });
    tell(topics.length ? `stopping ${topics.join(", ")}` : "nothing moves: no command topic is in use");
  } catch (error) {
    tell(`STOP was not carried out: ${error.message}`);
  }
}

/** Connect the bar of a page with its gateway. */
export function connect(gateway) {
  gateway.addEventListener("state", ({ detail: { state, reason } }) => {
    find("state").textContent = WORDS[state](reason);
    find("state").dataset.state = state;
    if (state === "open") tell("");
    if (state === "token") {
      find("token-problem").textContent = reason;
      find("token").showModal();
    }
  });
  gateway.addEventListener("status", ({ detail }) => tell(detail.msg));
  find("token").addEventListener("close", () => gateway.useToken(find("token-text").value.trim()));
  find("stop").onclick = () => stop(gateway);
}
