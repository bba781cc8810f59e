// Events that the service sends as they happen, over connections that break off, services that restart, keys that run out.
import { FULL, KEY_SHOWN, Problem, call } from "./api.js";

const AGAIN_AFTER_MS = 3000;
const LAST = "last_event_id"; // the parameter that says which events are known already
const WORTH_WAITING = [500, 502, ...FULL]; // the server is full or ill; any other problem stays

/**
 * Server-sent events until `close` is called or the server says that there are no more.
 * @param {string} path
 * @param {Record<string, (data: any) => void>} handlers by the events' names
 * @param {(connected: boolean) => void} [onConnection]
 * @returns {() => void} close
 */
export function listen(path, handlers, onConnection = () => {}) {
  const over = new AbortController();
  let [source, timer, last] = [null, 0, ""];
  const open = () => {
    if (over.signal.aborted) return;
    source = new EventSource(continued(path, last));
    for (const [name, handle] of Object.entries(handlers)) source.addEventListener(name, (event) => {
      if (event.data === undefined) return; // a lost connection is an "error" without data; the service may name an event of its own so, too
      last = event.lastEventId || last;
      handle(JSON.parse(event.data));
    });
    source.onopen = () => onConnection(true);
    source.onerror = (event) => {
      if (event.data !== undefined) return;
      onConnection(false);
      if (source.readyState === EventSource.CLOSED && !over.signal.aborted) askWhy();
    };
  };
  const wait = () => { timer = setTimeout(askWhy, AGAIN_AFTER_MS); };
  // Of an answer that is no stream a browser tells nothing and never asks again: a call does.
  const askWhy = () => streams(path, over.signal).then(open, (error) => {
    if (error.name === "AbortError") return;
    if (error.status === 401) addEventListener(KEY_SHOWN, open, { once: true, signal: over.signal });
    else if (!(error instanceof Problem) || WORTH_WAITING.includes(error.status)) wait();
  });
  open();
  return () => { over.abort(); clearTimeout(timer); source.close(); };
}

/** The stream from where it broke off, where its address can say that. */
function continued(path, last) {
  if (!last || !path.includes(`${LAST}=`)) return path;
  return path.replace(new RegExp(`${LAST}=[^&]*`), `${LAST}=${encodeURIComponent(last)}`);
}

/** Whether the service streams now; the answer itself is not read. */
async function streams(path, over) {
  const asked = new AbortController();
  const end = () => asked.abort();
  over.addEventListener("abort", end, { once: true });
  await call(path, { signal: asked.signal });
  end();
}
