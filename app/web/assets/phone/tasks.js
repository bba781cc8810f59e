// What a phone asks of the service, kept until it is done: open a trajectory, locate a picture, close the trajectory.
import { call, post } from "../core/api.js";
import { newId } from "./ids.js";

const LONGEST_SEND_MS = 180_000; // of one picture: a slow network takes long, a dead one must not take for ever

/**
 * @typedef {object} Task
 * @property {number} number its place in the queue
 * @property {"open" | "locate" | "close"} kind
 * @property {string} site_id
 * @property {string | null} trajectory_id
 * @property {number} made_ms
 * @property {number} tries that the service could not answer
 */

const task = (kind, site_id, trajectory_id, more) => ({ kind, site_id, trajectory_id, made_ms: Date.now(), tries: 0, ...more });

export const openTask = (site_id, trajectory_id, device_id, name) => task("open", site_id, trajectory_id, { device_id, name });
export const closeTask = (site_id, trajectory_id) => task("close", site_id, trajectory_id);

/**
 * @param {string} site_id
 * @param {{captured_ms: number, spread_s: number}} picture when it was taken by the phone's clock, and how far that can be wrong
 * @param {{trajectory_id?: string, device_id: string, camera_id?: string, reading: object | null}} with_what `reading`: the clock's at that time
 */
export const locateTask = (site_id, { captured_ms, spread_s }, { trajectory_id = null, device_id, camera_id = null, reading }) =>
  task("locate", site_id, trajectory_id, { snapshot_id: newId(), captured_ms, spread_s, device_id, camera_id, reading });

/**
 * Ask the service for what a task wants. Each can be asked again: ids make the answer the same.
 * @param {Task} given
 * @param {Blob | null} picture
 * @param {object | null} reading of the clock now, for a picture that was taken when none was known; null where it is not needed
 */
export async function perform(given, picture, reading) {
  if (given.kind === "open") return post("/trajectories", { site_id: given.site_id, trajectory_id: given.trajectory_id, device_id: given.device_id, name: given.name });
  if (given.kind === "close") return post(`/trajectories/${given.trajectory_id}/close`);
  const answer = await call("/locate", { method: "POST", body: formOf(given, picture, given.reading ?? reading), signal: AbortSignal.timeout(LONGEST_SEND_MS) });
  return answer.json();
}

function formOf(given, picture, reading) {
  const form = new FormData();
  const fields = {
    site_id: given.site_id, snapshot_id: given.snapshot_id, device_id: given.device_id, camera_id: given.camera_id, trajectory_id: given.trajectory_id,
    captured_at: (given.captured_ms / 1000).toFixed(3),
    client_clock_offset_s: reading?.offset_s, client_clock_delay_s: reading && reading.delay_s + given.spread_s,
  };
  for (const [name, value] of Object.entries(fields)) if (value !== null && value !== undefined) form.append(name, value);
  form.append("image", picture, "snapshot.jpg");
  return form;
}
