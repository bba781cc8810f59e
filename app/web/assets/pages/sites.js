// All sites: list them, make one.
import { all, post } from "../core/api.js";
import { time } from "../core/format.js";
import { useAction, useLoaded } from "../core/hooks.js";
import { html, useState } from "../core/html.js";
import { go } from "../core/router.js";
import { may } from "../core/session.js";
import { Badge, Button, Dialog, Empty, Failure, Field, Loaded, Table } from "../ui/parts.js";

export default function Sites({ who }) {
  const sites = useLoaded(() => all("/sites", "sites"), []);
  const [making, setMaking] = useState(false);
  return html`<div class="row spread"><h1>Sites</h1>${may(who, "survey") && html`<${Button} kind="primary" onClick=${() => setMaking(true)}>New site</${Button}>`}</div>
    <${Loaded} of=${sites}>${(found) => (found.length ? html`<${SiteTable} sites=${found} />` : html`<${Empty}>No site yet. A site is a room or a building whose targets share one frame.</${Empty}>`)}</${Loaded}>
    ${making && html`<${NewSite} onClose=${() => setMaking(false)} />`}`;
}

const columns = [
  { key: "name", label: "Name", kind: "name", value: (site) => site.name, show: (site) => html`<a href=${`#/sites/${site.site_id}`}>${site.name}</a>` },
  { key: "map", label: "Target map", value: (site) => site.map_version, show: (site) => (site.map_version ? html`<${Badge} kind="good">version ${site.map_version}</${Badge}>` : html`<${Badge} kind="off">none yet</${Badge}>`) },
  { key: "family", label: "Codes", value: (site) => site.code_family },
  { key: "u", label: "Module u", right: true, value: (site) => site.plate_u_m, show: (site) => `${(1000 * site.plate_u_m).toFixed(1)} mm` },
  { key: "made", label: "Made", value: (site) => site.created_at, show: (site) => time(site.created_at) },
];

const SiteTable = ({ sites }) => html`<${Table} caption="Sites" columns=${columns} rows=${sites} keyOf=${(site) => site.site_id} sortBy="made" descending=${true} />`;

// Codes a family holds, and what a reader may do about dots that it cannot see well (docs: code families).
const FAMILIES = [
  ["golay", "golay: 728 targets, mends one misread dot or four hidden ones (recommended)"],
  ["hamming", "hamming: 6,560 targets, mends one misread or two hidden dots"],
  ["parity", "parity: 59,048 targets, notices one misread dot"],
  ["full", "full: 177,146 targets, notices nothing"],
];

function NewSite({ onClose }) {
  const [form, setForm] = useState({ name: "", code_family: "golay", u_mm: 14 });
  const change = (name) => (event) => setForm((before) => ({ ...before, [name]: event.target.value }));
  const making = useAction(async () => {
    const site = await post("/sites", { name: form.name, code_family: form.code_family, plate_u_m: Number(form.u_mm) / 1000 });
    go(`#/sites/${site.site_id}`);
  });
  return html`<${Dialog} title="New site" onClose=${onClose}>
    <form class="stack" onSubmit=${(event) => { event.preventDefault(); making.run(); }}>
      <${Failure} error=${making.error} />
      <${Field} label="Name"><input required maxlength="200" value=${form.name} onInput=${change("name")} placeholder="Lecture hall, ground floor" /></${Field}>
      <${Field} label="Code family" hint="It stands for the life of the site."><select value=${form.code_family} onChange=${change("code_family")}>
        ${FAMILIES.map(([name, label]) => html`<option value=${name}>${label}</option>`)}</select></${Field}>
      <${Field} label="Module u of the plates, mm" hint="A plate's side is 13 u: u = 14 mm fits A4, 20 mm A3, 9 mm A5.">
        <input type="number" required min="1" max="1000" step="0.1" value=${form.u_mm} onInput=${change("u_mm")} /></${Field}>
      <div class="row"><${Button} type="submit" kind="primary" busy=${making.busy}>Make the site</${Button}><${Button} onClick=${onClose}>Cancel</${Button}></div>
    </form>
  </${Dialog}>`;
}
