// Names of pictures that have none of their own.

/** "photo 2026-05-01-09-30-00-250.jpg": phones call every picture "image.jpg", and a survey takes each name once. */
export const nameNow = (kind, ending) => `${kind} ${new Date().toISOString().slice(0, 23).replace(/[T:.]/g, "-")}${ending}`;
