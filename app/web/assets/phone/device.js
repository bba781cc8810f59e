// What the service calls this phone: cameras that are calibrated under a device's name locate its pictures.

const KEY = "scattermark:device";
const RANDOM_BYTES = 4;

/** The name that snapshots, trajectories and calibrations of this browser carry as `device_id`. */
export function deviceId() {
  const kept = localStorage.getItem(KEY);
  if (kept) return kept;
  const random = crypto.getRandomValues(new Uint8Array(RANDOM_BYTES));
  const made = `phone-${[...random].map((byte) => byte.toString(16).padStart(2, "0")).join("")}`;
  localStorage.setItem(KEY, made);
  return made;
}

export const renameDevice = (name) => localStorage.setItem(KEY, name);
