// Addresses behind `#`: which page they mean. Nothing behind `#` is ever sent to the server.

/**
 * The first route that fits an address.
 * @param {string} hash such as `#/sites/3f?code=389`
 * @param {Array<{path: string}>} routes paths with `:names`
 */
export function match(hash, routes) {
  const [path, query = ""] = (hash.replace(/^#/, "") || "/").split("?");
  const parts = path.split("/").filter(Boolean);
  for (const route of routes) {
    const wanted = route.path.split("/").filter(Boolean);
    if (wanted.length !== parts.length) continue;
    if (!wanted.every((part, index) => part.startsWith(":") || part === parts[index])) continue;
    const params = Object.fromEntries(wanted.flatMap((part, index) => (part.startsWith(":") ? [[part.slice(1), decodeURIComponent(parts[index])]] : [])));
    return { route, params, query: Object.fromEntries(new URLSearchParams(query)) };
  }
  return null;
}

/** Go to a page. */
export const go = (hash) => { location.hash = hash; };

/** Change the query of the present page without a step in the history. */
export function amend(query) {
  const [path, before = ""] = location.hash.split("?");
  const parameters = new URLSearchParams(before);
  for (const [name, value] of Object.entries(query)) value === null || value === undefined || value === "" ? parameters.delete(name) : parameters.set(name, value);
  history.replaceState(null, "", parameters.size ? `${path}?${parameters}` : path);
}
