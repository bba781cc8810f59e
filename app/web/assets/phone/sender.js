// One sender for a site's queue: in order, one at a time, for as long as it takes.
import { KEY_SHOWN, Problem, Unreachable } from "../core/api.js";
import { firstTask, noteTry, settle } from "./queue.js";
import { perform } from "./tasks.js";

const FIRST_PAUSE_S = 1;
const LONGEST_PAUSE_S = 60;
const KEY_WANTED = [401, 403];
const WORTH_WAITING = [408, 425, 429, 500, 502, 503, 504, 507]; // the server is full, slow or ill, not the picture wrong
const BLAMES_PICTURE = [500, 504]; // again and again: a picture that no worker survives must not stop those behind it
const MOST_TRIES = 5;
const HOPES = ["online", KEY_SHOWN]; // after these what failed may succeed

/** @typedef {{state: "idle" | "sending" | "pausing" | "key", error: Error | null, again_ms: number | null}} Standing */

/** Sends what waits until it is closed; of several tabs one sends. */
export class Sender {
  /**
   * @param {string} site_id
   * @param {() => Promise<object>} readingOf the clock's, now
   * @param {(standing: Standing, settled: boolean) => void} onChange
   */
  constructor(site_id, readingOf, onChange) {
    Object.assign(this, { site_id, readingOf, onChange, stop: new AbortController(), pause_s: FIRST_PAUSE_S, asked: false, woken: () => {} });
    this.wake = () => { this.pause_s = FIRST_PAUSE_S; this.asked = true; this.woken(); };
    for (const name of HOPES) addEventListener(name, this.wake);
    const { locks } = navigator; // on secure pages; elsewhere two tabs may send the same twice, which the service keeps once
    const running = locks ? locks.request(`scattermark-sender:${site_id}`, { signal: this.stop.signal }, () => this.run()) : this.run();
    running.catch((error) => { if (error.name !== "AbortError") throw error; });
  }

  close() {
    for (const name of HOPES) removeEventListener(name, this.wake);
    this.stop.abort();
    this.woken();
  }

  tell(state, error = null, again_ms = null, settled = false) {
    if (!this.stop.signal.aborted) this.onChange({ state, error, again_ms }, settled);
  }

  async run() {
    while (!this.stop.signal.aborted) {
      this.asked = false;
      try {
        const next = await firstTask(this.site_id);
        if (next) await this.send(next);
        else { this.tell("idle"); await this.sleep(); }
      } catch (error) { // of the phone's own store: it may have room again later
        this.tell("pausing", error, Date.now() + 1000 * LONGEST_PAUSE_S);
        await this.sleep(LONGEST_PAUSE_S);
      }
    }
  }

  /** Until somebody wakes it, or some seconds have passed. */
  sleep(seconds = null) {
    if (this.stop.signal.aborted || this.asked) return Promise.resolve();
    return new Promise((resolve) => {
      const timer = seconds === null ? 0 : setTimeout(resolve, 1000 * seconds);
      this.woken = () => { clearTimeout(timer); resolve(); };
    });
  }

  async send({ task, picture }) {
    this.tell("sending");
    try {
      const unknown = task.kind === "locate" && !task.reading; // it was taken before the clocks were compared
      const answer = await perform(task, picture, unknown ? await this.readingOf() : null);
      await this.end(task, { answer });
    } catch (error) {
      if (!(error instanceof Problem || error instanceof Unreachable)) throw error;
      await this.afterFailure(task, error);
    }
  }

  async end(task, outcome) {
    await settle(task, { ...outcome, ended_ms: Date.now() });
    this.pause_s = FIRST_PAUSE_S;
    this.tell("sending", null, null, true);
  }

  /** A refusal is a result; what may pass is tried again; a key must be shown by somebody. */
  async afterFailure(task, error) {
    if (KEY_WANTED.includes(error.status)) { this.tell("key", error); return this.sleep(); }
    const passes = error instanceof Unreachable || WORTH_WAITING.includes(error.status);
    const blamed = BLAMES_PICTURE.includes(error.status);
    if (blamed) await noteTry(task);
    if (!passes || (blamed && task.tries + 1 >= MOST_TRIES)) return this.end(task, { problem: error.members });
    const pause_s = error.members?.retry_after_s ?? this.pause_s;
    this.pause_s = Math.min(2 * this.pause_s, LONGEST_PAUSE_S);
    this.tell("pausing", error, Date.now() + 1000 * pause_s);
    return this.sleep(pause_s);
  }
}
