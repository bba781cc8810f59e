// Which trajectories are wanted; the address keeps it, so that a link shows the same list.
import { html, useState } from "../core/html.js";
import { Button, Field } from "../ui/parts.js";

/** What the address keeps. */
export const NAMES = ["device", "from", "to", "box", "sigma_mm"];

/** As GET /trajectories has it. */
export const parametersOf = ({ device, from, to, box, sigma_mm }) => ({
  device_id: device || null,
  from: from || null,
  to: to || null,
  bbox: box ? box.replace(/\s+/g, "") : null,
  max_sigma_m: sigma_mm ? Number(sigma_mm) / 1000 : null,
});

export function Filter({ wanted, onChoose }) {
  const [form, setForm] = useState(wanted);
  const set = (name, value) => setForm((before) => ({ ...before, [name]: value }));
  const typed = (name) => ({ value: form[name], onInput: (event) => set(name, event.target.value) });
  const moment = (name) => ({ type: "datetime-local", step: 1, value: localOf(form[name]), onInput: (event) => set(name, event.target.value && new Date(event.target.value).toISOString()) });
  const clear = () => onChoose(Object.fromEntries(NAMES.map((name) => [name, ""])));
  return html`<form class="filter card" role="search" aria-label="Filter" onSubmit=${(event) => { event.preventDefault(); onChoose(form); }}>
    <${Field} label="Device"><input ...${typed("device")} placeholder="any" /></${Field}>
    <${Field} label="From"><input ...${moment("from")} /></${Field}>
    <${Field} label="Before"><input ...${moment("to")} /></${Field}>
    <${Field} label="Through the box, m"><input ...${typed("box")} placeholder="x min, y min, x max, y max" /></${Field}>
    <${Field} label="Largest σ, mm"><input ...${typed("sigma_mm")} type="number" min="0.001" step="any" placeholder="any" /></${Field}>
    <div class="row"><${Button} type="submit" kind="primary">Filter</${Button}><${Button} onClick=${clear}>Clear</${Button}></div>
  </form>`;
}

/** ISO 8601 in UTC as the input wants it: the reader's own clock, to the second. */
function localOf(text) {
  if (!text) return "";
  const moment = new Date(text);
  return new Date(moment.getTime() - moment.getTimezoneOffset() * 60_000).toISOString().slice(0, 19);
}
