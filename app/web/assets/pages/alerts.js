// What snapshots tell of a site's map: targets that moved, vanished or came new, where they hang, and since when.
import { all, get } from "../core/api.js";
import { plural, time } from "../core/format.js";
import { useLoaded } from "../core/hooks.js";
import { html, useEffect, useMemo, useState } from "../core/html.js";
import { amend } from "../core/router.js";
import { AlertPlan, placedOf } from "../alerts/alert_plan.js";
import { Detail, sightingsOf } from "../alerts/detail.js";
import { Signs, titleOf } from "../alerts/words.js";
import { roomOf } from "../plan/room.js";
import { Button, Empty, Loaded } from "../ui/parts.js";
import { useShared } from "../ui/shared_value.js";

const WORST_FIRST = ["critical", "warning", "notice"];

export default function Alerts({ site: siteId, query, who }) {
  const loaded = useLoaded((signal) => load(siteId, signal), [siteId]);
  return html`<div class="row spread"><h1>Alerts</h1><${Button} onClick=${loaded.reload} busy=${loaded.loading && loaded.data !== null}>Look again</${Button}></div>
    <p class="muted">Rooms go on living after their survey. Every located snapshot is held against the target map, and after a few of them the site knows which target was bumped into, taken off, or newly posted.</p>
    <${Loaded} of=${loaded}>${(found) => html`<${Found} ...${found} siteId=${siteId} query=${query} who=${who} onChange=${loaded.reload} />`}</${Loaded}>`;
}

/** The answer takes in every snapshot so far, so it comes first; the plan is drawn of the map that is active then. */
async function load(siteId, signal) {
  const { watched } = await get(`/sites/${siteId}/alerts?limit=1`, { signal });
  const [alerts, room] = await Promise.all([all(`/sites/${siteId}/alerts`, "alerts"), roomOf(siteId, signal)]);
  return { alerts, watched, room };
}

const worstFirst = (first, second) => WORST_FIRST.indexOf(first.severity) - WORST_FIRST.indexOf(second.severity) || (first.last < second.last ? 1 : -1);

function Found({ alerts, watched, room, siteId, query, who, onChange }) {
  const open = useMemo(() => alerts.filter((alert) => alert.state !== "resolved").sort(worstFirst), [alerts]);
  const past = useMemo(() => alerts.filter((alert) => alert.state === "resolved"), [alerts]);
  const [pickedId, setPicked] = useState(query.alert ?? open[0]?.alert_id ?? past[0]?.alert_id);
  const pick = (id) => { setPicked(id); amend({ alert: id }); };
  const picked = alerts.find((alert) => alert.alert_id === pickedId) ?? null;
  const shown = picked?.state === "resolved" ? [...open, picked] : open;
  const pointer = useShared();
  useEffect(() => pointer.listen((index) => { const alert = index !== null && placedOf(shown, room)[index]; if (alert) pick(alert.alert_id); }), [shown, room]);
  const sightings = useLoaded((signal) => sightingsOf(picked, signal), [pickedId]);
  if (!alerts.length) return html`<${Nothing} watched=${watched} siteId=${siteId} />`;
  return html`<p class="watched">${wordsOf(open, watched)}</p>
    <div class="alerts"><div class="stack"><${List} label="Open alerts" alerts=${open} pickedId=${pickedId} onPick=${pick} empty="None is open." />
        ${past.length > 0 && html`<details open=${picked?.state === "resolved"}><summary>${plural(past.length, "alert")} that ${past.length === 1 ? "is" : "are"} over</summary><${List} label="Past alerts" alerts=${past} pickedId=${pickedId} onPick=${pick} /></details>`}</div>
      <div class="stack"><section class="card" aria-label="On the plan"><h2>On the plan</h2><${AlertPlan} room=${room} alerts=${shown} picked=${picked} sightings=${sightings.data ?? []} pointer=${pointer} /></section>
        ${picked && html`<${Detail} alert=${picked} sightings=${sightings} siteId=${siteId} who=${who} onChange=${onChange} />`}</div></div>`;
}

const heldAgainst = (watched) => `${plural(watched.snapshots, "snapshot")} ${watched.snapshots === 1 ? "was" : "were"} held against version ${watched.map_version} of the map`;
const wordsOf = (open, watched) => (watched.map_version === null ? "" : `${heldAgainst(watched)}: ${open.length ? `${plural(open.length, "alert")} ${open.length === 1 ? "stands" : "stand"}` : "nothing is wrong now"}.`);

function List({ label, alerts, pickedId, onPick, empty }) {
  if (!alerts.length) return html`<${Empty}>${empty}</${Empty}>`;
  return html`<ul class="alert-list" aria-label=${label}>${alerts.map((alert) => html`<li key=${alert.alert_id}>
    <button type="button" aria-pressed=${alert.alert_id === pickedId ? "true" : "false"} onClick=${() => onPick(alert.alert_id)}>
      <span class="row spread"><b>${titleOf(alert)}</b><span><${Signs} alert=${alert} /></span></span>
      <span class="small muted">since ${time(alert.since)} · ${plural(alert.snapshots, "snapshot")}</span></button></li>`)}</ul>`;
}

/** Nothing wrong is worth something only when many looked. */
function Nothing({ watched, siteId }) {
  if (watched.map_version === null) return html`<${Empty}>This site has no target map yet, so there is nothing to watch. <a href=${`#/sites/${siteId}/surveys`}>Survey it</a>.</${Empty}>`;
  if (!watched.snapshots) return html`<${Empty}>No snapshot was located with version ${watched.map_version} of the map yet. Each one that is will be held against it.</${Empty}>`;
  return html`<${Empty}><p><b>No alert.</b> ${heldAgainst(watched)}, and no target stands elsewhere.</p><p class="small">A target that moved by 5 mm is named after some four snapshots of it from three places; the newest 500 are looked at.</p></${Empty}>`;
}
