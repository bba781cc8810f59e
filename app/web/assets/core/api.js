// Calls to the service: JSON in and out, problems (RFC 9457) as errors, lists page by page, events.

export const KEY_NEEDED = "scattermark:key-needed"; // told to the window when the service asks who calls
export const KEY_SHOWN = "scattermark:key-shown"; // and when it knows again

/** An answer that is a problem: what happened and what to do stands in `message`. */
export class Problem extends Error {
  /** @param {{type?: string, title?: string, status: number, detail?: string}} members */
  constructor(members) {
    super(members.detail || members.title || `the server answered ${members.status}`);
    this.members = members;
    this.status = members.status;
    this.kind = (members.type || "").split("/").pop();
  }
}

/** The server could not be reached at all: worth another try, unlike a problem. */
export class Unreachable extends Error {
  constructor(cause) {
    super("the server cannot be reached; is it running, and is this device in its network?", { cause });
  }
}

/** Answers that say: the server has too much to do; nothing is wrong with what was asked. */
export const FULL = [429, 503, 504];

/** After how many seconds a full server may be asked again; null when it was not that. */
export const laterOf = (error) => (FULL.includes(error.status) ? error.members?.retry_after_s ?? null : null);

/**
 * One call.
 * @param {string} path from the root, with its query
 * @param {{method?: string, json?: unknown, body?: BodyInit, headers?: Record<string, string>, signal?: AbortSignal}} [options]
 * @returns {Promise<Response>} of success
 */
export async function call(path, { method = "GET", json, body, headers = {}, signal } = {}) {
  const sent = json === undefined ? { body, headers } : { body: JSON.stringify(json), headers: { "Content-Type": "application/json", ...headers } };
  let answer;
  try {
    answer = await fetch(path, { method, signal, credentials: "same-origin", ...sent });
  } catch (error) {
    if (error.name === "AbortError") throw error;
    throw new Unreachable(error);
  }
  if (!answer.ok) throw await problemOf(answer);
  return answer;
}

/** @param {Response} answer */
async function problemOf(answer) {
  const type = answer.headers.get("content-type") || "";
  const members = type.includes("json") ? await answer.json() : { detail: await answer.text() };
  const problem = new Problem({ ...members, status: answer.status });
  if (problem.status === 401) dispatchEvent(new CustomEvent(KEY_NEEDED));
  return problem;
}

export const get = async (path, options) => (await call(path, options)).json();
export const post = async (path, json, options) => readOf(await call(path, { method: "POST", json, ...options }));
export const patch = async (path, json) => readOf(await call(path, { method: "PATCH", json }));
export const put = async (path, options) => readOf(await call(path, { method: "PUT", ...options }));
export const remove = async (path) => readOf(await call(path, { method: "DELETE" }));

const readOf = (answer) => (answer.status === 204 ? null : answer.json());

/** A path with its query; parameters that are null or undefined are left out. */
export function address(path, parameters = {}) {
  const query = new URLSearchParams(Object.entries(parameters).filter(([, value]) => value !== null && value !== undefined));
  return query.size ? `${path}?${query}` : path;
}

/** A list whole: every page of it, at most `most` items. */
export async function all(path, name, parameters = {}, most = 100000) {
  const items = [];
  let cursor = null;
  do {
    const page = await get(address(path, { limit: 1000, ...parameters, cursor }));
    items.push(...page[name]);
    cursor = page.next_cursor;
  } while (cursor && items.length < most);
  return items;
}
