// A file's SHA-256, by which the service knows a photograph.

/** Whether this page can compute digests: browsers let only pages of HTTPS and of this very machine do so. */
export const canDigest = () => Boolean(globalThis.crypto?.subtle);

/**
 * @param {Blob} file
 * @returns {Promise<string>} hexadecimal digits
 */
export async function sha256Of(file) {
  const digest = await crypto.subtle.digest("SHA-256", await file.arrayBuffer());
  return [...new Uint8Array(digest)].map((byte) => byte.toString(16).padStart(2, "0")).join("");
}
