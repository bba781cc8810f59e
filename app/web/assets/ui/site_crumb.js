// The way to a page that belongs to a site without standing among its tabs.
import { get } from "../core/api.js";
import { useLoaded } from "../core/hooks.js";
import { html } from "../core/html.js";

/** @param {{site: string, tab: string, label: string}} given the site's id, and the tab that lists what the page is one of */
export function SiteCrumb({ site, tab, label }) {
  const found = useLoaded((signal) => get(`/sites/${site}`, { signal }), [site]);
  return html`<p class="crumbs"><a href=${`#/sites/${site}`}>${found.data?.name ?? "Site"}</a> › <a href=${`#/sites/${site}/${tab}`}>${label}</a></p>`;
}
