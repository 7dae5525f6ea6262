// SPDX-License-Identifier: Apache-2.0

const FAR_PX = 6; // less is a click

/**
 * Let the mouse move a card by its header: it goes before or after the card on which it is dropped. A finger scrolls there.
 * @param {HTMLElement} card
 * @param {HTMLElement} header
 * @param {(before: Element|null) => void} move is called with the card that it comes before, null at the end
 */
export function movable(card, header, move) {
  header.addEventListener("pointerdown", (event) => {
    const { target, button, pointerType, clientX, clientY } = event;
    if (button || pointerType === "touch" || (target instanceof Element && target.closest("button, select, label, input, .menu"))) return;
    const ending = new AbortController();
    const { signal } = ending;
    /** @type {{at: Element, isAfter: boolean}|null} */
    let place = null;
    const mark = (next) => {
      place?.at.classList.remove("before", "after");
      place = next;
      place?.at.classList.add(place.isAfter ? "after" : "before");
    };
    const end = () => {
      mark(null);
      card.classList.remove("moving");
      ending.abort();
    };
    addEventListener("pointermove", (moved) => {
      if (!card.classList.contains("moving") && Math.hypot(moved.clientX - clientX, moved.clientY - clientY) < FAR_PX) return;
      card.classList.add("moving");
      getSelection()?.removeAllRanges();
      const at = document.elementFromPoint(moved.clientX, moved.clientY)?.closest(".card");
      if (!at || at === card || at.parentElement !== card.parentElement) return mark(null);
      const { left, width } = at.getBoundingClientRect();
      mark({ at, isAfter: moved.clientX > left + width / 2 });
    }, { signal });
    addEventListener("pointerup", () => {
      const [found] = [place];
      end();
      if (found) move(found.isAfter ? found.at.nextElementSibling : found.at);
    }, { signal });
    for (const each of ["pointercancel", "blur"]) addEventListener(each, end, { signal });
    addEventListener("keydown", ({ key }) => key === "Escape" && end(), { signal });
  });
}
