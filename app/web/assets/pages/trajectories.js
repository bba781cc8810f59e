// The trajectories of a site: those that phones walked and those that came as files, found by device, time, place, uncertainty.
import { all } from "../core/api.js";
import { count, time } from "../core/format.js";
import { useLoaded } from "../core/hooks.js";
import { html, useState } from "../core/html.js";
import { amend } from "../core/router.js";
import { Badge, Empty, Loaded, Table } from "../ui/parts.js";
import { duration, nameOf, reasonsText } from "../trajectories/texts.js";
import { Filter, NAMES, parametersOf } from "../trajectories/filter.js";

export default function Trajectories({ site, query }) {
  const [wanted, setWanted] = useState(Object.fromEntries(NAMES.map((name) => [name, query[name] ?? ""])));
  const found = useLoaded(() => all("/trajectories", "trajectories", { site_id: site, ...parametersOf(wanted) }), [site, JSON.stringify(wanted)]);
  const choose = (next) => { amend(next); setWanted(next); };
  const narrowed = Object.values(wanted).some(Boolean);
  return html`<h1>Trajectories</h1>
    <${Filter} key=${JSON.stringify(wanted)} wanted=${wanted} onChoose=${choose} />
    <${Loaded} of=${found}>${(listed) => (listed.length
      ? html`<${Table} caption="Trajectories" columns=${columns} rows=${listed} keyOf=${(item) => item.trajectory_id} sortBy="first" descending=${true} />`
      : html`<${Empty}>${narrowed ? "No trajectory has a snapshot that fits all of this." : "No trajectory yet. A phone opens one when it locates; files of other systems come in under Evaluations."}</${Empty}>`)}</${Loaded}>`;
}

const columns = [
  { key: "name", label: "Name", kind: "name", value: nameOf, show: (item) => html`<a href=${`#/trajectories/${item.trajectory_id}`}>${nameOf(item)}</a>` },
  { key: "device", label: "Device", kind: "name", value: (item) => item.device_id, show: (item) => item.device_id ?? "–" },
  { key: "state", label: "State", value: stateOf, show: (item) => html`<${Badge} kind=${{ open: "good", closed: "off" }[stateOf(item)] ?? "info"}>${stateOf(item)}</${Badge}>` },
  { key: "poses", label: "Poses", right: true, value: (item) => item.pose_count, show: (item) => count(item.pose_count) },
  { key: "failures", label: "Failures", value: (item) => item.failure_count, show: (item) => reasonsText(item.failures_by_reason) },
  { key: "first", label: "First", value: (item) => item.first_at, show: (item) => time(item.first_at) },
  { key: "lasts", label: "Lasts", right: true, value: (item) => Date.parse(item.last_at) - Date.parse(item.first_at), show: (item) => duration(item.first_at, item.last_at) },
];

function stateOf(item) {
  return item.source ? `from ${item.source.format}` : item.closed_at ? "closed" : "open";
}
