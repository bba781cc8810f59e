// Control points that were typed and are not saved yet; kept while the tab is open, through other pages and reloads.
const keyOf = (siteId) => `points ${siteId}`;

/** @returns {Array<Record<string, string>> | null} the rows, null when there are none */
export const draftOf = (siteId) => JSON.parse(sessionStorage.getItem(keyOf(siteId)) ?? "null");

/** Keep rows; null forgets them. */
export function keepDraft(siteId, rows) {
  if (rows) sessionStorage.setItem(keyOf(siteId), JSON.stringify(rows));
  else sessionStorage.removeItem(keyOf(siteId));
}
