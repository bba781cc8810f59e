// The phone's own store: IndexedDB as promises. It outlives tabs and lost networks.

const NAME = "scattermark";
const VERSION = 1;

let opening = null;

/** The device has no room for what should be kept. */
export class DeviceFull extends Error {
  constructor(cause) {
    super("this device has no room left for pictures: send those that wait, or free some of its storage", { cause });
  }
}

function open() {
  return new Promise((resolve, reject) => {
    const request = indexedDB.open(NAME, VERSION);
    request.onupgradeneeded = () => makeStores(request.result);
    request.onsuccess = () => resolve(request.result);
    request.onerror = () => reject(request.error);
  });
}

/** Tasks in the order they came, their pictures beside them, what came of them, and what is known of sites. */
function makeStores(database) {
  for (const name of ["tasks", "results"]) database.createObjectStore(name, { keyPath: "number", autoIncrement: true }).createIndex("site_id", "site_id");
  database.createObjectStore("pictures");
  database.createObjectStore("rooms", { keyPath: "site_id" });
}

/** What a request of IndexedDB comes to. */
export const done = (request) => new Promise((resolve, reject) => {
  request.onsuccess = () => resolve(request.result);
  request.onerror = () => reject(request.error);
});

/**
 * Some work on stores that happens whole or not at all.
 * @template T
 * @param {string[]} names
 * @param {"readonly" | "readwrite"} mode
 * @param {(store: (name: string) => IDBObjectStore) => Promise<T>} work awaits nothing but requests of these stores
 * @returns {Promise<T>}
 */
export async function transact(names, mode, work) {
  opening ??= open();
  const transaction = (await opening).transaction(names, mode);
  const ended = new Promise((resolve, reject) => {
    transaction.oncomplete = resolve;
    transaction.onabort = () => reject(transaction.error);
  });
  try {
    const result = await work((name) => transaction.objectStore(name));
    await ended;
    return result;
  } catch (error) {
    ended.catch(() => {}); // it is told once
    throw error.name === "QuotaExceededError" ? new DeviceFull(error) : error;
  }
}
