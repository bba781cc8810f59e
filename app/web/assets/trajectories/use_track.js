// A trajectory as it loads and grows: page by page, then event by event.
import { address } from "../core/api.js";
import { useEffect, useState } from "../core/html.js";
import { listen } from "../core/listen.js";
import { failureOf, loadPoses, poseOf } from "./poses.js";

const GATHERED_MS = 250; // events of a moment are shown together

const NOTHING = { trajectory: null, poses: [], failures: [], whole: false, error: null };

/** The poses and failures of a trajectory within some times, as far as they are here. */
export function useTrack(trajectory_id, from, to) {
  const [track, setTrack] = useState(NOTHING);
  useEffect(() => {
    const controller = new AbortController();
    setTrack(NOTHING);
    loadPoses(trajectory_id, { from, to }, (part) => setTrack({ ...part, error: null }), controller.signal)
      .catch((error) => error.name === "AbortError" || setTrack((before) => ({ ...before, error })));
    return () => controller.abort();
  }, [trajectory_id, from, to]);
  return [track, setTrack];
}

/**
 * Follow a trajectory that takes snapshots: what comes after what is here is added to it.
 * @returns {"off" | "connecting" | "live" | "interrupted"} how it stands; an interrupted one goes on where it broke off
 */
export function useLive(trajectory_id, track, setTrack, wanted) {
  const [state, setState] = useState("off");
  const open = wanted && track.whole && !track.trajectory.closed_at && !track.trajectory.source;
  useEffect(() => {
    if (!open) return setState("off");
    setState("connecting");
    const last = [...track.poses, ...track.failures].reduce((most, item) => Math.max(most, item.ordinal), 0);
    const gathered = gather((news) => setTrack((before) => grown(before, news)));
    const close = listen(address(`/trajectories/${trajectory_id}/events`, { last_event_id: last }), {
      pose: (told) => gathered.add({ pose: poseOf(told) }),
      failure: (told) => gathered.add({ failure: failureOf(told) }),
      closed: (trajectory) => { gathered.add({ trajectory }); close(); },
    }, (connected) => setState(connected ? "live" : "interrupted"));
    return () => { close(); gathered.end(); };
  }, [trajectory_id, open]);
  return state;
}

/** Things of a moment together. */
function gather(show) {
  let [waiting, timer] = [[], null];
  const tell = () => { timer = null; show(waiting); waiting = []; };
  return {
    add(item) { waiting.push(item); timer ??= setTimeout(tell, GATHERED_MS); },
    end() { clearTimeout(timer); },
  };
}

/** A track with news: a reconnected stream may tell of something again, and a snapshot may come late. */
function grown(before, news) {
  const closed = news.find((item) => item.trajectory)?.trajectory;
  return {
    ...before,
    trajectory: { ...before.trajectory, ...closed },
    poses: merged(before.poses, news.flatMap((item) => item.pose ?? [])),
    failures: merged(before.failures, news.flatMap((item) => item.failure ?? [])),
  };
}

function merged(known, news) {
  const ordinals = new Set(known.map((item) => item.ordinal));
  const fresh = news.filter((item) => !ordinals.has(item.ordinal));
  if (!fresh.length) return known;
  return [...known, ...fresh].sort((first, second) => first.time_s - second.time_s);
}
