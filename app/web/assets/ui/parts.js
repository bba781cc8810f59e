// Parts that pages are made of. Their looks stand in style/parts.css.
import { sentence } from "../core/format.js";
import { html, useEffect, useMemo, useRef, useState } from "../core/html.js";

/** A button; `kind` is primary, danger or plain. */
export const Button = ({ kind = "", busy = false, children, ...rest }) =>
  html`<button type="button" class="button ${kind}" ...${rest} disabled=${busy || rest.disabled}>${busy && html`<${Busy} />`}${children}</button>`;

export const Busy = () => html`<span class="busy" role="status" aria-label="working"></span>`;

/** A message; `kind` is good, warn or bad. */
export const Notice = ({ kind = "", children }) => html`<div class="notice ${kind}" role=${kind === "bad" ? "alert" : "status"}>${children}</div>`;

/** What went wrong, in the server's own words, and what to do: try again, or go back to what is there. */
export const Failure = ({ error, retry }) =>
  error && html`<${Notice} kind="bad"><p>${sentence(error.message)}</p>${retry && (error.status === 404 ? html`<a class="button" href="#/">All sites</a>` : html`<${Button} onClick=${retry}>Try again</${Button}>`)}</${Notice}>`;

/** Children once the data is there; before that a sign of work, or what went wrong. */
export const Loaded = ({ of, children }) =>
  of.data === null ? (of.error ? html`<${Failure} error=${of.error} retry=${of.reload} />` : html`<p><${Busy} /> ${of.later ? "The server has much to do just now; it is asked again in a moment." : "loading"}</p>`)
    : html`<${Failure} error=${of.error} retry=${of.reload} />${children(of.data)}`;

/** A labelled input: give it the input as its child. */
export const Field = ({ label, hint, children }) =>
  html`<label class="field"><span>${label}</span>${children}${hint && html`<small>${hint}</small>`}</label>`;

export const Badge = ({ kind = "info", children }) => html`<span class="badge ${kind}">${children}</span>`;
export const Empty = ({ children }) => html`<div class="empty">${children}</div>`;

/** Pairs of a name and a value. */
export const Facts = ({ of }) => html`<dl class="facts">${of.map(([name, value]) => html`<dt>${name}</dt><dd>${value}</dd>`)}</dl>`;

/** A few large numbers: pairs of what it is and the number. */
export const Figures = ({ of }) => html`<div class="figures">${of.map(([name, value]) => html`<div class="figure"><b>${value}</b><span>${name}</span></div>`)}</div>`;

/** A modal dialog, open while it is shown; Escape closes it, and the focus goes back to where it was. */
export function Dialog({ title, onClose, children }) {
  const element = useRef(null);
  useEffect(() => {
    const [dialog, before] = [element.current, document.activeElement];
    dialog.showModal();
    dialog.querySelector("input, select, textarea")?.focus(); // the first thing to fill in, rather than the way out
    return () => { dialog.close(); before?.focus(); };
  }, []);
  return html`<dialog ref=${element} aria-label=${title} onCancel=${(event) => { event.preventDefault(); onClose(); }}>
    <div class="row spread"><h2 style=${{ margin: 0 }}>${title}</h2><${Button} kind="plain" aria-label="Close" onClick=${onClose}>✕</${Button}></div>
    ${children}
  </dialog>`;
}

/**
 * A table whose columns sort. A column is {key, label, value(row), show?(row), right?, kind?}: `right` for numbers, kind "name" for what people or files are called, "text" for sentences.
 * With `onPick` rows are chosen by click or Enter.
 */
export function Table({ columns, rows, keyOf, sortBy = null, descending = false, onPick, picked, caption }) {
  const [order, setOrder] = useState({ by: sortBy, descending });
  const sorted = useMemo(() => sortedRows(rows, columns.find((column) => column.key === order.by), order.descending), [rows, columns, order]);
  const turn = (key) => setOrder((before) => ({ by: key, descending: before.by === key ? !before.descending : false }));
  return html`<div class="scroll" tabindex="0" role="region" aria-label=${caption}><table class=${onPick ? "picked" : ""}>
    ${caption && html`<caption class="visually-hidden">${caption}</caption>`}
    <thead><tr>${columns.map((column) => html`<th scope="col" class=${column.right ? "right" : ""} aria-sort=${order.by === column.key ? (order.descending ? "descending" : "ascending") : null}>
      <button type="button" onClick=${() => turn(column.key)}>${column.label}</button></th>`)}</tr></thead>
    <tbody>${sorted.map((row) => html`<tr key=${keyOf(row)} aria-selected=${picked === keyOf(row) ? "true" : null} tabindex=${onPick ? 0 : null}
      onClick=${onPick && (() => onPick(row))} onKeyDown=${onPick && ((event) => event.key === "Enter" && onPick(row))}>
      ${columns.map((column) => html`<td class=${column.right ? "right number" : column.kind ?? ""}>${(column.show || column.value)(row)}</td>`)}</tr>`)}</tbody>
  </table></div>`;
}

function sortedRows(rows, column, descending) {
  if (!column) return rows;
  const sign = descending ? -1 : 1;
  const missing = (value) => value === null || value === undefined || Number.isNaN(value);
  return [...rows].sort((first, second) => {
    const [a, b] = [column.value(first), column.value(second)];
    if (missing(a) || missing(b)) return missing(a) - missing(b);
    return sign * (typeof a === "number" && typeof b === "number" ? a - b : String(a).localeCompare(String(b), "en", { numeric: true }));
  });
}

/** Files by picking or dropping; folders too, where the browser lets them. */
export function Drop({ accept, onFiles, folder = false, children, label }) {
  const [over, setOver] = useState(false);
  const input = useRef(null);
  const take = (event) => {
    event.preventDefault();
    setOver(false);
    filesOf(event.dataTransfer).then(onFiles);
  };
  return html`<div class="drop ${over ? "over" : ""}" onDragOver=${(event) => { event.preventDefault(); setOver(true); }} onDragLeave=${() => setOver(false)} onDrop=${take}>
    ${children}
    <input ref=${input} class="visually-hidden" tabindex="-1" type="file" multiple accept=${accept} webkitdirectory=${folder || null} aria-label=${label} onChange=${(event) => { onFiles([...event.target.files]); event.target.value = ""; }} />
    <${Button} onClick=${() => input.current.click()}>${label}</${Button}>
  </div>`;
}

/** All files of a drop, those in folders included. */
async function filesOf(transfer) {
  const entries = [...transfer.items].map((item) => item.webkitGetAsEntry?.()).filter(Boolean);
  if (!entries.length) return [...transfer.files];
  return (await Promise.all(entries.map(filesOfEntry))).flat();
}

async function filesOfEntry(entry) {
  if (entry.isFile) return [await new Promise((resolve, reject) => entry.file(resolve, reject))];
  const reader = entry.createReader();
  const found = [];
  for (;;) {
    const part = await new Promise((resolve, reject) => reader.readEntries(resolve, reject));
    if (!part.length) break;
    found.push(...part);
  }
  return (await Promise.all(found.map(filesOfEntry))).flat();
}
