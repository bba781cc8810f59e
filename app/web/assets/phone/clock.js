// How far this phone's clock is from the service's: the answer with the shortest way there and back tells it best.
import { get } from "../core/api.js";
import { useEffect, useRef, useState } from "../core/html.js";

const PROBES = 8;
const AGAIN_MS = 60_000;
const DRIFT = 1e-4; // seconds per second by which a phone's clock may go wrong: ten times what quartz does
const TICK_S = 0.001; // of Date.now()

/** @typedef {{offset_s: number, delay_s: number, at_ms: number}} Reading service time = phone's time + offset_s, within delay_s */

/**
 * One comparison by some questions (Cristian 1989): the offset is known to half of the shortest round trip.
 * @returns {Promise<Reading>}
 */
export async function compareClocks(signal) {
  let best = null;
  for (let probe = 0; probe < PROBES; probe += 1) {
    const sent_ms = Date.now();
    const { server_time_s } = await get("/time", { signal });
    const reading = readingOf(sent_ms, Date.now(), server_time_s);
    if (!best || reading.delay_s < best.delay_s) best = reading;
  }
  return best;
}

function readingOf(sent_ms, received_ms, server_time_s) {
  const middle_s = (sent_ms + received_ms) / 2000;
  return { offset_s: server_time_s - middle_s, delay_s: (received_ms - sent_ms) / 2000 + TICK_S, at_ms: received_ms };
}

/** Half of the interval that holds the offset now: clocks drift since they were compared. */
export const halfWidth_s = (reading, now_ms) => reading.delay_s + (DRIFT * Math.abs(now_ms - reading.at_ms)) / 1000;

/** The one of two readings that knows the offset better at a time. */
export const better = (one, other, now_ms) => (!one || (other && halfWidth_s(other, now_ms) < halfWidth_s(one, now_ms)) ? other : one);

/**
 * The offset as it is known now; compared when the page opens, when the network comes back, and each minute.
 * @returns {{reading: Reading | null, current: () => Reading | null, known: () => Promise<Reading>}} the latter two for those who ask between two renderings; `known` compares when nobody has
 */
export function useClock() {
  const [reading, setReading] = useState(null);
  const latest = useRef(null);
  useEffect(() => {
    const controller = new AbortController();
    const compare = () => compareClocks(controller.signal).then((found) => {
      latest.current = better(latest.current, found, Date.now());
      setReading(latest.current);
    }, () => {}); // without a network the last comparison holds, and widens
    compare();
    addEventListener("online", compare);
    const timer = setInterval(compare, AGAIN_MS);
    return () => { controller.abort(); removeEventListener("online", compare); clearInterval(timer); };
  }, []);
  return { reading, current: () => latest.current, known: async () => latest.current ?? compareClocks() };
}
