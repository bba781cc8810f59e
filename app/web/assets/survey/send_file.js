// One file on its way to the service, with its progress: fetch tells none of an upload, XMLHttpRequest does.
import { KEY_NEEDED, Problem, Unreachable } from "../core/api.js";

/**
 * Send a file as a raw body.
 * @param {string} path
 * @param {Blob} file
 * @param {(sent_bytes: number) => void} onProgress
 * @param {AbortSignal} signal
 * @returns {Promise<any>} the answer's JSON
 */
export function sendFile(path, file, onProgress, signal) {
  return new Promise((resolve, reject) => {
    const request = new XMLHttpRequest();
    const unreachable = () => reject(new Unreachable(new Error("the upload broke off")));
    request.open("PUT", path);
    request.upload.onprogress = (event) => onProgress(event.loaded);
    request.onload = () => settle(request, resolve, reject);
    request.onerror = unreachable;
    request.ontimeout = unreachable;
    request.onabort = () => reject(new DOMException("the upload was stopped", "AbortError"));
    signal.addEventListener("abort", () => request.abort(), { once: true });
    request.send(file);
  });
}

function settle(request, resolve, reject) {
  const members = jsonOf(request.responseText);
  if (request.status >= 200 && request.status < 300) return resolve(members);
  if (request.status === 401) dispatchEvent(new CustomEvent(KEY_NEEDED));
  const retry_after_s = Number(request.getResponseHeader("Retry-After")) || null;
  return reject(Object.assign(new Problem({ ...members, status: request.status }), { retry_after_s }));
}

function jsonOf(text) {
  try {
    return JSON.parse(text);
  } catch {
    return { detail: text };
  }
}
