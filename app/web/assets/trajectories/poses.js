// Poses of a trajectory as the pages use them: thousands of small records in the order of time.
import { address, get } from "../core/api.js";

export const MOST_POSES = 50_000; // that a page holds at once; a part of a longer trajectory is chosen by its times
const PAGE = 1000;
const SHOWN_MS = 700; // between two parts that are shown: drawing them takes longer than loading them
const UPRIGHT = 1e-6; // of a unit vector's part in the plan: a camera that looks along z has no heading

/**
 * @typedef {object} Pose
 * @property {number} time_s since 1970
 * @property {[number, number, number]} position_m
 * @property {[number, number, number] | null} sigma_m
 * @property {number | null} heading_rad of the camera's view in the plan, from x towards y
 * @property {number | null} heading_sigma_rad
 * @property {number} ordinal
 * @property {string | null} pose_id
 */

/** @returns {Pose} of an answer's pose, located or imported */
export function poseOf(told) {
  const ahead = told.orientation_xyzw && aheadOf(told.orientation_xyzw);
  return {
    time_s: Date.parse(told.captured_at) / 1000,
    position_m: told.position_m,
    sigma_m: told.position_sigma_m,
    heading_rad: ahead && Math.hypot(ahead[0], ahead[1]) > UPRIGHT ? Math.atan2(ahead[1], ahead[0]) : null,
    heading_sigma_rad: ahead && told.covariance?.length === 6 ? headingSigma(ahead, told.covariance) : null,
    ordinal: told.ordinal,
    pose_id: told.pose_id ?? null,
  };
}

/** Where the camera looks: its z axis in the site. */
const aheadOf = ([x, y, z, w]) => [2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y)];

/** Of atan2(y, x) of a direction that small rotations about the site's axes turn. */
function headingSigma([x, y, z], covariance) {
  const plan = x * x + y * y;
  if (plan < UPRIGHT ** 2) return null;
  const by = [(-z * x) / plan, (-z * y) / plan, 1];
  return Math.sqrt(by.reduce((sum, a, row) => sum + by.reduce((part, b, column) => part + a * b * covariance[3 + row][3 + column], 0), 0));
}

/** The largest standard deviation along any axis, metres; NaN when none is known. */
export const worstSigma = (pose) => (pose.sigma_m ? Math.max(...pose.sigma_m) : NaN);

/** @returns a failed snapshot as the pages use it */
export const failureOf = (told) => ({ ...told, time_s: Date.parse(told.captured_at) / 1000 });

/**
 * All poses and failures of a trajectory, told part by part as they come.
 * @param {string} trajectory_id
 * @param {{from?: string, to?: string}} times
 * @param {(soFar: {trajectory: object, poses: Pose[], failures: object[], whole: boolean}) => void} onPart
 * @param {AbortSignal} signal
 */
export async function loadPoses(trajectory_id, times, onPart, signal) {
  let [poses, failures, cursor, shown_ms] = [[], [], null, -Infinity];
  do {
    const page = await get(address(`/trajectories/${trajectory_id}`, { limit: PAGE, ...times, cursor }), { signal });
    poses = [...poses, ...page.poses.map(poseOf)];
    failures = [...failures, ...page.failures.map(failureOf)];
    cursor = page.next_cursor;
    const ended = !cursor || poses.length >= MOST_POSES;
    if (!ended && performance.now() - shown_ms < SHOWN_MS) continue;
    onPart({ trajectory: page, poses, failures, whole: !cursor });
    shown_ms = performance.now();
  } while (cursor && poses.length < MOST_POSES);
}

const LEAST_GAP_S = 3; // as GET /trajectories/{id}/smoothed has it by default
const GAP_OF_INTERVAL = 4; // a trajectory of one picture each ten seconds has no gap of eleven

/** How long without a pose is a gap, seconds. */
export function gapOf(poses) {
  const intervals = poses.slice(1).map((pose, index) => pose.time_s - poses[index].time_s).sort((a, b) => a - b);
  const middle = intervals[Math.floor(intervals.length / 2)] ?? 0;
  return Math.max(LEAST_GAP_S, GAP_OF_INTERVAL * middle);
}

/** Gaps as [first, last] in seconds. */
export const gapsOf = (poses, gap_s) => poses.slice(1).flatMap((pose, index) => (pose.time_s - poses[index].time_s > gap_s ? [[poses[index].time_s, pose.time_s]] : []));
