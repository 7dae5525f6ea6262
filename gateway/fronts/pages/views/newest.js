// SPDX-License-Identifier: Apache-2.0

/** Shows the newest message, if that takes a while. Only the newest of the others waits. */
export class Newest {
  #card;
  #what;
  #show;
  #next = null;
  #isBusy = false;
  #failure = ""; // the words about the newest

  /**
   * @param {{tell: (words: string) => void, untell: (words: string) => void}} card says what cannot be shown, until something can
   * @param {(message: any) => string} what names a message in words
   * @param {(message: any) => Promise<void>} show rejects if it cannot
   */
  constructor(card, what, show) {
    this.#card = card;
    this.#what = what;
    this.#show = show;
  }

  async take(message) {
    this.#next = message;
    if (this.#isBusy) return;
    this.#isBusy = true;
    while (this.#next) {
      const newest = this.#next;
      this.#next = null;
      await this.#attempt(newest);
    }
    this.#isBusy = false;
  }

  async #attempt(message) {
    const before = this.#failure;
    try {
      await this.#show(message);
      this.#failure = "";
    } catch (error) {
      this.#failure = `${this.#what(message)} cannot be shown: ${error.message}`;
    }
    if (before && before !== this.#failure) this.#card.untell(before);
    if (this.#failure) this.#card.tell(this.#failure);
  }
}
