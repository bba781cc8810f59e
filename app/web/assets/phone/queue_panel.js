// What waits on this phone, how its sending stands, and what to do about it.
import { count, plural } from "../core/format.js";
import { html, useEffect, useState } from "../core/html.js";
import { Badge, Button, Dialog, Notice } from "../ui/parts.js";

const CLOCK = new Intl.DateTimeFormat(undefined, { timeStyle: "medium" });

/** Sent, located, failed and waiting, of one trajectory or of all that is kept. */
export function countsOf({ tasks, results }, trajectory_id = null) {
  const ours = (item) => item.kind === "locate" && (!trajectory_id || item.trajectory_id === trajectory_id);
  const sent = results.filter(ours);
  const located = sent.filter((item) => item.answer).length;
  return { sent: sent.length, located, failed: sent.length - located, waiting: tasks.filter(ours).length };
}

export const Counts = ({ of }) => html`<dl class="phone-counts">${["sent", "located", "failed", "waiting"].map((name) => html`<div class=${of[name] ? name : ""}><dd>${count(of[name])}</dd><dt>${name}</dt></div>`)}</dl>`;

export function QueuePanel({ queue }) {
  const [sure, setSure] = useState(false);
  const waiting = queue.tasks.filter((task) => task.kind === "locate");
  const oldest = waiting[0];
  const others = queue.tasks.length - waiting.length;
  return html`<section class="card" aria-label="Queue"><div class="row spread"><h2>Queue</h2><${State} standing=${queue.standing} waiting=${queue.tasks.length} /></div>
    ${queue.error && html`<${Notice} kind="bad"><p>This browser keeps no pictures (${queue.error.message}): they cannot wait here, and are lost without a network. A private window may be the cause.</p></${Notice}>`}
    <p role="status">${oldest ? `${plural(waiting.length, "picture")} waiting, the oldest of ${CLOCK.format(oldest.captured_ms)}.` : !queue.loaded ? "Looking what waits …" : others ? "A trajectory waits to be told to the service." : "Nothing waits: all pictures are sent."}</p>
    ${queue.standing.error && queue.tasks.length > 0 && html`<p class="small">${queue.standing.error.message}</p>`}
    <div class="row">
      ${queue.tasks.length > 0 && html`<${Button} onClick=${queue.sendNow}>Send now</${Button}>`}
      ${oldest && html`<${Button} kind="danger" onClick=${() => setSure(true)}>Discard</${Button}>`}
      ${!oldest && queue.results.length > 0 && html`<${Button} kind="plain" onClick=${queue.forget}>Clear the way shown</${Button}>`}</div>
    ${sure && html`<${Dialog} title="Discard what waits" onClose=${() => setSure(false)}>
      <p>${plural(waiting.length, "picture")} taken here and not sent yet will be gone for good.</p>
      <${Button} kind="danger" onClick=${() => { queue.discard(); setSure(false); }}>Discard for good</${Button}></${Dialog}>`}
  </section>`;
}

function State({ standing: { state, again_ms, error }, waiting }) {
  const online = useOnline();
  if (!online) return html`<${Badge} kind="warn">offline</${Badge}>`;
  if (state === "key") return html`<${Badge} kind="bad">${error.status === 403 ? "this key may not locate" : "key needed"}</${Badge}>`;
  if (state === "pausing") return html`<${Badge} kind="warn">tries again at ${CLOCK.format(again_ms)}</${Badge}>`;
  return waiting ? html`<${Badge} kind="info">sending</${Badge}>` : html`<${Badge} kind="good">online</${Badge}>`;
}

/** Whether the browser believes that there is a network. */
function useOnline() {
  const [online, setOnline] = useState(navigator.onLine);
  useEffect(() => {
    const look = () => setOnline(navigator.onLine);
    addEventListener("online", look);
    addEventListener("offline", look);
    return () => { removeEventListener("online", look); removeEventListener("offline", look); };
  }, []);
  return online;
}
