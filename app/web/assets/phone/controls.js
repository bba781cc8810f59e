// What one takes pictures with: the buttons under the thumb, how runs go, photographs of the phone's own camera app.
import { html, useRef, useState } from "../core/html.js";
import { Button, Field } from "../ui/parts.js";
import { Counts } from "./queue_panel.js";

const EVERY = "scattermark:every_s";
const BOUNDS_S = { min: 0.5, max: 60, step: 0.5 };
const NAMED = new Intl.DateTimeFormat("en-GB", { dateStyle: "medium", timeStyle: "short" });

/** How the next run shall go: how often is remembered, its name is the run's own. */
export function useWish() {
  const [every, setEvery] = useState(localStorage.getItem(EVERY) ?? "1");
  const [name, setName] = useState("");
  const within = Math.min(Math.max(Number(every) || 1, BOUNDS_S.min), BOUNDS_S.max);
  return {
    every, name, setEvery, setName,
    told: () => {
      localStorage.setItem(EVERY, String(within));
      return { every_s: within, name: name.trim() || `Walk of ${NAMED.format(new Date())}` };
    },
  };
}

/** Locate once, or begin, rest and end a run. */
export function Bar({ ready, taking, run, counts, onRun }) {
  return html`<div class="phone-bar" role="group" aria-label="Take pictures">
    ${run.run && html`<${Counts} of=${counts} />`}
    <div class="phone-buttons">${!run.run
      ? html`<${Button} kind="primary" disabled=${!ready} busy=${taking.busy} onClick=${() => taking.run()}>Locate</${Button}><${Button} disabled=${!ready || run.busy} onClick=${onRun}>Start run</${Button}>`
      : html`${run.going ? html`<${Button} onClick=${run.pause}>Pause</${Button}>` : html`<${Button} kind="primary" disabled=${!ready || run.busy} onClick=${run.resume}>Go on</${Button}>`}<${Button} kind="danger" disabled=${run.busy} onClick=${run.end}>End run</${Button}>`}</div>
  </div>`;
}

/** How the next run goes; or the one that is open, maybe since before the page was closed. */
export function RunCard({ run, skipped, wish, analyst }) {
  if (run) return html`<section class="card" aria-label="Run"><h2>${run.name}</h2>
    <p class="small">A picture every ${run.every_s} s into one trajectory${skipped ? `; ${skipped} left out, as the one before was not ready` : ""}.</p>
    ${analyst && html`<a class="small" href=${`#/trajectories/${run.trajectory_id}`}>Its trajectory</a>`}</section>`;
  return html`<section class="card" aria-label="Run"><h2>Run</h2><div class="phone-run">
    <${Field} label="Every, s"><input type="number" inputmode="decimal" ...${BOUNDS_S} value=${wish.every} onInput=${(event) => wish.setEvery(event.target.value)} /></${Field}>
    <${Field} label="Name"><input maxlength="100" placeholder="Walk of today" value=${wish.name} onInput=${(event) => wish.setName(event.target.value)} /></${Field}></div></section>`;
}

/** Photographs as the phone's own camera app takes them: all pixels, and EXIF. */
export function Photographs({ onFiles }) {
  const input = useRef(null);
  return html`<section class="card" aria-label="Photographs"><h2>Photographs</h2>
    <p class="small muted">All pixels of the phone's own camera app; each is located at the time that its file tells.</p>
    <input ref=${input} class="visually-hidden" tabindex="-1" type="file" accept="image/*" capture="environment" multiple aria-label="Photographs to locate" onChange=${(event) => { onFiles([...event.target.files]); event.target.value = ""; }} />
    <${Button} onClick=${() => input.current.click()}>Take a photograph</${Button}></section>`;
}
