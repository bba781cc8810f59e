// What the page needs of its site, fresh from the service or as it was when there was a network.
import { Unreachable, all } from "../core/api.js";
import { useLoaded } from "../core/hooks.js";
import { roomOf } from "../plan/room.js";
import { done, transact } from "./database.js";

const kept = (site_id) => transact(["rooms"], "readonly", (store) => done(store("rooms").get(site_id)));
const keep = (room) => transact(["rooms"], "readwrite", (store) => done(store("rooms").put(room)));

/** The site, its targets, and cameras that may be this phone's. */
async function fresh(site_id, device_id, signal) {
  const [room, ofSite, ofDevice] = await Promise.all([roomOf(site_id, signal), all("/cameras", "cameras", { site_id }), all("/cameras", "cameras", { device_id })]);
  const cameras = new Map([...ofSite, ...ofDevice].map((camera) => [camera.camera_id, camera]));
  return { site_id, ...room, cameras: [...cameras.values()], at_ms: Date.now() };
}

/** As `useLoaded`; without a network what was kept, with `old` set. */
export function useRoom(site_id, device_id) {
  return useLoaded(async (signal) => {
    try {
      const room = await fresh(site_id, device_id, signal);
      await keep(room);
      return { ...room, old: false };
    } catch (error) {
      const before = error instanceof Unreachable && (await kept(site_id));
      if (!before) throw error;
      return { ...before, old: true };
    }
  }, [site_id, device_id]);
}
