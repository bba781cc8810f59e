// What lists and pages of trajectories say.

const TOLD_OF_ID = 8; // characters of its end, which is random
const MINUTE_S = 60;
const HOUR_S = 3600;

/** Between two times as ISO 8601 texts. */
export function duration(first, last) {
  if (!first || !last) return "–";
  const seconds = (Date.parse(last) - Date.parse(first)) / 1000;
  if (seconds < MINUTE_S) return `${seconds.toFixed(1)} s`;
  if (seconds < HOUR_S) return `${Math.floor(seconds / MINUTE_S)} min ${Math.round(seconds % MINUTE_S)} s`;
  return `${Math.floor(seconds / HOUR_S)} h ${Math.round((seconds % HOUR_S) / MINUTE_S)} min`;
}

/** Failures by their reasons: `3 × no-targets, 1 × too-few-dots`. */
export const reasonsText = (reasons) => Object.entries(reasons).sort((first, second) => second[1] - first[1]).map(([reason, times]) => `${times} × ${reason}`).join(", ") || "none";

/** What a trajectory is called. */
export const nameOf = (item) => item.name || (item.default ? `${item.device_id ?? "unnamed device"}, single snapshots` : item.device_id) || `trajectory ${item.trajectory_id.slice(-TOLD_OF_ID)}`;
