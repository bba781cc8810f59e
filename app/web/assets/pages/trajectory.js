// One trajectory: from above, over time, in numbers, as a file; one that still grows is followed.
import { post } from "../core/api.js";
import { count, mm } from "../core/format.js";
import { useAction, useLoaded } from "../core/hooks.js";
import { html, useMemo, useState } from "../core/html.js";
import { amend } from "../core/router.js";
import { may } from "../core/session.js";
import { roomOf } from "../plan/room.js";
import { Exports } from "../trajectories/exports.js";
import { gapOf, MOST_POSES, worstSigma } from "../trajectories/poses.js";
import { Failures, Readout } from "../trajectories/readout.js";
import { Series } from "../trajectories/series.js";
import { duration, nameOf, reasonsText } from "../trajectories/texts.js";
import { TrackPlan } from "../trajectories/track_plan.js";
import { useLive, useTrack } from "../trajectories/use_track.js";
import { Badge, Busy, Button, Empty, Failure, Figures, Notice } from "../ui/parts.js";
import { SiteCrumb } from "../ui/site_crumb.js";
import { useShared } from "../ui/shared_value.js";

export default function Trajectory({ trajectory: trajectory_id, query, who }) {
  const [track, setTrack] = useTrack(trajectory_id, query.from, query.to);
  const [live, setLive] = useState(query.live !== "off" && !query.to);
  const state = useLive(trajectory_id, track, setTrack, live);
  if (!track.trajectory) return track.error ? html`<${Failure} error=${track.error} />` : html`<p><${Busy} /> loading</p>`;
  const follow = () => { amend({ live: live ? "off" : null }); setLive(!live); };
  return html`<${Heading} track=${track} state=${state} follow=${follow} live=${live} who=${who} onClosed=${(trajectory) => setTrack((before) => ({ ...before, trajectory: { ...before.trajectory, ...trajectory } }))} />
    <${Failure} error=${track.error} />
    ${query.from || query.to ? html`<${Notice}><p>From ${query.from ?? "the start"} to ${query.to ?? "the end"}. <a href=${`#/trajectories/${trajectory_id}`}>All of it</a></p></${Notice}>` : null}
    <${Shown} track=${track} query=${query} />`;
}

const STATES = { connecting: ["info", "connecting"], live: ["good", "live"], interrupted: ["warn", "interrupted, trying again"] };

function Heading({ track: { trajectory }, state, follow, live, who, onClosed }) {
  const closing = useAction(async () => onClosed(await post(`/trajectories/${trajectory.trajectory_id}/close`)));
  const open = !trajectory.closed_at && !trajectory.source;
  return html`<${SiteCrumb} site=${trajectory.site_id} tab="trajectories" label="Trajectories" />
    <div class="row spread"><h1>${nameOf(trajectory)}</h1><div class="row">
      ${STATES[state] && html`<span role="status"><${Badge} kind=${STATES[state][0]}>${STATES[state][1]}</${Badge}></span>`}
      ${open && html`<${Button} aria-pressed=${live} onClick=${follow}>${live ? "Stop following" : "Follow live"}</${Button}>`}
      ${open && may(who, "locate", "analyse") && html`<${Button} busy=${closing.busy} onClick=${closing.run}>Close the trajectory</${Button}>`}
      <a class="button" href=${`#/sites/${trajectory.site_id}/evaluations?reference=${trajectory.trajectory_id}`}>Compare with it</a></div></div>
    <${Failure} error=${closing.error} />
    ${trajectory.source && html`<p class="muted">From a file of the format ${trajectory.source.format}: ${trajectory.source.note}.</p>`}`;
}

function Shown({ track: { trajectory, poses, failures, whole }, query }) {
  const room = useLoaded((signal) => roomOf(trajectory.site_id, signal), [trajectory.site_id]);
  const [by, setBy] = useState(query.colour === "sigma" ? "sigma" : "time");
  const [pointer, range] = [useShared(), useShared()];
  const gap_s = useMemo(() => gapOf(poses), [poses]);
  const times = { from: query.from, to: query.to };
  const colour = (event) => { amend({ colour: event.target.value }); setBy(event.target.value); };
  return html`<${Numbers} trajectory=${trajectory} poses=${poses} failures=${failures} />
    ${!whole && (poses.length >= MOST_POSES ? html`<${Cut} trajectory=${trajectory} poses=${poses} />` : html`<p role="status"><${Busy} /> ${count(poses.length)} of ${count(trajectory.pose_count)} poses</p>`)}
    <div class="track-columns"><section class="card" aria-label="Plan"><div class="row spread"><h2>Plan</h2>
        <label class="row small">Colour <select class="input narrow" value=${by} onChange=${colour}><option value="time">by time</option><option value="sigma">by σ</option></select></label></div>
        <${Failure} error=${room.error} retry=${room.reload} />
        ${poses.length ? html`<${TrackPlan} poses=${poses} gap_s=${gap_s} by=${by} room=${room.data ?? NO_ROOM} pointer=${pointer} range=${range} />` : html`<${Empty}>No pose yet.</${Empty}>`}</section>
      <div class="stack"><${Readout} poses=${poses} pointer=${pointer} /><${Exports} trajectory=${trajectory} times=${times} /></div></div>
    ${poses.length > 0 && html`<${Series} poses=${poses} failures=${failures} gap_s=${gap_s} pointer=${pointer} range=${range} />`}
    ${failures.length > 0 && html`<${Failures} failures=${failures} />`}`;
}

const NO_ROOM = { targets: [], plate_u_m: 0 }; // until it is loaded

function Numbers({ trajectory, poses, failures }) {
  const sigmas = useMemo(() => poses.map(worstSigma).filter(Number.isFinite).sort((a, b) => a - b), [poses]);
  const times = [...poses, ...failures].map((item) => item.time_s * 1000);
  const [first, last] = times.reduce(([least, most], value) => [Math.min(least, value), Math.max(most, value)], [Infinity, -Infinity]);
  const reasons = failures.reduce((sum, { reason }) => ({ ...sum, [reason]: (sum[reason] ?? 0) + 1 }), {});
  return html`<${Figures} of=${[
    ["poses", count(poses.length)], [failures.length ? `failures: ${reasonsText(reasons)}` : "failures", count(failures.length)],
    ["from first to last", times.length ? duration(new Date(first).toISOString(), new Date(last).toISOString()) : "–"],
    ["median of the largest σ", mm(sigmas[Math.floor(sigmas.length / 2)])], ["device", trajectory.device_id ?? "–"]]} />`;
}

function Cut({ trajectory, poses }) {
  const from = new Date(poses.at(-1).time_s * 1000).toISOString();
  return html`<${Notice} kind="warn"><p>These are the first ${count(poses.length)} of ${count(trajectory.pose_count)} poses. <a href=${`#/trajectories/${trajectory.trajectory_id}?from=${encodeURIComponent(from)}`}>The next ones</a>; exports hold all.</p></${Notice}>`;
}
