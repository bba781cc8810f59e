// Keeps the pages' files on the device, so that they open without a network. Before this text the server writes
// `VERSION`, which changes whenever one of the files does, and `FILES`, all of them. Answers of the interface are not kept.

const PREFIX = "scattermark-files-";
const CACHE = PREFIX + VERSION;
const SLOW_MS = 5000; // then what is kept is shown: a network of one bar may take minutes

self.addEventListener("install", (event) => event.waitUntil(keepFiles()));
self.addEventListener("activate", (event) => event.waitUntil(replaceOlder()));
self.addEventListener("fetch", (event) => {
  const { request } = event;
  const { origin, pathname } = new URL(request.url);
  if (request.method === "GET" && origin === location.origin && FILES.includes(pathname)) event.respondWith(answer(request, pathname));
});

/** All files of one version, or none. */
async function keepFiles() {
  const cache = await caches.open(CACHE);
  await cache.addAll(FILES.map((path) => new Request(path, { cache: "no-cache" })));
  await self.skipWaiting();
}

async function replaceOlder() {
  const names = await caches.keys();
  await Promise.all(names.filter((name) => name.startsWith(PREFIX) && name !== CACHE).map((name) => caches.delete(name)));
  await self.clients.claim();
}

/** The network's word, and what is kept when it has none. */
async function answer(request, pathname) {
  const kept = await caches.match(pathname, { cacheName: CACHE, ignoreVary: true });
  if (!kept) return fetch(request);
  const slow = new Promise((resolve) => { setTimeout(() => resolve(kept), SLOW_MS); });
  return Promise.race([fetch(request).catch(() => kept), slow]);
}
