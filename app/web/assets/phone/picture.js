// A picture of what the camera sees now, as a file, with the moment in which it was taken.

const QUALITY = 0.95; // of JPEG: dots are measured to hundredths of a pixel
const BROWSERS_DELAY_S = 0.05; // between a frame and its showing, where the browser does not tell: a frame or two of most cameras
const PATIENCE_MS = 5000; // a camera that films gives the next frame long before

/** @typedef {{blob: Blob, width_px: number, height_px: number, captured_ms: number, spread_s: number}} Picture `captured_ms` by the phone's clock, wrong by `spread_s` at most */

/** The next frame that is shown, in all its pixels: each is given once. @returns {Promise<Picture>} */
export async function frameOf(video) {
  const canvas = Object.assign(document.createElement("canvas"), { width: video.videoWidth, height: video.videoHeight });
  const moment = await withNextFrame(video, () => canvas.getContext("2d").drawImage(video, 0, 0));
  const blob = await new Promise((resolve) => canvas.toBlob(resolve, "image/jpeg", QUALITY));
  return { blob, width_px: canvas.width, height_px: canvas.height, ...moment };
}

/** Look at the next frame while it is the one that is shown, and tell when it was captured: a moment later it may be another. */
function withNextFrame(video, look) {
  const shown = () => ({ captured_ms: Date.now() - 500 * BROWSERS_DELAY_S, spread_s: BROWSERS_DELAY_S / 2 });
  if (!video.requestVideoFrameCallback) { look(); return Promise.resolve(shown()); }
  return new Promise((resolve, reject) => {
    const timer = setTimeout(() => { video.cancelVideoFrameCallback(handle); reject(new Error("the camera gave no picture; try again")); }, PATIENCE_MS);
    const handle = video.requestVideoFrameCallback((_now, { captureTime }) => {
      clearTimeout(timer);
      look();
      resolve(captureTime === undefined ? shown() : { captured_ms: wall_ms(captureTime), spread_s: 0 });
    });
  });
}

/** The phone's clock at a time of the page's. */
const wall_ms = (page_ms) => Date.now() - (performance.now() - page_ms);

/**
 * How large a photograph the camera takes when it is not filming; null when that is no larger than its stream.
 * @param {MediaStreamTrack} track
 */
export async function photoSize(track) {
  if (!window.ImageCapture) return null;
  const { width, height } = track.getSettings();
  const told = await new ImageCapture(track).getPhotoCapabilities().catch(() => null); // a camera that says nothing only films
  const [wide, high] = [told?.imageWidth?.max ?? 0, told?.imageHeight?.max ?? 0];
  return wide * high > width * height ? { width_px: wide, height_px: high } : null;
}

/** @returns {Promise<Picture>} a photograph: it was taken at some time between the wish and its coming */
export async function photoOf(track, { width_px, height_px }) {
  const asked_ms = Date.now();
  const blob = await new ImageCapture(track).takePhoto({ imageWidth: width_px, imageHeight: height_px });
  const lasted_ms = Date.now() - asked_ms;
  const { width, height } = await createImageBitmap(blob);
  return { blob, width_px: width, height_px: height, captured_ms: asked_ms + lasted_ms / 2, spread_s: lasted_ms / 2000 };
}
