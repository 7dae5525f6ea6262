// SPDX-License-Identifier: Apache-2.0

/**
 * Make buttons of the role `tab` show what each controls, by the mouse, and by the arrow keys, Home and End.
 * @param {any} list an element
 * @param {(tab: HTMLElement) => void} shown is called with the tab that was chosen
 */
export function connect(list, shown) {
  const tabs = [...list.querySelectorAll('[role="tab"]')];
  const show = (chosen) => {
    for (const tab of tabs) {
      tab.setAttribute("aria-selected", tab === chosen);
      tab.tabIndex = tab === chosen ? 0 : -1;
      document.getElementById(tab.getAttribute("aria-controls")).hidden = tab !== chosen;
    }
    shown(chosen);
  };
  for (const [index, tab] of tabs.entries()) {
    tab.onclick = () => show(tab);
    tab.onkeydown = ({ key }) => {
      const next = { ArrowRight: tabs[index + 1] ?? tabs[0], ArrowLeft: tabs.at(index - 1), Home: tabs[0], End: tabs.at(-1) }[key];
      if (!next) return;
      show(next);
      next.focus();
    };
  }
  show(tabs[0]);
}
