// SPDX-License-Identifier: Apache-2.0

const CONTROLS = "button:enabled, summary";

/**
 * Make a list one stop of the Tab key, whatever comes into it: arrow keys go up and down its rows, and along the buttons of a row.
 * @param {HTMLElement} list
 * @returns {() => void} to be called when what is listed has changed
 */
export function rove(list) {
  let current = null; // the entry that Tab reaches

  function choose(control) {
    current?.setAttribute("tabindex", "-1");
    current = control;
    current?.setAttribute("tabindex", "0");
  }

  function settle() {
    for (const each of list.querySelectorAll(`:is(${CONTROLS}):not([tabindex])`)) each.setAttribute("tabindex", "-1");
    const closed = [...list.querySelectorAll("details:not([open])")].find((each) => each.contains(current)); // the outermost
    if (closed) choose(closed.querySelector("summary")); // its content is hidden
    else if (!list.contains(current)) choose(list.querySelector(CONTROLS));
  }

  list.addEventListener("focusin", ({ target }) => target instanceof HTMLElement && target.matches(CONTROLS) && choose(target));
  list.addEventListener("toggle", settle, { capture: true }); // it does not bubble
  list.addEventListener("keydown", (event) => {
    const next = beside(list, document.activeElement, event.key);
    if (!next) return;
    event.preventDefault(); // arrows would scroll
    next.focus();
  });
  settle();
  return settle;
}

/**
 * Let keys lead from a search to what it has found: the down arrow goes to the first row, and Enter opens the first name.
 * @param {HTMLInputElement} search
 * @param {() => HTMLElement} list returns the list that is shown
 */
export function lead(search, list) {
  search.addEventListener("keydown", (event) => {
    const wanted = { ArrowDown: CONTROLS, Enter: search.value.trim() && "li > button" }[event.key];
    const first = wanted && [...list().querySelectorAll(wanted)].find((each) => each.checkVisibility());
    if (!first || event.isComposing) return;
    event.preventDefault();
    first.focus();
    if (event.key === "Enter") first.click();
  });
}

/** Return what a key leads to from a control of a list, if that is anywhere. @returns {HTMLElement|undefined} */
function beside(list, control, key) {
  const seen = [...list.querySelectorAll(CONTROLS)].filter((each) => each.checkVisibility());
  const rows = [...new Set(seen.map((each) => each.closest("li")))].map((row) => seen.filter((each) => each.closest("li") === row));
  const row = rows.findIndex((each) => each.includes(control));
  const along = rows[row]?.indexOf(control);
  switch (key) {
    case "ArrowDown": return rows[row + 1]?.[0];
    case "ArrowUp": return rows[row - 1]?.[0];
    case "ArrowRight": return rows[row]?.[along + 1];
    case "ArrowLeft": return rows[row]?.[along - 1];
    case "Home": return rows[0]?.[0];
    case "End": return rows.at(-1)?.[0];
    default: return undefined;
  }
}
