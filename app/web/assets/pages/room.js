// The room in three dimensions: targets and how well they are known, where photographs were taken, where snapshots were located.
import { plural } from "../core/format.js";
import { useLoaded } from "../core/hooks.js";
import { html, useEffect, useMemo, useRef, useState } from "../core/html.js";
import { amend } from "../core/router.js";
import { Canvas } from "../room/canvas.js";
import { Layers, Scale, Trajectories, Versions, Views } from "../room/controls.js";
import { fittingScale, SCALES } from "../room/ellipsoids.js";
import { Lists } from "../room/lists.js";
import { ellipsoidsOf, loadPoses, loadRoom, loadTrajectories } from "../room/load.js";
import { Picked } from "../room/panel.js";
import { SIDE_U } from "../room/plates.js";
import { canDraw } from "../room/stage.js";
import { VIEWS } from "../room/views.js";
import { DIRECTIONS } from "../room/walk.js";
import { Empty, Failure, Loaded, Notice } from "../ui/parts.js";

const POSES_AT_ONCE = 20_000; // of the newest trajectories; others are loaded when they are asked for
const DRAWN = { codes: true, ellipsoids: true, photos: true, points: true, poses: true, grid: true };

export default function Room({ site, query, who }) {
  const [version, setVersion] = useState(query.version ?? null);
  const room = useLoaded((signal) => loadRoom(site, version, who, signal), [site, version]);
  const trajectories = useLoaded(() => loadTrajectories(site, who), [site]);
  const choose = (wanted) => { amend({ version: wanted }); setVersion(wanted); };
  return html`<${Loaded} of=${room}>${(found) => (!found.versions.length ? html`<h1>Room</h1><${Empty}>No target map yet. Open a <a href=${`#/sites/${site}/surveys`}>survey</a>, add photographs and build it.</${Empty}>`
    : html`<${Failure} error=${trajectories.error} retry=${trajectories.reload} /><${Furnished} room=${found} site=${site} query=${query} trajectories=${trajectories.data ?? []} onVersion=${choose} />`)}</${Loaded}>`;
}

function Furnished({ room, site, query, trajectories, onVersion }) {
  const drawable = useMemo(canDraw, []);
  const [lost, setLost] = useState(false);
  const [picked, setPicked] = usePick(room, query);
  const [view, setView] = useState(VIEWS[query.view] ? query.view : "room");
  const [visible, setVisible] = useState(DRAWN);
  const [withDatum, setWithDatum] = useState(true);
  const axes = useMemo(() => ellipsoidsOf(room, withDatum), [room, withDatum]);
  const [scale, setScale] = useState(() => fittingScale(axes, SIDE_U * room.u_m));
  const chosen = useChosen(trajectories);
  const stage = useRef(null);
  const drawn = drawable && !lost;
  useEffect(() => { if (picked && query.code && stage.current) stage.current.face(picked); }, [query.code]);
  const lookFrom = (name) => { amend({ view: name === "room" ? null : name }); name === view ? stage.current?.look(name) : setView(name); };
  return html`<div class="row spread room-head"><h1>Room</h1><${Versions} room=${room} onVersion=${onVersion} /></div>
    ${!drawn && html`<${Notice} kind="warn"><p>${lost ? "The graphics of this browser stopped; load the page again to draw the room." : "This browser cannot draw in three dimensions (WebGL 2 is off or missing)."} The tables below tell the same.</p></${Notice}>`}
    ${query.code && !room.targets.some((target) => String(target.code) === query.code) && html`<${Notice} kind="warn"><p>Target ${query.code} is not in version ${room.version} of this map. If it hangs in the room, photograph it and build again.</p></${Notice}>`}
    <div class="room ${drawn ? "" : "flat"}">
      ${drawn && html`<div class="room-scene"><${Views} view=${view} onView=${lookFrom} onStep=${(name) => stage.current.controls.step(DIRECTIONS[name])} />
        <${Canvas} room=${room} poses=${chosen.poses} axes=${axes} scale=${SCALES[scale]} visible=${visible} view=${view} picked=${picked} onPick=${setPicked} onLost=${() => setLost(true)} stageOf=${stage} />
        <${Legend} room=${room} poses=${chosen.poses} /></div>`}
      <aside class="room-side stack">
        ${picked ? html`<${Picked} item=${picked} room=${room} site=${site} drawn=${drawn} onPick=${setPicked} onFace=${(item) => stage.current.face(item)} />` : html`<p class="small muted">Pick a target, a photograph, a point or a pose in the picture or in a table.</p>`}
        ${drawn && html`<${Layers} visible=${visible} onVisible=${setVisible} /><${Scale} scale=${scale} onScale=${setScale} withDatum=${withDatum} onDatum=${setWithDatum} />`}
        <${Trajectories} trajectories=${trajectories} chosen=${chosen.ids} onChosen=${chosen.choose} loading=${chosen.loading} /><${Failure} error=${chosen.error} />
      </aside>
    </div>
    <${Lists} room=${room} poses=${chosen.poses} picked=${picked} onPick=${setPicked} />`;
}

const Legend = ({ room, poses }) => html`<p class="small muted room-legend"><span class="axis-x">X</span> <span class="axis-y">Y</span> <span class="axis-z">Z</span> from the site's origin. ${plural(room.targets.length, "target")}, ${plural(room.photos.length, "photograph")}, ${plural(room.points.length, "control or check point")}, ${plural(poses.length, "pose")}.
  △ control, ○ check. Drag to turn, right button or two fingers to shift, wheel or pinch to come closer.</p>`;

/** What is picked; the address names a target, so that a sheet's QR code leads to it. */
function usePick(room, query) {
  const ofAddress = () => room.targets.find((target) => String(target.code) === query.code) ?? null;
  const [picked, setPicked] = useState(ofAddress);
  useEffect(() => setPicked(ofAddress()), [room, query.code]);
  const pick = (item) => { amend({ code: item?.kind === "target" ? item.code : null }); setPicked(item); };
  return [picked, pick];
}

/** The trajectories whose poses are drawn: at first the newest, as many as come quickly. */
function useChosen(trajectories) {
  const [ids, choose] = useState(new Set());
  useEffect(() => {
    let room = POSES_AT_ONCE;
    choose(new Set(trajectories.filter((one) => (room -= one.pose_count) >= 0).map((one) => one.trajectory_id)));
  }, [trajectories]);
  const loaded = useLoaded(() => Promise.all(trajectories.flatMap((one, series) => (ids.has(one.trajectory_id) ? [loadPoses(one, series)] : []))), [trajectories, ids]);
  const poses = useMemo(() => (loaded.data ?? []).flat(), [loaded.data]);
  return { ids, choose, poses, loading: loaded.loading, error: loaded.error };
}
