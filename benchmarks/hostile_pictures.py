"""Pictures without a readable target that try to look as if they had some; each drawn from a seed."""

from __future__ import annotations

from collections.abc import Callable

import cv2
import numpy as np
import numpy.typing as npt

from app.targets.digits import CODE_COUNT
from app.targets.drawing import BLACK_RGB, GREEN_RGB, RED_RGB, WHITE_RGB, cell_colours_rgb, plate_rgb
from app.targets.family import family_by_name
from app.targets.layout import BASE_CELLS, DIGIT_CELLS, DOT_COUNT, DOT_PITCH_U, DOT_RADIUS_U, PLATE_SIDE_U

Pixels = npt.NDArray[np.uint8]
Draw = Callable[[np.random.Generator], Pixels]

WIDTH_PX, HEIGHT_PX = 960, 720
INKS = (RED_RGB, GREEN_RGB, WHITE_RGB, BLACK_RGB)
SUBPIXEL_BITS = 4  # of OpenCV's circles
PLATES = (7, 5)
PLATE_DRAWN_U = 8  # pixels per u of a plate before it is warped into the picture
FAMILY = "golay"


def texture(rng: np.random.Generator, darkness: float = 1.0) -> Pixels:
    """Noise of all sizes in colours that hang together, and shapes with sharp edges: walls, cloth, leaves."""
    light = np.zeros((HEIGHT_PX, WIDTH_PX, 3), dtype=np.float32)
    for cells in (3, 8, 24, 80, 240):
        noise = rng.normal(0.0, 1.0, (cells * 3 // 4 + 1, cells, 1)) * rng.uniform(0.3, 1.0, 3)
        light += cv2.resize(noise.astype(np.float32), (WIDTH_PX, HEIGHT_PX), interpolation=cv2.INTER_CUBIC) * 22.0
    light += np.asarray(rng.uniform(40.0, 190.0, 3), dtype=np.float32)
    picture = np.clip(light * darkness, 0, 255).astype(np.uint8)
    for _ in range(60):
        centre = (int(rng.integers(WIDTH_PX)), int(rng.integers(HEIGHT_PX)))
        axes = (int(rng.integers(3, 60)), int(rng.integers(3, 60)))
        colour = [int(value * darkness) for value in rng.integers(0, 256, 3)]
        cv2.ellipse(picture, centre, axes, float(rng.uniform(0, 180)), 0, 360, colour, -1, cv2.LINE_AA)
    return picture


def disc(picture: Pixels, centre_px: npt.ArrayLike, radius_px: float, rgb: tuple[int, ...]) -> None:
    """An anti-aliased disc at a place between pixels."""
    x, y = (round(float(value) * 2**SUBPIXEL_BITS) for value in np.asarray(centre_px))
    radius = round(radius_px * 2**SUBPIXEL_BITS)
    cv2.circle(picture, (x, y), radius, tuple(int(v) for v in rgb[::-1]), -1, cv2.LINE_AA, SUBPIXEL_BITS)


def as_taken(picture: Pixels, rng: np.random.Generator) -> Pixels:
    """Lens blur, noise and a JPEG file."""
    blurred = cv2.GaussianBlur(picture, (0, 0), rng.uniform(0.5, 1.2)).astype(np.float32)
    noisy = blurred + np.asarray(rng.normal(0.0, rng.uniform(0.5, 4.0), blurred.shape), dtype=np.float32)
    quality = [cv2.IMWRITE_JPEG_QUALITY, int(rng.integers(60, 96))]
    jpeg = cv2.imencode(".jpg", np.clip(noisy, 0, 255).astype(np.uint8), quality)[1]
    return np.asarray(cv2.imdecode(jpeg, cv2.IMREAD_COLOR), dtype=np.uint8)


def polka_grid(rng: np.random.Generator) -> Pixels:
    """Red dots in a grid, on black or on any colour, in the plate's proportions or others."""
    dark = rng.random() < 0.5
    picture = np.full((HEIGHT_PX, WIDTH_PX, 3), rng.integers(0, 40 if dark else 256, 3), dtype=np.uint8)
    pitch_px = rng.uniform(9.0, 40.0)
    radius_px = pitch_px * (rng.choice([DOT_RADIUS_U / DOT_PITCH_U, rng.uniform(0.2, 0.45)]))
    angle = rng.uniform(0.0, np.pi / 2)
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    reach = int(1200 / pitch_px)
    for row in range(-reach, reach):
        for column in range(-reach, reach):
            disc(picture, turn @ [column * pitch_px, row * pitch_px] + [480, 360], radius_px, RED_RGB)
    return picture


def polka_random(rng: np.random.Generator) -> Pixels:
    """Red dots strewn over black or a texture."""
    picture = texture(rng, darkness=rng.choice([0.15, 1.0]))
    radius_px = rng.uniform(3.0, 10.0)
    for _ in range(int(rng.integers(200, 1500))):
        disc(picture, rng.uniform(0, 1, 2) * [WIDTH_PX, HEIGHT_PX], radius_px * rng.uniform(0.9, 1.1), RED_RGB)
    return picture


def led_panel(rng: np.random.Generator) -> Pixels:
    """Lamps in a grid, each red, green, white or off, in the plate's own proportions."""
    picture = np.zeros((HEIGHT_PX, WIDTH_PX, 3), dtype=np.uint8)
    pitch_px, odds = rng.uniform(9.0, 24.0), rng.dirichlet([2.0, 1.0, 1.0, 2.0])
    for y in np.arange(pitch_px, HEIGHT_PX, pitch_px):
        for x in np.arange(pitch_px, WIDTH_PX, pitch_px):
            disc(picture, (x, y), pitch_px * DOT_RADIUS_U / DOT_PITCH_U, INKS[rng.choice(4, p=odds)])
    return picture


def ladybirds(rng: np.random.Generator) -> Pixels:
    """Red beetles with black spots, and black ones with red spots, on leaves."""
    picture = texture(rng)
    picture[..., 1] = np.maximum(picture[..., 1], picture.max(axis=2))
    for _ in range(60):
        at, size = rng.uniform(0, 1, 2) * [WIDTH_PX, HEIGHT_PX], rng.uniform(12.0, 45.0)
        black = (15, 12, 14)
        body, spots = (RED_RGB, black) if rng.random() < 0.5 else (black, RED_RGB)
        disc(picture, at, size, body)
        for spot in rng.uniform(-0.6, 0.6, (int(rng.integers(4, 9)), 2)):
            disc(picture, at + spot * size, size * rng.uniform(0.1, 0.16), spots)
    return picture


def traffic_lights(rng: np.random.Generator) -> Pixels:
    """Dark housings with red, amber and green lamps, by day and by night, and brake lights."""
    picture = texture(rng, darkness=rng.choice([0.1, 1.0]))
    for _ in range(40):
        x, y = rng.uniform(0, 1, 2) * [WIDTH_PX, HEIGHT_PX]
        radius = rng.uniform(3.0, 12.0)
        left, right, top, bottom = (int(v) for v in (x - 2 * radius, x + 8 * radius, y - 2 * radius, y + 8 * radius))
        cv2.rectangle(picture, (left, top), (right, bottom), (18, 18, 18), -1)
        for row, lit in enumerate(((230, 30, 30), (240, 170, 30), (30, 220, 90))):
            for column in range(3):
                colour = lit if rng.random() < 0.7 else (30, 26, 24)
                disc(picture, (x + 3 * radius * column, y + 3 * radius * row), radius, colour)
    return picture


def letters(rng: np.random.Generator) -> Pixels:
    """Red text on black and on paper."""
    picture = np.full((HEIGHT_PX, WIDTH_PX, 3), rng.choice([18, 240]), dtype=np.uint8)
    scale = rng.uniform(0.4, 1.2)
    for row in range(20, HEIGHT_PX, int(28 * scale)):
        text = "".join(rng.choice(list("8oO0:.%&@BDQ*"), 60))
        cv2.putText(picture, text, (5, row), cv2.FONT_HERSHEY_DUPLEX, scale, (30, 30, 210), 2, cv2.LINE_AA)
    return picture


def square_tags(rng: np.random.Generator) -> Pixels:
    """Square tags of black and white cells, some printed in red."""
    picture = texture(rng)
    for y in range(20, HEIGHT_PX - 90, 100):
        for x in range(20, WIDTH_PX - 90, 100):
            cells = np.zeros((10, 10, 3), dtype=np.uint8)
            inks = np.array([(255, 255, 255), (0, 0, 0), RED_RGB[::-1]], dtype=np.uint8)
            cells[1:9, 1:9] = inks[rng.choice(3, (8, 8), p=[0.4, 0.4, 0.2])]
            picture[y : y + 80, x : x + 80] = cv2.resize(cells, (80, 80), interpolation=cv2.INTER_NEAREST)
    return picture


def colour_test(rng: np.random.Generator) -> Pixels:
    """Dots of all sizes in red, green and brown, packed as in a test for colour blindness."""
    picture = np.full((HEIGHT_PX, WIDTH_PX, 3), rng.choice([20, 235]), dtype=np.uint8)
    for _ in range(4000):
        base = np.array(INKS[int(rng.integers(3))]) + rng.integers(-30, 30, 3)
        at = rng.uniform(0, 1, 2) * [WIDTH_PX, HEIGHT_PX]
        disc(picture, at, rng.uniform(3.0, 9.0), tuple(np.clip(base, 0, 255)))
    return picture


def _plates(rng: np.random.Generator, draw_plate: Callable[[int], Pixels]) -> Pixels:
    """Plates as ``draw_plate`` draws each code, turned and slanted, all over a texture."""
    picture = texture(rng)
    columns, rows = PLATES
    for code, index in zip(rng.choice(family_by_name(FAMILY).codes, columns * rows, False), range(99), strict=False):
        plate = draw_plate(int(code))
        row, column = divmod(index, columns)
        middle = np.array([(column + 0.5) * WIDTH_PX / columns, (row + 0.5) * HEIGHT_PX / rows])
        angle, half = rng.uniform(0.0, 2.0 * np.pi), rng.uniform(16.0, 46.0)
        corners = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]) * [half, half * rng.uniform(0.6, 1.0)]
        turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
        side = plate.shape[0]
        from_px = np.array([[0, 0], [side, 0], [side, side], [0, side]], dtype=np.float32)
        onto = cv2.getPerspectiveTransform(from_px, (corners @ turn.T + middle).astype(np.float32))
        warped = cv2.warpPerspective(plate, onto, (WIDTH_PX, HEIGHT_PX), flags=cv2.INTER_AREA)
        cover = cv2.warpPerspective(np.full((side, side), 255, np.uint8), onto, (WIDTH_PX, HEIGHT_PX))
        share = cover[..., None] / np.float32(255.0)
        picture = (picture * (1.0 - share) + warped * share).astype(np.uint8)
    return picture


def _plate_of_cells(cells_rgb: Pixels, centres_off_u: npt.NDArray[np.float64] | None = None) -> Pixels:
    """A plate with dots of any colours, some moved, BGR, within white paper of 1 u."""
    n = PLATE_DRAWN_U
    side = round(PLATE_SIDE_U + 2) * n
    plate = np.full((side, side, 3), 255, dtype=np.uint8)
    plate[n : side - n, n : side - n] = BLACK_RGB[::-1]
    off_u = np.zeros((DOT_COUNT, 2)) if centres_off_u is None else centres_off_u
    for cell in range(DOT_COUNT):
        row, column = divmod(cell, 4)
        at = (np.array([column, row]) * DOT_PITCH_U + 3.0 + off_u[cell]) * n - 0.5
        disc(plate, at, DOT_RADIUS_U * n, tuple(int(v) for v in cells_rgb[cell]))
    return plate


def missing_dots(rng: np.random.Generator) -> Pixels:
    """Plates of which a base dot was never printed."""

    def plate(code: int) -> Pixels:
        cells = cell_colours_rgb(code)
        cells[rng.choice(BASE_CELLS)] = BLACK_RGB
        return _plate_of_cells(cells)

    return _plates(rng, plate)


def extra_dots(rng: np.random.Generator) -> Pixels:
    """Plates with a red dot too many, in a place where a digit should be."""

    def plate(code: int) -> Pixels:
        cells = cell_colours_rgb(code)
        cells[rng.choice(DIGIT_CELLS, int(rng.integers(3, 6)), replace=False)] = RED_RGB
        return _plate_of_cells(cells)

    return _plates(rng, plate)


def moved_dots(rng: np.random.Generator) -> Pixels:
    """Plates of which the base dot E, or all dots, stand where they should not."""

    def plate(code: int) -> Pixels:
        cells, off_u = cell_colours_rgb(code), np.zeros((DOT_COUNT, 2))
        if rng.random() < 0.5:
            other = int(rng.choice([1, 2, 4, 7, 8, 11, 13, 14]))
            cells[[BASE_CELLS[4], other]] = cells[[other, BASE_CELLS[4]]]
        else:
            off_u = rng.normal(0.0, 0.6, (DOT_COUNT, 2))
        return _plate_of_cells(cells, off_u)

    return _plates(rng, plate)


def swapped_colours(rng: np.random.Generator) -> Pixels:
    """Plates whose red is green, blue or orange and the other way round."""

    def plate(code: int) -> Pixels:
        cells = cell_colours_rgb(code)
        order = [(1, 0, 2), (2, 1, 0), (1, 2, 0), (0, 2, 1)][int(rng.integers(3))]
        return _plate_of_cells(np.ascontiguousarray(cells[:, order]))

    return _plates(rng, plate)


def mirrored(rng: np.random.Generator) -> Pixels:
    """Plates in a mirror."""
    return np.ascontiguousarray(_plates(rng, _right_plate)[:, ::-1])


def negative(rng: np.random.Generator) -> Pixels:
    """Plates as a film's negative shows them."""
    return np.asarray(255 - _plates(rng, _right_plate), dtype=np.uint8)


def half_plates(rng: np.random.Generator) -> Pixels:
    """Plates cut through the middle, as at the edge of a screenshot."""

    def plate(code: int) -> Pixels:
        whole = _right_plate(code)
        quarter = int(rng.integers(4))
        turned = np.rot90(whole, quarter).copy()
        turned[: round(len(turned) * rng.uniform(0.4, 0.6))] = rng.choice([0, 128, 255])
        return np.ascontiguousarray(np.rot90(turned, -quarter))

    return _plates(rng, plate)


def _right_plate(code: int) -> Pixels:
    plate = plate_rgb(code, PLATE_DRAWN_U)[..., ::-1]
    n = PLATE_DRAWN_U
    return np.ascontiguousarray(np.pad(plate, ((n, n), (n, n), (0, 0)), constant_values=255))


def other_family(rng: np.random.Generator) -> Pixels:
    """Right plates that say any word of the 3^11: nearly all of another family."""
    return _plates(rng, lambda _: _plate_of_cells(cell_colours_rgb(int(rng.integers(1, CODE_COUNT)))))


KINDS: dict[str, Draw] = {
    "red polka dots, in a grid": polka_grid,
    "red polka dots, at random": polka_random,
    "LED panels": led_panel,
    "ladybirds": ladybirds,
    "traffic lights": traffic_lights,
    "red letters": letters,
    "square tags": square_tags,
    "colour tests": colour_test,
    "plates without a base dot": missing_dots,
    "plates with red dots too many": extra_dots,
    "plates with dots moved": moved_dots,
    "plates in swapped colours": swapped_colours,
    "plates in a mirror": mirrored,
    "plates as negatives": negative,
    "half plates": half_plates,
}
# Not a picture without targets: how often a word of another family passes for a code is the family's to say.
FOREIGN = "plates of another family"


def hostile_picture(kind: str, seed: int) -> Pixels:
    """The picture of a kind, as a phone's file shows it; the same arguments give the same pixels."""
    rng = np.random.default_rng(seed)
    draw = other_family if kind == FOREIGN else KINDS[kind]
    return as_taken(draw(rng), rng)
