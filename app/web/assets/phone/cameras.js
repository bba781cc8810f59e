// Which camera record of the service stands for this phone's pictures: chosen once, remembered for each lens and size.
import { useState } from "../core/html.js";

const ASPECT_TOLERANCE = 0.01; // as the service has it (app/photogrammetry/camera_for_photo.py)

/** Whether a camera record shows the same cut of the sensor as a picture of this size, upright or on its side. */
export function fits(camera, width_px, height_px) {
  const [wanted, known] = [width_px / height_px, camera.width_px / camera.height_px];
  return Math.abs(wanted / known - 1) <= ASPECT_TOLERANCE || Math.abs(wanted * known - 1) <= ASPECT_TOLERANCE;
}

const nameOfKey = (site_id, lens, size) => `scattermark:camera:${site_id}:${lens}:${size}`;

/** A camera record in a line. */
export const cameraText = (camera) => `${`${camera.make} ${camera.model}`.trim() || "unnamed camera"}, ${camera.width_px} × ${camera.height_px}${camera.device_id ? `, ${camera.device_id}` : ""} (${camera.source})`;

/**
 * The record that is chosen for a lens at a size; null leaves it to the service.
 * @returns {[string | null, (camera_id: string | null) => void]}
 */
export function useCameraChoice(site_id, lens, size) {
  const key = nameOfKey(site_id, lens, size);
  const [, setTurn] = useState(0);
  const choose = (camera_id) => {
    camera_id ? localStorage.setItem(key, camera_id) : localStorage.removeItem(key);
    setTurn((before) => before + 1);
  };
  return [localStorage.getItem(key), choose];
}

/** Whether the service will know the camera of a picture without EXIF when none is named: as services/choose_camera.py decides. */
export function knownWithoutName(cameras, device_id, width_px, height_px) {
  const fitting = cameras.filter((camera) => fits(camera, width_px, height_px));
  return fitting.find((camera) => camera.device_id === device_id) ?? (new Set(fitting.map((camera) => `${camera.make}/${camera.model}`)).size === 1 ? fitting.at(-1) : null);
}
