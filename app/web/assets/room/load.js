// What the room's page shows, from the calls that tell it, as items that can be picked: {kind, id, position_m, ...}.
import { address, all, call, get } from "../core/api.js";
import { principalAxes, positionCovariance } from "./covariance.js";
import { may } from "../core/session.js";

const DIAGONAL_LEAST_M = 1; // of a room with a single target

/**
 * A version of the map with its photographs and points; what this reader may not see is empty.
 * @returns {Promise<object>} `versions` alone for a site without a map
 */
export async function loadRoom(siteId, version, who, signal) {
  const versions = await all(`/sites/${siteId}/maps`, "maps");
  if (!versions.length) return { versions };
  const map = await get(address(`/sites/${siteId}/targets`, { version }), { signal });
  const found = map.map_version;
  const insider = may(who, "survey", "analyse");
  const [photos, report] = insider ? await Promise.all([all(`/sites/${siteId}/maps/${found}/photos`, "photos"), get(address(`/sites/${siteId}/report`, { format: "json", version: found }), { signal })]) : [[], {}];
  const targets = map.targets.map((target) => ({ ...target, kind: "target", id: `target ${target.code}` }));
  return {
    versions, version: found, surveyId: versions.find((one) => one.map_version === found)?.survey_id, insider,
    targets, datum: map.datum, u_m: map.plate_u_m,
    photos: photos.filter((photo) => photo.position_m).map((photo) => ({ ...photo, kind: "photo", id: `photo ${photo.name}` })),
    lost: photos.filter((photo) => !photo.position_m),
    points: (report.control ?? []).map((point) => ({ ...point, kind: "point", id: `point ${point.name}` })),
    ...extent([...targets, ...photos.filter((photo) => photo.position_m)]),
  };
}

function extent(items) {
  const sides = [Math.min, Math.max].map((choose) => [0, 1, 2].map((axis) => items.reduce((best, item) => choose(best, item.position_m[axis]), items[0].position_m[axis])));
  const [low, high] = sides;
  // A room whose frame has its floor at zero is shown with its floor.
  if (low[2] > 0 && low[2] < high[2] - low[2] + 2) low[2] = 0;
  return { bounds_m: [low, high], diagonal_m: Math.max(DIAGONAL_LEAST_M, Math.hypot(...high.map((value, axis) => value - low[axis]))) };
}

/** Axes of each target's ellipsoid; with the datum's part or relative to it. */
export const ellipsoidsOf = (room, withDatum) => room.targets.map((target) => principalAxes(positionCovariance(target, withDatum ? room.datum : null)));

/** Which photographs show a target, and which targets a photograph shows. */
export function seenWith(room, item) {
  if (item?.kind === "target") return room.photos.filter((photo) => photo.codes?.includes(item.code));
  if (item?.kind === "photo") return room.targets.filter((target) => item.codes?.includes(target.code));
  return [];
}

/** The trajectories of the site that hold poses, the newest first. */
export const loadTrajectories = async (siteId, who) =>
  may(who, "analyse") ? (await all("/trajectories", "trajectories", { site_id: siteId })).filter((one) => one.pose_count).reverse() : [];

const COLUMNS = { time: "time_utc", position: ["x_m", "y_m", "z_m"], turn: ["qx", "qy", "qz", "qw"], sigma: ["sigma_x_m", "sigma_y_m", "sigma_z_m"] };

/** The poses of a trajectory: its CSV, which tells all of them at once. */
export async function loadPoses(trajectory, series) {
  const text = await (await call(`/trajectories/${trajectory.trajectory_id}?format=csv`)).text();
  const [heading, ...lines] = text.trimEnd().split("\n").map((line) => line.split(","));
  const place = Object.fromEntries(heading.map((name, index) => [name, index]));
  const numbers = (line, names) => (names.every((name) => line[place[name]]) ? names.map((name) => Number(line[place[name]])) : null);
  return lines.map((line, index) => ({
    kind: "pose", id: `pose ${trajectory.trajectory_id} ${index}`, trajectory, series, at: line[place[COLUMNS.time]],
    position_m: numbers(line, COLUMNS.position), orientation_xyzw: numbers(line, COLUMNS.turn), sigma_m: numbers(line, COLUMNS.sigma),
  }));
}
