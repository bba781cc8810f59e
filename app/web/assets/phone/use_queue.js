// The queue as the page shows it: what waits, what came of the rest, how the sending stands.
import { useLayoutEffect, useRef, useState } from "../core/html.js";
import { addTask, discard, forgetResults, resultsOf, tasksOf } from "./queue.js";
import { Sender } from "./sender.js";

const CHANNEL = "scattermark-phone"; // by which tabs tell each other

/**
 * @param {string} site_id
 * @param {() => Promise<object>} readingOf the clock's, now
 */
export function useQueue(site_id, readingOf) {
  const [kept, setKept] = useState({ tasks: [], results: [], loaded: false, error: null });
  const [standing, setStanding] = useState({ state: "idle", error: null, again_ms: null });
  const parts = useRef(null);
  useLayoutEffect(() => { // there before a picture can be taken
    let open = true;
    const failed = (error) => open && setKept((before) => ({ ...before, error }));
    const load = () => Promise.all([tasksOf(site_id), resultsOf(site_id)]).then(([tasks, results]) => open && setKept({ tasks, results, loaded: true, error: null }), failed);
    const channel = new BroadcastChannel(CHANNEL);
    channel.onmessage = load;
    const changed = () => { channel.postMessage("changed"); return load(); };
    const sender = new Sender(site_id, readingOf, (now, settled) => { setStanding(now); if (settled) changed(); });
    parts.current = { sender, changed };
    load();
    return () => { open = false; sender.close(); channel.close(); };
  }, [site_id]);
  const act = async (work, wake) => {
    await work;
    await parts.current.changed();
    if (wake) parts.current.sender.wake();
  };
  return {
    ...kept, standing,
    add: (task, picture) => act(addTask(task, picture), true),
    discard: () => act(discard(site_id), true),
    forget: () => act(forgetResults(site_id), false),
    sendNow: () => parts.current.sender.wake(),
  };
}
