// SPDX-License-Identifier: Apache-2.0
// Dark or light. A classic script in the head of each page: the colours are there before anything is drawn.
// As the first script it also stands in for a storage that the browser blocks, or no module would start, and there would be no STOP.

/** @typedef {"system"|"dark"|"light"} Theme */

(() => {
  const KEY = "ros2-gateway.theme";
  const THEMES = ["dark", "light"];
  for (const name of ["localStorage", "sessionStorage"]) {
    try {
      window[name].getItem(KEY);
    } catch {
      Object.defineProperty(window, name, { value: forgetful() });
    }
  }
  const system = matchMedia("(prefers-color-scheme: light)");

  /** Return a storage that lasts as long as the page. */
  function forgetful() {
    const kept = new Map();
    return {
      getItem: (key) => kept.get(key) ?? null,
      setItem: (key, value) => kept.set(key, String(value)),
      removeItem: (key) => kept.delete(key),
    };
  }

  /** Return what was chosen. @returns {Theme} */
  function chosen() {
    const kept = localStorage.getItem(KEY);
    return /** @type {Theme} */ (THEMES.includes(kept) ? kept : "system");
  }

  function apply() {
    const { dataset } = document.documentElement;
    const before = dataset.theme;
    dataset.theme = chosen() === "system" ? (system.matches ? "light" : "dark") : chosen();
    if (before && before !== dataset.theme) dispatchEvent(new Event("themechange")); // for what is drawn on a canvas
  }

  document.addEventListener("choosetheme", (/** @type {CustomEvent} */ event) => {
    if (THEMES.includes(event.detail)) localStorage.setItem(KEY, event.detail);
    else localStorage.removeItem(KEY);
    apply();
  });
  addEventListener("storage", apply); // another tab
  system.addEventListener("change", apply);
  apply();
})();
