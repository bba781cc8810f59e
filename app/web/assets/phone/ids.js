// Ids that the page makes itself, so that a snapshot or a trajectory that is sent twice is kept once.

const BITS_48 = 6; // bytes of the time

/** A UUID of version 7 (RFC 9562, section 5.7): it sorts by its time, and is made without a server. */
export function newId(now_ms = Date.now()) {
  const bytes = crypto.getRandomValues(new Uint8Array(16)); // randomUUID is there on secure pages alone
  for (let index = 0; index < BITS_48; index += 1) bytes[index] = Math.floor(now_ms / 256 ** (BITS_48 - 1 - index)) % 256;
  bytes[6] = 0x70 | (bytes[6] & 0x0f);
  bytes[8] = 0x80 | (bytes[8] & 0x3f);
  const hex = [...bytes].map((byte) => byte.toString(16).padStart(2, "0")).join("");
  return hex.replace(/^(.{8})(.{4})(.{4})(.{4})/, "$1-$2-$3-$4-");
}
