// What of a site is drawn on every plan of it.
import { get } from "../core/api.js";

/** A site with the targets of its active map; a site without a map has none. */
export async function roomOf(site_id, signal) {
  const site = await get(`/sites/${site_id}`, { signal });
  const targets = site.map_version ? (await get(`/sites/${site_id}/targets`, { signal })).targets : [];
  return { site, targets, plate_u_m: site.plate_u_m };
}
