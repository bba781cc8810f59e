// Evaluations of a site: systems' files come in, are compared with a reference, and what came out is kept.
import { all } from "../core/api.js";
import { count, metres, time } from "../core/format.js";
import { useLoaded } from "../core/hooks.js";
import { html, useState } from "../core/html.js";
import { Compare } from "../evaluations/compare.js";
import { Lives } from "../evaluations/lives.js";
import { TakeIn } from "../evaluations/take_in.js";
import { Empty, Loaded, Table } from "../ui/parts.js";

export default function Evaluations({ site, query }) {
  const trajectories = useLoaded(() => all("/trajectories", "trajectories", { site_id: site }), [site]);
  const evaluations = useLoaded(() => all("/evaluations", "evaluations", { site_id: site }), [site]);
  const [chosen, setChosen] = useState([]);
  const onTaken = (trajectory_id) => { setChosen((before) => [...before, trajectory_id]); trajectories.reload(); };
  return html`<h1>Evaluations</h1>
    <div class="take-columns"><${TakeIn} site=${site} onTaken=${onTaken} />
      <${Loaded} of=${trajectories}>${(found) => html`<${Compare} trajectories=${found} reference=${query.reference} chosen=${chosen} onChosen=${setChosen} />`}</${Loaded}></div>
    <h2>Made so far</h2>
    <${Loaded} of=${evaluations}>${(found) => (found.length
      ? html`<${Table} caption="Evaluations" columns=${columns} rows=${found} keyOf=${(item) => item.evaluation_id} sortBy="made" descending=${true} />`
      : html`<${Empty}>No evaluation yet.</${Empty}>`)}</${Loaded}>
    <${Lives} site=${site} trajectories=${trajectories.data ?? []} />`;
}

const ofSystems = (item, show) => item.systems.map((system) => html`<div>${show(system)}</div>`);

const columns = [
  { key: "title", label: "Title", kind: "name", value: (item) => item.title, show: (item) => html`<a href=${`#/evaluations/${item.evaluation_id}`}>${item.title}</a>` },
  { key: "reference", label: "Reference", kind: "name", value: (item) => item.reference_name },
  { key: "systems", label: "Systems", kind: "name", value: (item) => item.systems.length, show: (item) => ofSystems(item, (system) => system.name) },
  { key: "pairs", label: "Pairs", right: true, value: (item) => item.systems[0]?.pairs, show: (item) => ofSystems(item, (system) => count(system.pairs)) },
  { key: "rms", label: "RMS in space", right: true, value: (item) => item.systems[0]?.rms_m, show: (item) => ofSystems(item, (system) => metres(system.rms_m, 4)) },
  { key: "ce95", label: "CE95", right: true, value: (item) => item.systems[0]?.CE95_m, show: (item) => ofSystems(item, (system) => metres(system.CE95_m, 4)) },
  { key: "made", label: "Made", value: (item) => item.created_at, show: (item) => time(item.created_at) },
];
