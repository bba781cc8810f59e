// Sites by their names, where answers give ids.
import { all } from "../core/api.js";
import { useLoaded } from "../core/hooks.js";
import { html } from "../core/html.js";

/** @returns {Map<string, string>} names by ids; empty until they are known */
export function useSiteNames() {
  const sites = useLoaded(() => all("/sites", "sites"), []);
  return new Map((sites.data ?? []).map((site) => [site.site_id, site.name]));
}

/** A link to a site by its name; to one that is gone by its id. */
export const SiteLink = ({ id, names }) => html`<a href=${`#/sites/${id}`}>${names.get(id) ?? html`<code>${id}</code>`}</a>`;
