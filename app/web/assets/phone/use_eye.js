// The camera as something that takes pictures: what it sees, how large, as which record of the service.
import { useEffect, useRef, useState } from "../core/html.js";
import { useCamera } from "./camera.js";
import { fits, useCameraChoice } from "./cameras.js";
import { frameOf, photoOf, photoSize } from "./picture.js";

const PHOTOGRAPHS = "scattermark:photographs";

/**
 * @param {string} site_id
 * @param {object[]} cameras records of the service
 */
export function useEye(site_id, cameras) {
  const camera = useCamera(true);
  const eye = useRef(null); // the video that pictures are taken from
  const [size, setSize] = useState(null);
  const [chosen, choose] = useCameraChoice(site_id, camera.lens?.label ?? "", size ? `${size.width_px}x${size.height_px}` : "");
  const photo = usePhotographs(camera.stream);
  const record = cameras.find((one) => one.camera_id === chosen);
  return {
    camera, eye, size, setSize, photo, chosen, choose,
    ready: Boolean(camera.stream && size),
    /** A record that shows another cut of the sensor would be refused: then the service decides. */
    recordFor: ({ width_px, height_px }) => (record && fits(record, width_px, height_px) ? record.camera_id : null),
    take: (once) => (once && photo?.wanted ? photoOf(camera.stream.getVideoTracks()[0], photo.size) : frameOf(eye.current)),
  };
}

/** The larger photographs of a camera: their size, and whether they are wanted; null when its stream is as large. */
function usePhotographs(stream) {
  const [size, setSize] = useState(null);
  const [wanted, setWanted] = useState(localStorage.getItem(PHOTOGRAPHS) !== "no");
  useEffect(() => {
    let over = false;
    setSize(null);
    if (stream) photoSize(stream.getVideoTracks()[0]).then((found) => over || setSize(found));
    return () => { over = true; };
  }, [stream]);
  const onChange = (next) => { localStorage.setItem(PHOTOGRAPHS, next ? "yes" : "no"); setWanted(next); };
  return size && { size, wanted, onChange };
}
