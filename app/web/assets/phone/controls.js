// The buttons under the thumb: locate once, run, photographs of the phone's own camera app.
import { html, useRef, useState } from "../core/html.js";
import { Button, Field } from "../ui/parts.js";
import { Counts } from "./queue_panel.js";

const EVERY = "scattermark:every_s";
const BOUNDS_S = { min: 0.5, max: 60, step: 0.5 };
const NAMED = new Intl.DateTimeFormat("en-GB", { dateStyle: "medium", timeStyle: "short" });

/** Locate once, and begin or end a run. */
export function Bar({ ready, locating, run, counts, onLocate }) {
  return html`<div class="phone-bar" role="group" aria-label="Take pictures">
    ${run.going && html`<${Counts} of=${counts} />`}
    ${run.going
      ? html`<${Button} kind="danger" onClick=${run.end}>■ End the run</${Button}>`
      : html`<${Button} kind="primary" disabled=${!ready} busy=${locating} onClick=${onLocate}>Locate</${Button}>`}
  </div>`;
}

/** How the next run goes; or the one that is open since the page was closed. */
export function RunCard({ run, ready, counts, device_id }) {
  const [every_s, setEvery] = useState(localStorage.getItem(EVERY) ?? "1");
  const [name, setName] = useState("");
  const begin = (event) => {
    event.preventDefault();
    localStorage.setItem(EVERY, every_s);
    run.start({ name: name.trim() || `Walk of ${NAMED.format(new Date())}`, every_s: Number(every_s), device_id });
  };
  if (run.run) return html`<section class="card" aria-label="Run"><h2>${run.run.name}</h2>
    <p>A picture every ${run.run.every_s} s into one trajectory${run.skipped ? `; ${run.skipped} left out, as the one before was not ready` : ""}.</p>
    ${!run.going && html`<${Counts} of=${counts} />`}
    <div class="row">${run.going ? html`<${Button} onClick=${run.pause}>Pause</${Button}>` : html`<${Button} kind="primary" disabled=${!ready} onClick=${run.resume}>Go on</${Button}><${Button} kind="danger" onClick=${run.end}>End the run</${Button}>`}
      <a class="small" href=${`#/trajectories/${run.run.trajectory_id}`}>Trajectory</a></div></section>`;
  return html`<form class="card" aria-label="Run" onSubmit=${begin}><h2>Run</h2><div class="phone-run">
    <${Field} label="Every, s"><input type="number" inputmode="decimal" required ...${BOUNDS_S} value=${every_s} onInput=${(event) => setEvery(event.target.value)} /></${Field}>
    <${Field} label="Name"><input maxlength="100" placeholder="Walk of today" value=${name} onInput=${(event) => setName(event.target.value)} /></${Field}>
    <${Button} type="submit" disabled=${!ready}>▶ Start</${Button}></div></form>`;
}

/** Photographs as the phone's own camera app takes them: all pixels, and EXIF. */
export function Photographs({ onFiles }) {
  const input = useRef(null);
  return html`<section class="card" aria-label="Photographs"><h2>Photographs</h2>
    <p class="small muted">All pixels of the phone's own camera app; each is located at the time that its file tells.</p>
    <input ref=${input} class="visually-hidden" tabindex="-1" type="file" accept="image/*" capture="environment" multiple aria-label="Photographs to locate" onChange=${(event) => { onFiles([...event.target.files]); event.target.value = ""; }} />
    <${Button} onClick=${() => input.current.click()}>Take a photograph</${Button}></section>`;
}
