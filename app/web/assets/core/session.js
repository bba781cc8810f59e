// Who asks: a key is exchanged for a cookie that no script can read.
import { KEY_SHOWN, Problem, Unreachable, get, post, remove } from "./api.js";
import { go } from "./router.js";

const LAST = "scattermark:who"; // a name and scopes, no secret: pages that work without a network show what one may do

/** Who asks and what they may do, as it was last known when there is no network; null when the service wants a key. */
export async function whoAmI() {
  try {
    const who = await get("/session");
    localStorage.setItem(LAST, JSON.stringify(who));
    return who;
  } catch (error) {
    if (error instanceof Problem && error.status === 401) return forget();
    const last = error instanceof Unreachable && localStorage.getItem(LAST);
    if (!last) throw error;
    return JSON.parse(last);
  }
}

function forget() {
  localStorage.removeItem(LAST);
  return null;
}

/** Whether somebody holds one of these scopes; admin includes the others. */
export const may = (who, ...scopes) => who.scopes.includes("admin") || scopes.some((scope) => who.scopes.includes(scope));

/** Exchange a key for the cookie; what waited for one goes on. */
export async function showKey(key) {
  await post("/session", { key });
  dispatchEvent(new CustomEvent(KEY_SHOWN));
}

export const leave = () => remove("/session");

/**
 * Links on sheets and of `serve --lan` carry their facts behind `#`: a site, a code, a key.
 * The key leaves the address bar at once; where to go stays.
 */
export async function followLink() {
  const link = new URLSearchParams(location.hash.replace(/^#/, ""));
  if (location.hash.startsWith("#/") || !link.has("site_id")) return;
  const [site, key, code] = ["site_id", "key", "code"].map((name) => link.get(name));
  history.replaceState(null, "", "#/");
  if (key) await showKey(key);
  go(code ? `#/sites/${site}/room?code=${code}` : `#/sites/${site}/phone`);
}
