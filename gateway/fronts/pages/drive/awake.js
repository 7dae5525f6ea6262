// SPDX-License-Identifier: Apache-2.0
// The screen stays on while this page is seen: a dark screen hides the page, which stops the robot.

/** Return a function that keeps the screen on from its first call on. Only pages of https and localhost can. */
export function wakeLock() {
  let isWanted = false;
  let lock = null;
  const ask = async () => {
    if (!isWanted || document.hidden || (lock && !lock.released)) return;
    lock = { released: false }; // one request at a time
    lock = await navigator.wakeLock?.request("screen").catch(() => null); // the battery is low
  };
  document.addEventListener("visibilitychange", ask); // hiding the page ends a lock
  return () => {
    if (isWanted) return;
    isWanted = true;
    ask();
  };
}
