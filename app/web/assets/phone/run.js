// A run: a picture every so many seconds into one trajectory. It goes on after the page was closed, until somebody ends it.
import { useAction } from "../core/hooks.js";
import { useEffect, useRef, useState } from "../core/html.js";
import { newId } from "./ids.js";
import { closeTask, openTask } from "./tasks.js";

const nameOfKey = (site_id) => `scattermark:run:${site_id}`;

/** @typedef {{trajectory_id: string, name: string, every_s: number, begun_ms: number}} Run */

function read(site_id) {
  return JSON.parse(localStorage.getItem(nameOfKey(site_id)) ?? "null");
}

/**
 * @param {string} site_id
 * @param {(task: object) => Promise<void>} add to the queue
 * @param {(run: Run) => Promise<void>} snap takes a picture and puts it in the queue
 * @returns {{run: Run | null, going: boolean, skipped: number, busy: boolean, error: Error | null, start: Function, pause: Function, resume: Function, end: Function}}
 */
export function useRun(site_id, add, snap) {
  const [run, setRun] = useState(() => read(site_id));
  const [going, setGoing] = useState(false);
  const [skipped, setSkipped] = useState(0);
  const latest = useRef(snap);
  latest.current = snap;
  const taking = useRef(null); // the picture that is being made
  const keep = (next) => {
    next ? localStorage.setItem(nameOfKey(site_id), JSON.stringify(next)) : localStorage.removeItem(nameOfKey(site_id));
    setRun(next);
  };
  useEffect(() => {
    if (!going) return undefined;
    const tick = () => {
      if (taking.current) return setSkipped((before) => before + 1); // nothing piles up
      taking.current = latest.current(run).finally(() => { taking.current = null; });
      return undefined;
    };
    tick();
    const timer = setInterval(tick, 1000 * run.every_s);
    return () => clearInterval(timer);
  }, [going, run]);
  const starting = useAction(async ({ name, every_s, device_id }) => {
    const begun = { trajectory_id: newId(), name, every_s, begun_ms: Date.now() };
    await add(openTask(site_id, begun.trajectory_id, device_id, name));
    setSkipped(0);
    keep(begun);
    setGoing(true);
  });
  const ending = useAction(async () => {
    setGoing(false);
    await taking.current; // a picture that came after the end would be refused
    await add(closeTask(site_id, run.trajectory_id));
    keep(null);
  });
  return {
    run, going, skipped,
    busy: starting.busy || ending.busy,
    error: starting.error ?? ending.error,
    start: starting.run,
    pause: () => setGoing(false),
    resume: () => setGoing(true),
    end: ending.run,
  };
}
