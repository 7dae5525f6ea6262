// SPDX-License-Identifier: Apache-2.0
// The fingers and keys that hold STOP: until they let go, this page moves nothing.

const holders = new Set();
const drops = new Set();

/** Hold STOP, by a finger's number or a key's code, until that is up. */
export function hold(holder) {
  holders.add(holder);
  for (const drop of drops) drop();
}

/** Call a function whenever a finger or a key begins to hold STOP. */
export const whenHeld = (drop) => drops.add(drop);

/** Whether STOP is held. */
export const isHeld = () => holders.size > 0;

for (const kind of ["pointerup", "pointercancel"]) addEventListener(kind, (/** @type {PointerEvent} */ { pointerId }) => holders.delete(pointerId), true);
addEventListener("keyup", ({ code }) => holders.delete(code), true);
// nobody tells of what is let go elsewhere
for (const kind of ["blur", "pagehide", "contextmenu"]) addEventListener(kind, () => holders.clear());
