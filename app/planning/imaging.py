"""Light to pixels: lens blur, shake, vignetting, exposure, noise, the phone's tone curve."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import cv2
import numpy as np
import numpy.typing as npt

from app.planning.tone import develop

Light = npt.NDArray[np.float32]
Chroma = Literal["4:2:0", "4:2:2", "4:4:4"]

KERNEL_STEPS = 16  # per pixel: a kernel's shape is drawn this fine, then binned
DARKEST_LIGHT = 1e-4  # below any ink in any shade: keeps the logarithm finite
SHARPENING_SIGMA_PX = 1.0


@dataclass(frozen=True)
class ImagingOptions:
    """One phone at one setting; the defaults are a steady hand in good light.

    Attributes
    ----------
    exposure_ev : float
        Stops above (+) or below (-) what the metering chooses.
    metered_level : float
        Linear light that the metering gives the picture's geometric mean: the classical grey of 18 % and a quarter of
        a stop, since phones expose brightly.
    white_balance_rgb : tuple of float
        Gain of each channel.
    lens_sigma_px : float
        Gaussian blur of lens and demosaicing; phones at full resolution lie at 0.5 ... 0.9.
    defocus_radius_px : float
        Radius of the disc that a point becomes.
    motion_px : tuple of float
        How far the picture moves during the exposure, along columns and rows.
    vignetting : float
        Share of light that the corners lose.
    veiling_glare : float
        Share of the picture's mean light that the lens scatters over all of it: 0.01 of a clean lens, 0.1 of a
        fingerprint against a window.
    full_well_electrons : float
        Electrons of a saturated pixel: 5,000 at base ISO, a few hundred in dim rooms. 0 switches all noise off.
    read_noise_electrons : float
        Standard deviation per pixel.
    contrast : float
        S-curve on top of sRGB, 0 ... 1.
    sharpening : float
        Amount of unsharp masking after the tone curve, as phones do; 0.3 is common.
    jpeg_quality : int
        1 ... 100.
    chroma : str
        How much of the colour's resolution the file keeps: ``4:2:0`` half along both axes, as phones do, ``4:4:4`` all.
    make, model : str
        What EXIF says.
    focal_mm : float
        Real focal length that EXIF tells; the 35 mm equivalent follows from the camera.
    captured_at : str
        EXIF's time; a fraction of the second may follow.
    write_exif : bool
        False for a file that says nothing of its camera.
    """

    exposure_ev: float = 0.0
    metered_level: float = 0.22
    white_balance_rgb: tuple[float, float, float] = (1.0, 1.0, 1.0)
    lens_sigma_px: float = 0.6
    defocus_radius_px: float = 0.0
    motion_px: tuple[float, float] = (0.0, 0.0)
    vignetting: float = 0.2
    veiling_glare: float = 0.0
    full_well_electrons: float = 5_000.0
    read_noise_electrons: float = 3.0
    contrast: float = 0.25
    sharpening: float = 0.0
    jpeg_quality: int = 93
    chroma: Chroma = "4:2:0"
    make: str = "Scattermark"
    model: str = "Synthetic"
    focal_mm: float = 4.0
    captured_at: str = "2026:01:01 12:00:00"
    write_exif: bool = True


def expose(light: Light, imaging: ImagingOptions) -> Light:
    """Light on the sensor, shape (H, W, 3), linear, 1 saturates: blurred, vignetted and metered, without noise."""
    sensor = cv2.GaussianBlur(light, (0, 0), imaging.lens_sigma_px) if imaging.lens_sigma_px > 0 else light
    kernel = blur_kernel(imaging.defocus_radius_px, imaging.motion_px)
    if kernel.size > 1:
        sensor = cv2.filter2D(sensor, -1, kernel, borderType=cv2.BORDER_REPLICATE)
    if imaging.veiling_glare > 0:
        sensor = sensor + np.float32(imaging.veiling_glare) * sensor.mean(axis=(0, 1))
    sensor = sensor * _vignette(light.shape[0], light.shape[1], imaging.vignetting)
    mean_light = float(np.exp(np.log(np.maximum(sensor, DARKEST_LIGHT)).mean()))
    gain = imaging.metered_level / mean_light * 2.0**imaging.exposure_ev
    return np.asarray(sensor * (gain * np.array(imaging.white_balance_rgb)).astype(np.float32))


def digitise(sensor: Light, imaging: ImagingOptions, rng: np.random.Generator) -> npt.NDArray[np.uint8]:
    """8-bit RGB, shape (H, W, 3), of light on the sensor: shot and read noise, tone curve, sharpening."""
    saturated = np.minimum(sensor, np.float32(1.0))
    if imaging.full_well_electrons > 0:
        # Photon counts scatter by their root; read noise comes on top: both relative to the full well.
        read_variance = np.float32((imaging.read_noise_electrons / imaging.full_well_electrons) ** 2)
        sigma = np.sqrt(saturated / np.float32(imaging.full_well_electrons) + read_variance)
        saturated = saturated + sigma * rng.standard_normal(saturated.shape, dtype=np.float32)
    rgb = develop(saturated, imaging.contrast)
    if imaging.sharpening > 0:
        smooth = cv2.GaussianBlur(rgb, (0, 0), SHARPENING_SIGMA_PX)
        rgb = np.asarray(cv2.addWeighted(rgb, 1.0 + imaging.sharpening, smooth, -imaging.sharpening, 0.0), np.uint8)
    return rgb


def blur_kernel(defocus_radius_px: float, motion_px: tuple[float, float]) -> npt.NDArray[np.float32]:
    """Disc of the defocus smeared along the motion, shape (K, K), K odd; symmetric, so that it moves no centroid."""
    reach = int(np.ceil(defocus_radius_px + max(np.abs(motion_px)) / 2))
    if reach == 0:
        return np.ones((1, 1), dtype=np.float32)
    size = 2 * reach + 1
    fine = (np.arange(size * KERNEL_STEPS) + 0.5) / KERNEL_STEPS - size / 2
    x_px, y_px = np.meshgrid(fine, fine)
    # Distance from the path of the centre, of which the disc and half a pixel around belong to the kernel.
    length2 = motion_px[0] ** 2 + motion_px[1] ** 2
    along = np.clip((x_px * motion_px[0] + y_px * motion_px[1]) / length2, -0.5, 0.5) if length2 > 0 else 0.0 * x_px
    away_px = np.hypot(x_px - along * motion_px[0], y_px - along * motion_px[1])
    inside = away_px <= max(defocus_radius_px, 1.0 / KERNEL_STEPS)
    kernel = inside.reshape(size, KERNEL_STEPS, size, KERNEL_STEPS).sum(axis=(1, 3)).astype(np.float64)
    return np.asarray(kernel / kernel.sum(), dtype=np.float32)


def _vignette(height_px: int, width_px: int, loss: float) -> Light:
    """Share of light that arrives, shape (H, W, 1): falls with the square of the distance from the middle."""
    x = np.linspace(-1.0, 1.0, width_px, dtype=np.float32) ** 2 * (width_px**2 / (width_px**2 + height_px**2))
    y = np.linspace(-1.0, 1.0, height_px, dtype=np.float32) ** 2 * (height_px**2 / (width_px**2 + height_px**2))
    return np.asarray(1.0 - np.float32(loss) * (y[:, None] + x), dtype=np.float32)[..., None]
