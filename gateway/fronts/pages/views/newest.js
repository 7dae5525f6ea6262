// SPDX-License-Identifier: Apache-2.0

/** Shows the newest message, if that takes a while. Only the newest of the others waits. */
export class Newest {
  #card;
  #words;
  #show;
  #next = null;
  #isBusy = false;
  #failure = ""; // the words about the newest

  /**
   * @param {{tell: (words: string) => void, untell: (words: string) => void}} card says what cannot be shown, until something can
   * @param {(message: any, why: string) => string} words says that a message cannot be shown, and why
   * @param {(message: any) => Promise<void>} show rejects if it cannot
   */
  constructor(card, words, show) {
    this.#card = card;
    this.#words = words;
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
      this.#failure = this.#words(message, error.message);
    }
    if (before && before !== this.#failure) this.#card.untell(before);
    if (this.#failure) this.#card.tell(this.#failure);
  }
}
