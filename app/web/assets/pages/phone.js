// The phone: where am I? Pictures of the live camera or of its camera app, located at once or as soon as there is a network.
import { useAction, useEach } from "../core/hooks.js";
import { html, useEffect, useMemo, useState } from "../core/html.js";
import { may } from "../core/session.js";
import { Answer } from "../phone/answer.js";
import { useClock } from "../phone/clock.js";
import { Bar, Photographs, RunCard, useWish } from "../phone/controls.js";
import { deviceId, renameDevice } from "../phone/device.js";
import { momentOfFile } from "../phone/exif.js";
import { HerePlan } from "../phone/here_plan.js";
import { useRoom } from "../phone/kept_room.js";
import { useKeptPages } from "../phone/offline.js";
import { Preview } from "../phone/preview.js";
import { countsOf, QueuePanel } from "../phone/queue_panel.js";
import { useRun } from "../phone/run.js";
import { CameraRecord, Settings } from "../phone/settings.js";
import { locateTask } from "../phone/tasks.js";
import { useEye } from "../phone/use_eye.js";
import { useQueue } from "../phone/use_queue.js";
import { useWakeLock } from "../phone/wake_lock.js";
import { Failure, Loaded, Notice } from "../ui/parts.js";

export default function Phone({ site, who }) {
  const [device_id, setDevice] = useState(deviceId);
  const room = useRoom(site, device_id);
  const rename = (name) => { if (name) { renameDevice(name); setDevice(name); } };
  return html`<${Loaded} of=${room}>${(found) => html`<${Locating} room=${found} device=${{ id: device_id, rename }} who=${who} onNetwork=${room.reload} />`}</${Loaded}>`;
}

function Locating({ room, device, who, onNetwork }) {
  const { site_id } = room.site;
  const clock = useClock();
  const queue = useQueue(site_id, clock.known);
  const eye = useEye(site_id, room.cameras);
  const taking = useTaking({ site_id, device_id: device.id, clock, queue, eye });
  const run = useRun(site_id, queue.add, taking.frame.run);
  const wish = useWish();
  const keptPages = useKeptPages();
  useWakeLock(eye.ready);
  useEffect(() => { if (room.old && clock.reading) onNetwork(); }, [room.old, clock.reading]); // the service answers again
  const { newest, answers } = useShown(queue.results, run.run?.trajectory_id);
  const counts = countsOf(queue, run.run?.trajectory_id);
  const record = html`<${CameraRecord} site=${site_id} cameras=${room.cameras} size=${eye.size} device_id=${device.id} chosen=${eye.chosen} onChoose=${eye.choose} />`;
  return html`<h1 class="visually-hidden">Phone in ${room.site.name}</h1>
    ${room.old && html`<${Notice} kind="warn"><p>No network: pictures wait here and are sent later, with their own times.</p></${Notice}>`}
    ${!room.site.map_version && html`<${Notice} kind="warn"><p>This site has no target map yet: nothing can be located before its survey is built.</p></${Notice}>`}
    <div class="phone"><div class="phone-column">
      <${Preview} camera=${eye.camera} eye=${eye.eye} size=${eye.size} onSize=${eye.setSize} />
      <section class="phone-plan" aria-label="Plan"><${HerePlan} room=${room} answers=${answers} /></section>
    </div><div class="phone-column">
      <${Answer} result=${newest} site=${site_id} waiting=${queue.tasks.length > 0 && queue.standing.state === "sending"} />
      <${Failure} error=${taking.once.error ?? taking.frame.error ?? taking.files.error ?? run.error} />
      <${Bar} ready=${eye.ready} taking=${taking.once} run=${run} counts=${counts} onRun=${() => run.start({ ...wish.told(), device_id: device.id })} />
      <${RunCard} run=${run.run} skipped=${run.skipped} wish=${wish} analyst=${may(who, "analyse")} />
      <${QueuePanel} queue=${queue} />
      <${Photographs} onFiles=${taking.files.run} />
      <${Settings} camera=${eye.camera} record=${record} photo=${eye.photo} device=${device} reading=${clock.reading} keptPages=${keptPages} />
    </div></div>`;
}

/** Pictures into the queue: one of the live camera, one of a run, files of the camera app. */
function useTaking({ site_id, device_id, clock, queue, eye }) {
  const add = (picture, camera_id, trajectory_id) =>
    queue.add(locateTask(site_id, picture, { trajectory_id, camera_id, device_id, reading: clock.current() }), picture.blob);
  const take = async (once, trajectory_id) => {
    const picture = await eye.take(once);
    await add(picture, eye.recordFor(picture), trajectory_id);
  };
  const once = useAction(() => take(true));
  const frame = useAction((run) => take(false, run.trajectory_id));
  const files = useEach(async (chosen) => {
    for (const file of chosen) {
      const { names_camera, ...moment } = await momentOfFile(file);
      await add({ blob: file, ...moment }, names_camera ? null : eye.chosen); // a file that names its camera knows better
    }
  });
  return { once, frame, files };
}

/** What is shown: the newest result, and the positions of the run that is open, otherwise all that are kept. */
function useShown(results, trajectory_id) {
  return useMemo(() => {
    const pictures = results.filter((result) => result.kind === "locate");
    const ours = pictures.filter((result) => result.answer && (!trajectory_id || result.trajectory_id === trajectory_id));
    const answers = ours.map((result) => result.answer).sort((one, other) => Date.parse(one.captured_at) - Date.parse(other.captured_at));
    const refused = results.findLast((result) => result.kind !== "locate" && result.problem);
    return { newest: pictures.at(-1) ?? refused ?? null, answers };
  }, [results, trajectory_id]);
}
