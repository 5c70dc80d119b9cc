"""What real cameras do to images, done to images of a recorded sequence.

A kind is a function from a sequence and a random generator to a camera.yaml and shots. Motion is that of the ground truth's
rotation: shifts of the whole image, as if the scene were far away.
"""

import io

import numpy as np
from PIL import Image

from perturbations.sequence import Shot, turn_rates_of

SLOW_HZ = 7.5
GAMMA = 2.2  # from light to what a screen is given
EXPOSED_SHARE = 0.5  # of the time between two images
READ_OUT_SHARE = 0.8  # of it, a rolling shutter takes from the first row to the last
PERSON_DISTANCE_M, PERSON_WIDTH_M, PERSON_SPEED_MPS, PERSON_PERIOD_S = 1.3, 0.5, 1.0, 5.0
DEPTH_FOCAL_RATIO, DEPTH_OFFSET_M = 1.11, 0.025


def looks(change):
    """A kind that changes each colour image alone: `change` is a function of it and of the random generator."""
    def kind(sequence, random):
        return sequence.camera, (Shot(shot.stamp_s, change(shot.color, random), shot.depth) for shot in sequence.shots())
    return kind


def calibration(**factors):
    """A kind that states wrong numbers in camera.yaml: these times the true ones."""
    def kind(sequence, _):
        camera = sequence.camera | {key: sequence.camera[key] * factor for key, factor in factors.items()}
        return camera, sequence.shots()
    return kind


def as_it_is(sequence, _):
    return sequence.camera, sequence.shots()


def fewer_frames(sequence, step):
    camera = sequence.camera | {"fps": sequence.rate_hz / step}
    return camera, (shot for i, shot in enumerate(sequence.shots()) if i % step == 0)


def every_second(sequence, _):
    return fewer_frames(sequence, 2)


def slow(sequence, _):
    return fewer_frames(sequence, max(1, round(sequence.rate_hz / SLOW_HZ)))


def gamma(exponent):
    table = np.round(255.0 * (np.arange(256) / 255.0) ** exponent).astype(np.uint8)
    return looks(lambda color, _: table[color])


def jpeg(quality):
    def encoded(color, _):
        stream = io.BytesIO()
        Image.fromarray(color).save(stream, "jpeg", quality=quality)
        return stream.getvalue()
    return looks(encoded)


def light_of(color):
    return (color / 255.0) ** GAMMA


def color_of(light):
    return np.round(255.0 * np.minimum(light, 1.0) ** (1.0 / GAMMA)).astype(np.uint8)


def exposure_jumps(sequence, _):
    """Light doubles and halves from one second to the next; what is too bright is white."""
    def shots():
        for shot in sequence.shots():
            factor = (1.0, 2.0, 1.0, 0.5)[int(shot.stamp_s) % 4]
            yield Shot(shot.stamp_s, color_of(factor * light_of(shot.color)), shot.depth)
    return sequence.camera, shots()


def flows_of(sequence):
    """Shift of the image's centre in the time between two images, at each of them [n, 2, in px]."""
    turns = turn_rates_of(sequence) / sequence.rate_hz
    return np.stack((-sequence.camera["fx"] * turns[:, 1], sequence.camera["fy"] * turns[:, 0]), axis=1)


def shifted(image, shift_px):
    """The image moved by whole pixels; what comes in repeats the border."""
    rows = np.clip(np.arange(image.shape[0]) - round(float(shift_px[1])), 0, image.shape[0] - 1)
    columns = np.clip(np.arange(image.shape[1]) - round(float(shift_px[0])), 0, image.shape[1] - 1)
    return image[rows[:, None], columns]


def motion_blur(sequence, _):
    flows = flows_of(sequence)

    def shots():
        for shot, flow in zip(sequence.shots(), flows):
            steps = int(np.ceil(np.abs(EXPOSED_SHARE * flow).max())) + 1
            light = light_of(shot.color)
            parts = [shifted(light, EXPOSED_SHARE * flow * at) for at in np.linspace(-0.5, 0.5, steps)]
            yield Shot(shot.stamp_s, color_of(np.mean(parts, axis=0)), shot.depth)
    return sequence.camera, shots()


def rolling_shutter(sequence, _):
    """Each row of the colour image is of an instant of its own; depth is not."""
    flows = flows_of(sequence)

    def shots():
        for shot, flow in zip(sequence.shots(), flows):
            height, width = shot.depth.shape
            when = READ_OUT_SHARE * (np.arange(height) / height - 0.5)
            rows = np.clip(np.arange(height) - np.round(when * flow[1]).astype(int), 0, height - 1)
            columns = np.arange(width)[None, :] - np.round(when * flow[0]).astype(int)[:, None]
            yield Shot(shot.stamp_s, shot.color[rows[:, None], np.clip(columns, 0, width - 1)], shot.depth)
    return sequence.camera, shots()


def late_depth(sequence, _):
    """Half the images, each with the depth of half a period later."""
    def shots():
        stamp_s, color = None, None
        for shot in sequence.shots():
            if color is None:
                stamp_s, color = shot.stamp_s, shot.color
                continue
            yield Shot(stamp_s, color, shot.depth)
            stamp_s, color = None, None
    return sequence.camera | {"fps": sequence.rate_hz / 2}, shots()


def holes(sequence, random):
    """A tenth of the depth is missing in spots, and pixels at edges hover between near and far."""
    def shots():
        for shot in sequence.shots():
            yield Shot(shot.stamp_s, shot.color, without_spots(with_flying_pixels(shot.depth, random), random))
    return sequence.camera, shots()


def with_flying_pixels(depth, random):
    near, far = depth.astype(np.float64), depth.astype(np.float64)
    height, width = depth.shape
    around = np.pad(depth, 1, mode="edge")
    for row, column in ((0, 1), (2, 1), (1, 0), (1, 2)):
        other = around[row:row + height, column:column + width]
        near = np.where(other > 0, np.minimum(near, other), near)
        far = np.maximum(far, other)
    is_edge = (depth > 0) & (far > 1.05 * near)
    between = near + random.random(depth.shape) * (far - near)
    return np.where(is_edge, np.round(between), depth).astype(np.uint16)


def without_spots(depth, random):
    """Spots of 6 to 24 px, as many as cover a tenth of the image."""
    out = depth.copy()
    height, width = depth.shape
    covered = 0.0
    while covered < 0.1 * height * width:
        radius = int(random.integers(3, 13))
        row, column = int(random.integers(height)), int(random.integers(width))
        rows, columns = (slice(max(at - radius, 0), at + radius + 1) for at in (row, column))
        y, x = np.ogrid[rows.start:min(rows.stop, height), columns.start:min(columns.stop, width)]
        out[rows, columns][(y - row) ** 2 + (x - column) ** 2 <= radius ** 2] = 0
        covered += np.pi * radius ** 2
    return out


def unregistered_depth(sequence, _):
    """Depth as a camera of its own gives it: another focal length, and 2.5 cm to the left. camera.yaml does not say so."""
    def shots():
        for shot in sequence.shots():
            yield Shot(shot.stamp_s, shot.color, seen_by_depth_camera(shot.depth, sequence.camera))
    return sequence.camera, shots()


def depth_camera_of_its_own(sequence, _):
    """The same, and camera.yaml says so."""
    camera, shots = unregistered_depth(sequence, _)
    own = {key: camera[key] for key in ("width", "height", "cx", "cy")}
    own |= {key: DEPTH_FOCAL_RATIO * camera[key] for key in ("fx", "fy")}
    return camera | {"depth": own | {"position": [-DEPTH_OFFSET_M, 0.0, 0.0]}}, shots


def seen_by_depth_camera(depth, camera):
    """What a camera with DEPTH_FOCAL_RATIO times the focal length, DEPTH_OFFSET_M to the left, measures of these surfaces: at
    the centre of each of its pixels the nearest one."""
    height, width = depth.shape
    v, u = np.nonzero(depth)
    near = np.divide(1.0, depth, where=depth > 0, out=np.zeros(depth.shape))  # on a plane, linear in the pixel
    down_by, right_by = (slope(near, axis)[v, u] / DEPTH_FOCAL_RATIO for axis in (0, 1))
    z = depth[v, u] / camera["depth_scale"]
    x = (u - camera["cx"]) * z / camera["fx"] + DEPTH_OFFSET_M
    y = (v - camera["cy"]) * z / camera["fy"]
    column = DEPTH_FOCAL_RATIO * camera["fx"] * x / z + camera["cx"]
    row = DEPTH_FOCAL_RATIO * camera["fy"] * y / z + camera["cy"]
    reach = 0.5 * DEPTH_FOCAL_RATIO + 0.1  # slanted surfaces: neighbours are further apart
    nearest = np.zeros((height, width))
    for down in (0, 1):
        for right in (0, 1):
            rows, columns = (np.floor(row) + down).astype(int), (np.floor(column) + right).astype(int)
            inside = (rows >= 0) & (rows < height) & (columns >= 0) & (columns < width)
            inside &= (np.abs(rows - row) < reach) & (np.abs(columns - column) < reach)
            here = near[v, u] + (rows - row) * down_by + (columns - column) * right_by
            np.maximum.at(nearest, (rows[inside], columns[inside]), here[inside])
    out = np.divide(1.0, nearest, where=nearest > 0, out=np.zeros((height, width)))
    return np.round(out).astype(np.uint16)


def slope(near, axis):
    """Change of 1 / depth from pixel to pixel, by those neighbours that belong to the same surface."""
    steps = np.diff(near, axis=axis)
    before, after = (np.insert(steps, at, np.inf, axis=axis) for at in (0, steps.shape[axis]))
    belongs = [np.abs(step) < 0.05 * near for step in (before, after)]
    total = sum(np.where(is_same, step, 0.0) for is_same, step in zip(belongs, (before, after)))
    return total / np.maximum(belongs[0].astype(int) + belongs[1], 1)


def person(sequence, random):
    """Somebody walks through the view, in clothes that have a pattern, again and again."""
    camera, height = sequence.camera, sequence.camera["height"]
    scale = camera["fx"] / PERSON_DISTANCE_M
    width = round(PERSON_WIDTH_M * scale)
    blocks = random.integers(20, 236, size=(height // 12 + 1, width // 12 + 1, 3), dtype=np.uint8)
    pattern = np.repeat(np.repeat(blocks, 12, axis=0), 12, axis=1)[:height, :width]
    at_depth = np.uint16(round(PERSON_DISTANCE_M * camera["depth_scale"]))

    def shots():
        for shot in sequence.shots():
            left = round(PERSON_SPEED_MPS * (shot.stamp_s % PERSON_PERIOD_S) * scale) - width
            first, last = max(left, 0), min(left + width, camera["width"])
            color, depth = shot.color.copy(), shot.depth.copy()
            if first < last:
                behind = depth[:, first:last]
                is_seen = (behind == 0) | (behind > at_depth)
                behind[is_seen] = at_depth
                color[:, first:last][is_seen] = pattern[:, first - left:last - left][is_seen]
            yield Shot(shot.stamp_s, color, depth)
    return camera, shots()


KINDS = {"none": as_it_is, "every second": every_second, "7.5 Hz": slow, "gamma 0.4": gamma(0.4), "gamma 2.5": gamma(2.5),
         "exposure jumps": exposure_jumps, "motion blur": motion_blur, "rolling shutter": rolling_shutter,
         "depth late": late_depth, "holes": holes, "JPEG 60": jpeg(60),
         "depth +3 %": calibration(depth_scale=1 / 1.03), "depth -3 %": calibration(depth_scale=1 / 0.97),
         "focal length +3 %": calibration(fx=1.03, fy=1.03), "focal length -3 %": calibration(fx=0.97, fy=0.97),
         "depth not registered": unregistered_depth, "own depth camera": depth_camera_of_its_own,
         "person": person}

DARK, BRIGHT, ENOUGH_PIXELS = 5, 250, 0.3


def share_of_poor_shots(shots):
    """Of the shots, those of which less than ENOUGH_PIXELS have depth and are neither black nor white."""
    poor = []
    for shot in shots:
        color = shot.color
        if isinstance(color, bytes):
            color = np.asarray(Image.open(io.BytesIO(color)))
        grey = color.mean(axis=2)
        poor.append(((shot.depth > 0) & (grey > DARK) & (grey < BRIGHT)).mean() < ENOUGH_PIXELS)
    return float(np.mean(poor))
