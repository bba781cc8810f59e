// What photographs take, of what.
import { get } from "../core/api.js";
import { bytes, count } from "../core/format.js";
import { useLoaded } from "../core/hooks.js";
import { html } from "../core/html.js";
import { Figures, Loaded, Table } from "../ui/parts.js";
import { SiteLink, useSiteNames } from "./site_names.js";

const columnsOf = (names) => [
  { key: "site", label: "Site", kind: "name", value: (row) => names.get(row.site_id) ?? row.site_id, show: (row) => html`<${SiteLink} id=${row.site_id} names=${names} />` },
  { key: "photos", label: "Photographs", right: true, value: (row) => row.photographs, show: (row) => count(row.photographs) },
  { key: "bytes", label: "Their size", right: true, value: (row) => row.photographs_bytes, show: (row) => bytes(row.photographs_bytes) },
  { key: "kept", label: "Kept snapshots", right: true, value: (row) => row.kept_snapshots, show: (row) => count(row.kept_snapshots) },
  { key: "kept_bytes", label: "Their size", right: true, value: (row) => row.kept_bytes, show: (row) => bytes(row.kept_bytes) },
];

export function Storage() {
  const names = useSiteNames();
  const storage = useLoaded(() => get("/storage"), []);
  return html`<${Loaded} of=${storage}>${(found) => html`
    <${Figures} of=${[["used by photographs", bytes(found.used_bytes)], ["quota", found.quota_bytes ? bytes(found.quota_bytes) : "none"], ["free on the disk", bytes(found.free_bytes)], ["left free by uploads", bytes(found.min_free_bytes)]]} />
    ${found.quota_bytes && html`<progress max=${found.quota_bytes} value=${found.used_bytes} aria-label="Share of the quota"></progress>`}
    <${Table} caption="Storage by site" columns=${columnsOf(names)} rows=${found.sites} keyOf=${(row) => row.site_id} sortBy="bytes" descending=${true} />
    <p class="small muted">A photograph that two sites share counts for both. Photographs of deleted sites go with <code>scattermark purge</code>.</p>`}</${Loaded}>`;
}
