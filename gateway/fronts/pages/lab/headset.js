// SPDX-License-Identifier: Apache-2.0
// Into VR and out of it, or why VR is not available, in words.

import { say } from "../shared/language.js";

/**
 * Make a button enter VR and leave it.
 * @param {import("../vendor/three.js").WebXRManager} xr
 * @param {HTMLButtonElement} button
 * @param {HTMLElement} note the element for the words
 * @param {{began: () => void, ended: () => void, unseen: () => void}} tell `unseen`: the headset shows something else
 */
export async function connectHeadset(xr, button, note, tell) {
  xr.setReferenceSpaceType("local-floor");
  let session = null;

  async function enter() {
    button.disabled = true;
    try {
      session = await system().requestSession("immersive-vr", { requiredFeatures: ["local-floor"], optionalFeatures: ["hand-tracking"] });
      session.addEventListener("visibilitychange", ({ target }) => target.visibilityState !== "visible" && tell.unseen());
      session.addEventListener("end", ended);
      tell.began();
      await xr.setSession(session);
      button.textContent = say("vr.leave");
      note.textContent = "";
    } catch (error) {
      note.textContent = say("vr.failed", { why: error.message });
      await session?.end().catch(() => {}); // it may have ended by itself
    }
    button.disabled = false;
  }

  function ended() {
    session = null;
    button.textContent = say("vr.enter");
    tell.ended();
  }

  button.onclick = () => (session ? session.end() : enter());
  const refusal = await whyNot();
  note.textContent = refusal;
  button.disabled = Boolean(refusal);
}

/** @returns {any} what the browser has of WebXR */
const system = () => Reflect.get(navigator, "xr");

async function whyNot() {
  if (!isSecureContext) return say("vr.secure");
  if (!system()) return say("vr.none");
  const isThere = await system().isSessionSupported("immersive-vr").catch(() => false);
  return isThere ? "" : say("vr.unconnected");
}
