// Files of systems under test come in; what was found in each is said, or which line and column was not understood.
import { post } from "../core/api.js";
import { count } from "../core/format.js";
import { html, useState } from "../core/html.js";
import { Busy, Drop, Field, Notice } from "../ui/parts.js";

const FORMATS = ["csv", "tum", "euroc", "kitti", "evaal", "geojson", "geopose"];
const UNITS = [["s", "seconds"], ["ms", "milliseconds"], ["us", "microseconds"], ["ns", "nanoseconds"]];
const ACCEPT = ".csv,.txt,.tum,.log,.json,.geojson,.times,text/plain,application/json";

/** @param {{site: string, onTaken: (trajectory_id: string) => void}} given */
export function TakeIn({ site, onTaken }) {
  const [form, setForm] = useState({ name: "", format: "", time_unit: "", times: null });
  const [results, setResults] = useState([]);
  const [busy, setBusy] = useState(0);
  const change = (name) => (event) => setForm((before) => ({ ...before, [name]: event.target.value }));
  const take = async (files) => {
    for (const file of files) {
      setBusy((before) => before + 1);
      const result = await taken(site, file, form, files.length > 1);
      setBusy((before) => before - 1);
      setResults((before) => [result, ...before]);
      if (result.answer) onTaken(result.answer.trajectory_id);
    }
  };
  return html`<section class="card" aria-label="Take in a system's output"><h2>Take in a system's output</h2>
    <p class="muted small">A file is taken as a whole or not at all. What it is, and in which unit its stamps count, is found out and said: look whether it is what you meant. A clock that is off is set right in the comparison.</p>
    <div class="columns"><${Field} label="Name" hint="Otherwise the file's own."><input maxlength="200" value=${form.name} onInput=${change("name")} /></${Field}>
      <${Field} label="Format"><select value=${form.format} onChange=${change("format")}><option value="">seen in the file</option>${FORMATS.map((format) => html`<option>${format}</option>`)}</select></${Field}>
      <${Field} label="Unit of the stamps"><select value=${form.time_unit} onChange=${change("time_unit")}><option value="">seen in the file</option>${UNITS.map(([unit, label]) => html`<option value=${unit}>${label}</option>`)}</select></${Field}>
      ${form.format === "kitti" && html`<${Field} label="KITTI's stamps (times.txt)"><input type="file" onChange=${(event) => setForm((before) => ({ ...before, times: event.target.files[0] ?? null }))} /></${Field}>`}</div>
    <${Drop} accept=${ACCEPT} label="Choose files" onFiles=${take}><p>Drop files here: CSV, TUM, EuRoC, KITTI, EvAAL, GeoJSON, GeoPose.</p></${Drop}>
    <div class="results" aria-live="polite">${busy > 0 && html`<p><${Busy} /> reading</p>`}${results.map((result) => html`<${Result} result=${result} />`)}</div>
  </section>`;
}

/** What became of a file: an answer or an error. */
async function taken(site, file, form, several) {
  const body = new FormData();
  body.set("site_id", site);
  body.set("name", (!several && form.name) || file.name.replace(/\.[^.]*$/, ""));
  if (form.format) body.set("format", form.format);
  if (form.time_unit) body.set("time_unit", form.time_unit);
  body.set("file", file);
  if (form.format === "kitti" && form.times) body.set("times", form.times);
  try {
    return { name: file.name, answer: await post("/trajectories/import", undefined, { body }) };
  } catch (error) {
    return { name: file.name, error };
  }
}

const Result = ({ result: { name, answer, error } }) => (error
  ? html`<${Notice} kind="bad"><p><b>${name}</b>: ${error.message}</p></${Notice}>`
  : html`<${Notice} kind="good"><p><b>${name}</b>: ${count(answer.poses)} poses, format ${answer.format}, stamps in ${answer.time_unit}; ${answer.note}. <a href=${`#/trajectories/${answer.trajectory_id}`}>Look at it</a></p></${Notice}>`);
