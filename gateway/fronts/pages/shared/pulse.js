// SPDX-License-Identifier: Apache-2.0
// Whether the gateway still answers. A dead connection stays silent for many minutes.

const BEAT_MS = 1000;
const PING_BEATS = 2;
// A slow network and a busy gateway answer within about a second. A driven robot has stopped before that.
const SILENT_BEATS = 3;
// Longer than the gateway waits for a client that answers no ping (10 s), so that it has let go of the old connection. And than
// the operations of one client may wait for their turn (13 s behind 3,000 subscriptions).
const LOST_BEATS = 15;

/** Counts the seconds without anything from the gateway while an answer is due. */
export class Pulse {
  #ping;
  #told;
  #lost;
  #timer = 0;
  #beats = 0;
  #missed = 0; // beats, not time: a page that stood still itself has not listened
  #isDue = false;

  /**
   * @param {() => Promise<any>} ping ends with the answer
   * @param {(seconds: number) => void} told is called with each further second of a silence, and with 0 when it is over
   * @param {(seconds: number) => void} lost is called when nothing is to be expected any more
   */
  constructor(ping, told, lost) {
    this.#ping = ping;
    this.#told = told;
    this.#lost = lost;
  }

  /** Begin with a connection that is being made: its first frame is due. */
  begin() {
    this.end();
    this.#isDue = true;
    this.#timer = setInterval(() => this.#beat(), BEAT_MS);
  }

  /** Note that something has come. */
  heard() {
    const wasSilent = this.#missed >= SILENT_BEATS;
    this.#missed = 0;
    if (wasSilent) this.#told(0);
  }

  /** Ask for an answer now. */
  async ask() {
    this.#isDue = true;
    await this.#ping();
    this.#isDue = false;
  }

  end() {
    clearInterval(this.#timer);
    this.#missed = 0;
  }

  #beat() {
    this.#beats += 1;
    if (!this.#isDue && this.#beats % PING_BEATS === 0) this.ask();
    else if (this.#isDue) this.#miss();
  }

  #miss() {
    this.#missed += 1;
    const seconds = (this.#missed * BEAT_MS) / 1000;
    if (this.#missed >= LOST_BEATS) this.#lost(seconds);
    else if (this.#missed >= SILENT_BEATS) this.#told(seconds);
  }
}
