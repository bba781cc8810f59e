// One alert: what it says, what to do, what it rests on; whoever knows of it says so.
import { get, post } from "../core/api.js";
import { metres, number, plural, time } from "../core/format.js";
import { useAction } from "../core/hooks.js";
import { html, useState } from "../core/html.js";
import { may } from "../core/session.js";
import { Button, Empty, Facts, Failure, Field, Loaded, Notice, Table } from "../ui/parts.js";
import { Signs, titleOf } from "./words.js";

const AXES = ["x", "y", "z"];

export function Detail({ alert, sightings, siteId, who, onChange }) {
  return html`<section class="card alert-detail" aria-label="Alert">
    <div class="row spread"><h2>${titleOf(alert)}</h2><div class="row"><${Signs} alert=${alert} /></div></div>
    <p>${alert.advice}</p>
    <${Facts} of=${factsOf(alert)} />
    <div class="row">${alert.code !== null && alert.kind !== "unknown-target" && html`<a class="button" href=${`#/sites/${siteId}/room?code=${alert.code}`}>See it in the room</a>`}
      <a class="button" href=${`#/sites/${siteId}/surveys`}>Surveys</a></div>
    ${alert.state !== "resolved" && may(who, "survey") && html`<${Acknowledge} key=${alert.alert_id} alert=${alert} onChange=${onChange} />`}
    ${alert.code !== null && html`<h3>What it rests on</h3><${Loaded} of=${sightings}>${(found) => html`<${Sightings} sightings=${found} who=${who} />`}</${Loaded}>`}
  </section>`;
}

function factsOf(alert) {
  const { displacement } = alert;
  const moved = displacement && AXES.map((axis, index) => html`<span>${axis} ${signed(displacement.vector_mm[index])} ± ${number(Math.sqrt(displacement.covariance_mm2[index][index]), 1)} mm</span>`);
  return [
    ...(moved ? [["Moved", html`<span class="triple">${moved}</span>`]] : []),
    ["First told", time(alert.since)], ["Last told", time(alert.last)],
    ["By", `${plural(alert.snapshots, "snapshot")} from ${plural(alert.places, "place")}, ${plural(alert.devices, "device")}`],
    ["Of", `target map, version ${alert.map_version}`],
    ...(alert.acknowledged_at ? [["Known since", html`${time(alert.acknowledged_at)}${alert.note && html`: <q>${alert.note}</q>`}`]] : []),
    ...(alert.resolved_at ? [["Over since", time(alert.resolved_at)]] : []),
  ];
}

const signed = (value) => `${value < 0 ? "−" : "+"}${number(Math.abs(value), 1)}`;

function Acknowledge({ alert, onChange }) {
  const [note, setNote] = useState(alert.note);
  const known = alert.state === "acknowledged";
  const saying = useAction(async () => { await post(`/alerts/${alert.alert_id}/acknowledge`, { note }); onChange(); });
  return html`<form class="row acknowledge" onSubmit=${(event) => { event.preventDefault(); saying.run(); }}>
    <${Failure} error=${saying.error} />
    <${Field} label="Note" hint="It ends by itself once new snapshots no longer tell of it, or with a new map."><input maxlength="2000" value=${note} onInput=${(event) => setNote(event.target.value)} placeholder="The door hit it; posted anew on Friday" /></${Field}>
    <${Button} type="submit" kind=${known ? "" : "primary"} busy=${saying.busy}>${known ? "Change the note" : "This is known"}</${Button}></form>`;
}

/** What each snapshot saw: the poses of some lean a little towards a target that moved, so that they differ by more than noise. */
function Sightings({ sightings, who }) {
  if (!sightings.length) return html`<${Empty}>The snapshots that it rests on were removed, or older ones told of it first.</${Empty}>`;
  const columns = [
    { key: "at", label: "Snapshot", value: (one) => one.captured_at, show: (one) => (may(who, "analyse") ? html`<a href=${`#/trajectories/${one.trajectory_id}`}>${time(one.captured_at)}</a>` : time(one.captured_at)) },
    { key: "device", label: "Device", kind: "name", value: (one) => one.device_id },
    { key: "from", label: "Taken at x, y, z", value: (one) => one.camera_m[0], show: (one) => html`<span class="number">${one.camera_m.map((value) => metres(value, 2)).join(", ")}</span>` },
    { key: "moved", label: "Target off by x, y, z, mm", right: true, value: (one) => one.movement_mm && Math.hypot(...one.movement_mm), show: (one) => (one.movement_mm ? one.movement_mm.map(signed).join(", ") : "–") },
    { key: "used", label: "In the pose", value: (one) => Number(one.used), show: (one) => (one.used ? "used" : "left out") },
  ];
  return html`<${Table} caption="Snapshots that tell of it" columns=${columns} rows=${sightings} keyOf=${(one) => one.pose_id} sortBy="at" descending=${true} />
    ${!sightings.some((one) => one.movement_mm) && html`<${Notice}>The map does not hold this code, so no snapshot tells where it should stand.</${Notice}>`}`;
}

/** The snapshots that an alert rests on. */
export const sightingsOf = async (alert, signal) => (alert && alert.code !== null ? (await get(`/alerts/${alert.alert_id}/sightings`, { signal })).sightings : []);
