// The phone's camera: asked for as large as it gives, let go when nobody looks.
import { useEffect, useState } from "../core/html.js";

// More than any stream has: browsers give the nearest they can. 4:3 is the shape of nearly all sensors.
const WISHED = { width: { ideal: 4096 }, height: { ideal: 3072 } };
const CHOSEN = "scattermark:lens";

const TROUBLES = { NotAllowedError: "refused", SecurityError: "refused", NotFoundError: "none", OverconstrainedError: "none", NotReadableError: "taken", AbortError: "taken" };

/** Why there is no picture: `kind` is insecure, refused, none, taken or failed. */
export class CameraTrouble extends Error {
  constructor(kind, cause) {
    super(cause?.message || kind, { cause });
    this.kind = kind;
  }
}

async function open(lens) {
  if (!isSecureContext || !navigator.mediaDevices?.getUserMedia) throw new CameraTrouble("insecure");
  const wished = lens ? { deviceId: { exact: lens } } : { facingMode: { ideal: "environment" } };
  try {
    return await navigator.mediaDevices.getUserMedia({ video: { ...WISHED, ...wished }, audio: false });
  } catch (error) {
    if (lens && TROUBLES[error.name] === "none") return open(null); // the one that was chosen is not there today
    throw new CameraTrouble(TROUBLES[error.name] ?? "failed", error);
  }
}

const stop = (stream) => stream?.getTracks().forEach((track) => track.stop());

/** Lenses to choose from; their names are told once the camera was allowed. */
async function lensesOf() {
  const devices = await navigator.mediaDevices.enumerateDevices();
  return devices.filter((device) => device.kind === "videoinput" && device.deviceId).map((device, index) => ({ id: device.deviceId, label: device.label || `Camera ${index + 1}` }));
}

/**
 * The camera while `wanted` and the page is seen.
 * @returns {{stream: MediaStream | null, lens: {id: string, label: string} | null, lenses: object[], trouble: CameraTrouble | null, choose: (id: string) => void, again: () => void}}
 */
export function useCamera(wanted) {
  const [seen, setSeen] = useState(!document.hidden);
  const [chosen, setChosen] = useState(localStorage.getItem(CHOSEN));
  const [turn, setTurn] = useState(0);
  const [found, setFound] = useState({ stream: null, lens: null, lenses: [], trouble: null });
  useEffect(() => {
    const look = () => setSeen(!document.hidden);
    document.addEventListener("visibilitychange", look);
    return () => document.removeEventListener("visibilitychange", look);
  }, []);
  useEffect(() => {
    if (!wanted || !seen) return undefined;
    let [over, stream] = [false, null];
    const again = () => stream || setTurn((before) => before + 1); // one was plugged in; opening one tells so, too
    open(chosen).then(async (opened) => {
      stream = opened;
      if (over) return stop(stream);
      const [track] = stream.getVideoTracks();
      track.addEventListener("ended", () => over || setFound((before) => ({ ...before, stream: null, trouble: new CameraTrouble("taken") })));
      const lenses = await lensesOf();
      if (!over) setFound({ stream, lens: { id: track.getSettings().deviceId, label: track.label }, lenses, trouble: null });
    }).catch((trouble) => over || setFound({ stream: null, lens: null, lenses: [], trouble }));
    navigator.mediaDevices?.addEventListener?.("devicechange", again);
    return () => {
      over = true;
      stop(stream);
      setFound((before) => ({ ...before, stream: null }));
      navigator.mediaDevices?.removeEventListener?.("devicechange", again);
    };
  }, [wanted, seen, chosen, turn]);
  const choose = (id) => { localStorage.setItem(CHOSEN, id); setChosen(id); };
  return { ...found, choose, again: () => setTurn((before) => before + 1) };
}
