// A live evaluation as it runs: the error so far, pair by pair.
import { address, get, post } from "../core/api.js";
import { count, metres, number } from "../core/format.js";
import { useAction, useLoaded } from "../core/hooks.js";
import { html, useEffect, useMemo, useState } from "../core/html.js";
import { go } from "../core/router.js";
import { listen } from "../core/listen.js";
import { Chart } from "../ui/chart.js";
import { Badge, Button, Empty, Failure, Figures, Loaded } from "../ui/parts.js";
import { SiteCrumb } from "../ui/site_crumb.js";
import { colour, seriesColour } from "../ui/theme.js";

const CHART_PX = 300;
const GATHERED_MS = 200; // pairs of a moment are shown together

export default function LiveEvaluation({ live: live_id }) {
  const state = useLoaded((signal) => get(`/evaluations/live/${live_id}`, { signal }), [live_id]);
  return html`<${Loaded} of=${state}>${(found) => html`<${Running} live=${found} onChange=${state.reload} />`}</${Loaded}>`;
}

/** All pairs from the first one on, as events tell them; a lost connection goes on where it broke off. */
function useErrors(live_id) {
  const [told, setTold] = useState({ events: [], state: "connecting" });
  useEffect(() => {
    let [waiting, timer] = [[], null];
    const show = () => { timer = null; const news = waiting; waiting = []; setTold((before) => ({ ...before, events: [...before.events, ...news] })); };
    const close = listen(address(`/evaluations/live/${live_id}/events`, { last_event_id: 0 }), {
      error: (event) => { waiting.push(event); timer ??= setTimeout(show, GATHERED_MS); },
      closed: (last) => { setTold((before) => ({ ...before, last, state: "closed" })); close(); },
    }, (connected) => setTold((before) => ({ ...before, state: connected ? "live" : "interrupted" })));
    return () => { close(); clearTimeout(timer); };
  }, [live_id]);
  return told;
}

const STATES = { connecting: ["info", "connecting"], live: ["good", "live"], interrupted: ["warn", "interrupted, trying again"], closed: ["off", "closed"] };

function Running({ live, onChange }) {
  const { events, last, state } = useErrors(live.live_id);
  const now = last ?? events.at(-1) ?? { ...live.error, ...live };
  const closing = useAction(async () => { await post(`/evaluations/live/${live.live_id}/close`); onChange(); });
  const keeping = useAction(async () => {
    const kept = await post(`/evaluations/live/${live.live_id}/trajectory`);
    go(`#/trajectories/${kept.trajectory_id}`);
  });
  const shown = state === "closed" || live.closed_at ? "closed" : state;
  return html`<${SiteCrumb} site=${live.site_id} tab="evaluations" label="Evaluations" />
    <div class="row spread"><h1>${live.name || "Live evaluation"}</h1><div class="row"><span role="status"><${Badge} kind=${STATES[shown][0]}>${STATES[shown][1]}</${Badge}></span>
      <a class="button" href=${`#/trajectories/${live.reference_id}`}>Reference</a>
      <${Button} busy=${keeping.busy} disabled=${!now.count} onClick=${keeping.run}>Keep the samples as a trajectory</${Button}>
      ${shown !== "closed" && html`<${Button} busy=${closing.busy} onClick=${closing.run}>Close it</${Button}>`}</div></div>
    <${Failure} error=${closing.error ?? keeping.error} />
    <${Figures} of=${[["RMSE so far", metres(now.rmse_m, 4)], ["mean", metres(now.mean_m, 4)], ["CE50", metres(now.CE50_m, 4)], ["CE95", metres(now.CE95_m, 4)],
      [`matched of ${count(now.count)} samples`, count(now.matched)], ["wait for the reference", count(now.waiting)], ["missed", count(now.missed)], ["latency, median", now.latency_s === null ? "–" : `${number(now.latency_s)} s`]]} />
    ${live.options.alignment !== "none" && html`<p class="muted">Aligned by the pairs so far (${live.options.alignment})${now.alignment ? `: ${count(now.alignment.pairs_used)} pairs` : "; they do not fix the frame yet"}.</p>`}
    ${events.length ? html`<${Errors} events=${events} />` : html`<${Waiting} live=${live} />`}`;
}

function Errors({ events }) {
  const data = useMemo(() => {
    const inTime = events.filter((event) => event.last).sort((first, second) => first.last.time_s - second.last.time_s);
    return [inTime.map((event) => event.last.time_s), inTime.map((event) => event.last.distance_m), inTime.map((event) => event.rmse_m)];
  }, [events]);
  const make = () => ({
    axes: [{}, { label: "error, m", labelSize: 18, labelFont: "12px system-ui, sans-serif", size: 46 }],
    scales: { x: { time: true }, y: { range: (_, low, high) => [0, high || 1] } },
    series: [{}, { stroke: seriesColour(0), width: 1.25, points: { show: true, size: 5, fill: seriesColour(0) } }, { stroke: colour("series-2"), width: 2, points: { show: false }, dash: [6, 4] }],
    padding: [8, 16, 0, 0],
  });
  return html`<section class="card" aria-label="Error as it comes"><div class="row spread"><h2>As it comes</h2><p class="small muted"><span class="swatch series-1"></span>each pair <span class="swatch series-2"></span>RMSE so far</p></div>
    <${Chart} label=${`Errors of ${events.length} pairs over time`} data=${data} make=${make} height_px=${CHART_PX} /></section>`;
}

const Waiting = ({ live }) => html`<${Empty}><p>No pair yet. The running system sends its positions to</p><p><code>POST ${location.origin}/evaluations/live/${live.live_id}/samples</code></p><p>as <code>${'{"samples": [{"time_s": 1777636800.2, "x_m": 3.1, "y_m": 2.0, "z_m": 1.4}]}'}</code>, and the phone beside it is located into the reference.</p></${Empty}>`;
