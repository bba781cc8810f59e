// Live evaluations of a site: those that run, those that ran, a new one.
import { all, post } from "../core/api.js";
import { count, time } from "../core/format.js";
import { useAction, useLoaded } from "../core/hooks.js";
import { html, useState } from "../core/html.js";
import { go } from "../core/router.js";
import { nameOf } from "../trajectories/texts.js";
import { Badge, Button, Empty, Failure, Field, Loaded, Table } from "../ui/parts.js";

const ALIGNMENTS = { none: "none", posyaw: "heading and shift", se3: "rotation and shift", sim3: "rotation, shift and scale" };

/** @param {{site: string, trajectories: object[]}} given */
export function Lives({ site, trajectories }) {
  const lives = useLoaded(() => all("/evaluations/live", "live_evaluations", { site_id: site }), [site]);
  return html`<h2>Live</h2><p class="muted">A running system sends its positions while the phone beside it is being located.</p>
    <${Loaded} of=${lives}>${(found) => (found.length ? html`<${Table} caption="Live evaluations" columns=${columns} rows=${found} keyOf=${(item) => item.live_id} sortBy="made" descending=${true} />` : html`<${Empty}>None yet.</${Empty}>`)}</${Loaded}>
    <${NewLive} references=${trajectories.filter((item) => !item.source && !item.closed_at)} />`;
}

const columns = [
  { key: "name", label: "System", kind: "name", value: (item) => item.name, show: (item) => html`<a href=${`#/evaluations/live/${item.live_id}`}>${item.name || "unnamed"}</a>` },
  { key: "state", label: "State", value: (item) => item.closed_at, show: (item) => (item.closed_at ? html`<${Badge} kind="off">closed</${Badge}>` : html`<${Badge} kind="good">running</${Badge}>`) },
  { key: "count", label: "Samples", right: true, value: (item) => item.count, show: (item) => count(item.count) },
  { key: "matched", label: "Matched", right: true, value: (item) => item.matched, show: (item) => count(item.matched) },
  { key: "made", label: "Opened", value: (item) => item.created_at, show: (item) => time(item.created_at) },
];

function NewLive({ references }) {
  const [form, setForm] = useState({ name: "", reference: "", alignment: "none" });
  const change = (name) => (event) => setForm((before) => ({ ...before, [name]: event.target.value }));
  const opening = useAction(async () => {
    const live = await post("/evaluations/live", { reference_id: form.reference || references[0].trajectory_id, name: form.name || null, options: { alignment: form.alignment } });
    go(`#/evaluations/live/${live.live_id}`);
  });
  if (!references.length) return html`<p class="small muted">A live evaluation needs a trajectory that is open: let a phone begin one.</p>`;
  return html`<details class="card"><summary>Open a live evaluation</summary><form class="stack" onSubmit=${(event) => { event.preventDefault(); opening.run(); }}>
    <${Failure} error=${opening.error} /><div class="columns">
    <${Field} label="System"><input maxlength="200" value=${form.name} onInput=${change("name")} /></${Field}>
    <${Field} label="Trajectory of the phone"><select value=${form.reference} onChange=${change("reference")}>${references.map((item) => html`<option value=${item.trajectory_id}>${nameOf(item)}</option>`)}</select></${Field}>
    <${Field} label="Alignment of the pairs so far"><select value=${form.alignment} onChange=${change("alignment")}>${Object.entries(ALIGNMENTS).map(([value, label]) => html`<option value=${value}>${label}</option>`)}</select></${Field}></div>
    <div><${Button} type="submit" kind="primary" busy=${opening.busy}>Open it</${Button}></div></form></details>`;
}
