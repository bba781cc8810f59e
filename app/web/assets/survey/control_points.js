// Control and check points: typed, pasted from a spreadsheet or dropped as a file; checked at once, then by the server.
import { get, put } from "../core/api.js";
import { useAction, useLoaded } from "../core/hooks.js";
import { html, useEffect, useMemo, useRef, useState } from "../core/html.js";
import { Button, Drop, Failure, Loaded, Notice } from "../ui/parts.js";
import { COLUMNS, checkRows, emptyRow, isEmpty, judgeDatum, readRows, recordOf, rowOfRecord } from "./control_rows.js";
import { draftOf, keepDraft } from "./draft.js";

const MOST_SHOWN = 200; // rows with inputs; more are kept and sent
const MOST_FAULTS = 6;

export function ControlPoints({ site, onStored }) {
  const path = `/sites/${site.site_id}/control-points`;
  const stored = useLoaded(() => get(path), [path]);
  useEffect(() => { if (stored.data) onStored(stored.data.control_points); }, [stored.data]);
  return html`<section class="card" aria-label="Control points"><h2>Control points</h2>
    <p class="small muted">Dots whose coordinates a tachymeter or a tape gave. <em>Control</em> points fix the frame; <em>check</em> points take no part and judge it. A dot is A ... E (the red ones, clockwise from the top left, E in the middle), r0c0 ... r3c3, or centre.</p>
    <${Loaded} of=${stored}>${(found) => html`<${Editor} site=${site} path=${path} points=${found.control_points} onSaved=${stored.reload} />`}</${Loaded}>
  </section>`;
}

function Editor({ site, path, points, onSaved }) {
  const [rows, setRows] = useState(() => draftOf(site.site_id) ?? points.map(rowOfRecord));
  const [told, setTold] = useState([]);
  const filled = rows.filter((row) => !isEmpty(row));
  const faults = useMemo(() => checkRows(filled, site.code_family), [rows]);
  const datum = judgeDatum(filled);
  const changed = JSON.stringify(filled) !== JSON.stringify(points.map(rowOfRecord));
  useEffect(() => keepDraft(site.site_id, changed ? rows : null), [rows, changed]);
  const sent = useRef(null);
  useEffect(() => { setRows((now) => (now === sent.current ? points.map(rowOfRecord) : now)); setTold([]); }, [points]); // what was typed while others were stored stays
  const saving = useAction(async () => { sent.current = rows; await put(path, { body: JSON.stringify(filled.map(recordOf)), headers: { "Content-Type": "application/json" } }); onSaved(); });
  const take = (text, replace) => { const read = readRows(text); setRows((before) => [...(replace ? [] : before.filter((row) => !isEmpty(row))), ...read.rows]); setTold(read.problems); };
  const onPaste = (event) => { const text = event.clipboardData.getData("text"); if (/[\t\n\r;]|(,.*){3}/.test(text)) { event.preventDefault(); take(text, false); } };
  return html`<div class="stack" onPaste=${onPaste}>
    <${Grid} rows=${rows} faults=${faults} onChange=${setRows} />
    <div class="row"><${Button} onClick=${() => setRows((before) => [...before, emptyRow()])}>Add a point</${Button}>
      ${rows.length > 0 && html`<${Button} kind="plain" onClick=${() => setRows([])}>Clear</${Button}>`}</div>
    <${Paste} onText=${take} />
    ${told.map((text) => html`<${Notice} kind="warn">${text}</${Notice}>`)}
    <${Faults} faults=${faults} />
    <${Notice} kind=${datum.kind}>${datum.text}</${Notice}>
    <${Failure} error=${saving.error} />
    <div class="row"><${Button} kind=${changed ? "primary" : ""} busy=${saving.busy} disabled=${!changed || faults.length > 0 || datum.kind === "bad"} onClick=${saving.run}>Save the points</${Button}>
      <span class="small muted" role="status">${changed ? "not saved yet" : filled.length ? "saved" : ""}</span></div>
  </div>`;
}

function Paste({ onText }) {
  const onFiles = async ([file]) => { if (file) onText(await file.text(), true); };
  return html`<${Drop} accept=".csv,.txt,.tsv,text/csv,text/plain" onFiles=${onFiles} label="Choose a CSV file">
    <label class="field"><span>Paste cells of a spreadsheet here, or drop a CSV file</span>
      <textarea class="paste" rows="2" placeholder=${COLUMNS.join("\t")} onChange=${(event) => { if (event.target.value.trim()) onText(event.target.value, false); event.target.value = ""; }}></textarea></label>
  </${Drop}>`;
}

function Grid({ rows, faults, onChange }) {
  if (!rows.length) return null;
  const faultOf = (row, column) => faults.find((fault) => fault.row === row && fault.column === column)?.problem;
  const set = (index, column, value) => onChange((before) => before.map((row, at) => (at === index ? { ...row, [column]: value } : row)));
  return html`<div class="scroll" tabindex="0" role="region" aria-label="Points"><table class="grid"><thead><tr>${COLUMNS.map((column) => html`<th scope="col">${column}</th>`)}<th><span class="visually-hidden">Remove</span></th></tr></thead>
    <tbody>${rows.slice(0, MOST_SHOWN).map((row, index) => html`<tr key=${index}>
      ${COLUMNS.map((column) => html`<td><${Cell} column=${column} row=${index} value=${row[column]} fault=${isEmpty(row) ? null : faultOf(index, column)} onValue=${(value) => set(index, column, value)} /></td>`)}
      <td><${Button} kind="plain" aria-label=${`Remove row ${index + 1}`} onClick=${() => onChange((before) => before.filter((_, at) => at !== index))}>✕</${Button}></td></tr>`)}</tbody></table></div>
    ${rows.length > MOST_SHOWN && html`<p class="small muted">and ${rows.length - MOST_SHOWN} more rows, which are checked and saved with these</p>`}`;
}

function Cell({ column, row, value, fault, onValue }) {
  const given = { "aria-label": `${column} of row ${row + 1}`, "aria-invalid": fault ? "true" : null, title: fault ?? null, value };
  if (column === "role") return html`<select ...${given} onChange=${(event) => onValue(event.target.value)}>${["control", "check"].includes(value) ? null : html`<option>${value}</option>`}<option>control</option><option>check</option></select>`;
  return html`<input class=${`cell ${column}`} ...${given} inputmode=${column.endsWith("_m") || column === "code" ? "decimal" : null} onInput=${(event) => onValue(event.target.value)} />`;
}

const Faults = ({ faults }) => faults.length > 0 && html`<${Notice} kind="bad"><ul class="plain">
  ${faults.slice(0, MOST_FAULTS).map((fault) => html`<li>Row ${fault.row + 1}, ${fault.column}: ${fault.problem}</li>`)}
  ${faults.length > MOST_FAULTS && html`<li>and ${faults.length - MOST_FAULTS} more</li>`}</ul></${Notice}>`;
