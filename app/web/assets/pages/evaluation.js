// One evaluation: what it comes to, where and when errors are large, who is better, and its report.
import { get, remove } from "../core/api.js";
import { metres, plural, time } from "../core/format.js";
import { useAction, useLoaded } from "../core/hooks.js";
import { html, useMemo, useState } from "../core/html.js";
import { amend, go } from "../core/router.js";
import { Differences, Verdicts } from "../evaluations/comparison.js";
import { Distribution, OverTime } from "../evaluations/error_charts.js";
import { ErrorPlan } from "../evaluations/error_plan.js";
import { Metrics } from "../evaluations/metrics.js";
import { optionsText } from "../evaluations/options_text.js";
import { pairsOf, SIZES } from "../evaluations/systems.js";
import { roomOf } from "../plan/room.js";
import { Button, Dialog, Facts, Failure, Figures, Loaded } from "../ui/parts.js";
import { useShared } from "../ui/shared_value.js";

const LONGER = [1, 2, 5, 10, 50, 100, 1000];
const COLOURS = { system: "by system", error: "by error" };

export default function Evaluation({ evaluation: evaluation_id, query }) {
  const loaded = useLoaded(async (signal) => {
    const told = await get(`/evaluations/${evaluation_id}`, { signal });
    return { told, room: await roomOf(told.site_id, signal) };
  }, [evaluation_id]);
  return html`<${Loaded} of=${loaded}>${({ told, room }) => html`<${Told} told=${told} room=${room} query=${query} />`}</${Loaded}>`;
}

function Told({ told, room, query }) {
  const systems = useMemo(() => told.systems.map((system, index) => ({ ...system, index, pairs: pairsOf(system) })), [told]);
  return html`<${Heading} told=${told} site=${room.site} />
    ${systems.length === 1 && html`<${Headline} metrics=${systems[0].metrics} />`}
    <${Verdicts} systems=${systems} />
    <${Plots} systems=${systems} room=${room} query=${query} />
    <section><h2>Metrics</h2><${Metrics} systems=${systems} /></section>
    <${Differences} differences=${told.differences} />
    <details><summary>Options it was made with</summary><${Facts} of=${optionsText(told.options)} /></details>`;
}

function Heading({ told, site }) {
  const [sure, setSure] = useState(false);
  const deleting = useAction(async () => { await remove(`/evaluations/${told.evaluation_id}`); go(`#/sites/${told.site_id}/evaluations`); });
  const reference = told.reference_id ? html`<a href=${`#/trajectories/${told.reference_id}`}>${told.reference_name}</a>` : told.reference_name;
  return html`<p class="crumbs"><a href=${`#/sites/${told.site_id}`}>${site.name}</a> › <a href=${`#/sites/${told.site_id}/evaluations`}>Evaluations</a></p>
    <div class="row spread"><h1>${told.title}</h1><div class="row">
      ${["html", "pdf", "zip"].map((kind) => html`<a class="button" href=${told.plots[kind]} target=${kind === "html" ? "_blank" : null} download=${kind === "html" ? null : ""}>${kind === "html" ? "Report" : kind.toUpperCase()}</a>`)}
      <${Button} kind="danger" onClick=${() => setSure(true)}>Delete</${Button}></div></div>
    <p class="muted">${plural(told.systems.length, "system")} beside ${reference}, ${time(told.created_at)}. This page's address is its permalink.</p>
    ${sure && html`<${Dialog} title="Delete the evaluation" onClose=${() => setSure(false)}><p>Its trajectories stay.</p><${Failure} error=${deleting.error} /><${Button} kind="danger" busy=${deleting.busy} onClick=${deleting.run}>Delete it</${Button}></${Dialog}>`}`;
}

const Headline = ({ metrics: { accuracy, intervals_m, pairs } }) => html`<${Figures} of=${[
  ["RMS in space", metres(intervals_m.rms?.value ?? accuracy.spatial_m.rms, 4)], ["RMS in the plan", metres(accuracy.horizontal_m.rms, 4)], ["CE50", metres(accuracy.CE50_m, 4)], ["CE95", metres(accuracy.CE95_m, 4)], ["pairs", pairs.toLocaleString("en")]]} />`;

/** How a reader wants to see errors; the address keeps it. */
function useChoice(query, systems) {
  const hidden = (query.hidden ?? "").split(",").filter(Boolean).map(Number);
  const [choice, setChoice] = useState({ size: query.size in SIZES ? query.size : "plan", by: query.colour in COLOURS ? query.colour : systems.length > 1 ? "system" : "error", times: Number(query.times) || 1, hidden });
  const choose = (change) => {
    const next = { ...choice, ...change };
    setChoice(next);
    amend({ size: next.size, colour: next.by, times: next.times, hidden: next.hidden.join(",") });
  };
  return [choice, choose];
}

function Plots({ systems, room, query }) {
  const [{ size, by, times, hidden }, choose] = useChoice(query, systems);
  const [pointer, range] = [useShared(), useShared()];
  const shown = useMemo(() => systems.filter((system) => !hidden.includes(system.index)), [systems, String(hidden)]);
  const toggle = (index) => choose({ hidden: hidden.includes(index) ? hidden.filter((other) => other !== index) : [...hidden, index] });
  const thinned = systems.some((system) => system.series.every > 1);
  return html`<div class="row choices">
      <label class="row small">Error <select class="input narrow" value=${size} onChange=${(event) => choose({ size: event.target.value })}>${Object.entries(SIZES).map(([name, { label }]) => html`<option value=${name}>${label}</option>`)}</select></label>
      <label class="row small">Colours <select class="input narrow" value=${by} onChange=${(event) => choose({ by: event.target.value })}>${Object.entries(COLOURS).map(([name, label]) => html`<option value=${name}>${label}</option>`)}</select></label>
      <label class="row small">Arrows <select class="input narrow" value=${times} onChange=${(event) => choose({ times: Number(event.target.value) })}>${LONGER.map((factor) => html`<option value=${factor}>${factor} ×</option>`)}</select></label>
      ${systems.length > 1 && systems.map((system) => html`<label class="row small"><input type="checkbox" checked=${!hidden.includes(system.index)} onChange=${() => toggle(system.index)} /><span class=${`swatch series-${(system.index % 6) + 1}`}></span>${system.name}</label>`)}
    </div>
    <div class="plots"><section class="card" aria-label="Errors on the plan"><h2>On the plan</h2><${ErrorPlan} systems=${shown} size=${size} by=${by} times=${times} room=${room} pointer=${pointer} /></section>
      <section class="card" aria-label="Distribution"><h2>Distribution</h2><${Distribution} systems=${shown} size=${size} /></section></div>
    <section class="card" aria-label="Error over time"><h2>Over time</h2><${OverTime} systems=${shown} size=${size} range=${range} />
      ${thinned && html`<p class="small muted">Plots show every n-th pair; the metrics rest on all, and the zip holds them.</p>`}</section>`;
}
