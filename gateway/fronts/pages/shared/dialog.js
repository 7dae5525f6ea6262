// SPDX-License-Identifier: Apache-2.0

/**
 * Show a dialog above a page that goes on: STOP stays in reach of a pointer and of its key. Escape closes it.
 * @param {HTMLDialogElement} dialog
 */
export function showDialog(dialog) {
  if (dialog.open) return;
  dialog.show();
  dialog.tabIndex = -1;
  (dialog.querySelector("input") ?? dialog).focus(); // not its button, which would keep the space bar from STOP
  const escape = (event) => {
    if (event.key !== "Escape" || document.querySelector(":popover-open")) return;
    event.preventDefault();
    event.stopPropagation(); // it is for nothing behind the dialog
    dialog.close();
  };
  addEventListener("keydown", escape, true);
  dialog.addEventListener("close", () => removeEventListener("keydown", escape, true), { once: true });
}
