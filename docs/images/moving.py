#!/usr/bin/env python3
"""Makes the scene of docs/images/moving, and joins its pictures.

    moving.py scene FILE.npy          writes FRAMES + 1 frames of boxes, (frames, n, 6); the last frame looks like the first one
    moving.py join FOLDER FILE.webp   joins FOLDER/*.png to a loop of WIDTH pixels

The scene is a disc of boxes on orbits. It has equal SECTORS. In a loop, each box moves on by whole sectors, and oscillates once. So the
last frame has the boxes of the first frame, under other numbers, and the loop has no seam.
"""
import math
import pathlib
import sys

import numpy as np

FRAMES, MILLISECONDS = 48, 84
WIDTH = 800
SECTORS, BOXES = 5, 48  # boxes in a sector
QUALITY = 33


def make_scene():
    chance = np.random.default_rng(5)
    radius = np.sqrt(chance.uniform(0.16**2, 1, BOXES))
    angle = chance.uniform(0, 2 * math.pi / SECTORS, BOXES)
    turns = np.where(radius > 0.6, 1, 2) + (chance.uniform(size=BOXES) < 0.3)  # sectors in a loop
    half = chance.uniform(0.016, 0.042, (BOXES, 1)) * chance.uniform(0.7, 1.3, (BOXES, 3))
    swing = chance.uniform(0.01, 0.06, (BOXES, 2))  # amplitudes: outward and upward
    phase = chance.uniform(0, 2 * math.pi, (BOXES, 2))
    height = chance.normal(0, 0.13, BOXES) * (1.3 - radius)

    frames = []
    for time in np.arange(FRAMES + 1) / FRAMES:
        waves = swing * np.sin(2 * math.pi * time + phase)
        distance, z = radius + waves[:, 0], height + waves[:, 1]
        boxes = []
        for sector in range(SECTORS):
            at = angle + (sector + time * turns) * 2 * math.pi / SECTORS
            centre = np.stack([distance * np.cos(at), distance * np.sin(at), z], axis=1)
            boxes.append(np.concatenate([centre - half, centre + half], axis=1))
        frames.append(np.concatenate(boxes))
    return np.array(frames, dtype=np.float32)


def join(folder, output):
    from PIL import Image  # Debian's package python3-pil
    pictures = [Image.open(path).convert("RGB") for path in sorted(folder.glob("*.png"))]
    small = [picture.resize((WIDTH, round(WIDTH * picture.height / picture.width)), Image.Resampling.LANCZOS) for picture in pictures]
    small[0].save(output, save_all=True, append_images=small[1:], duration=MILLISECONDS, loop=0, quality=QUALITY, method=6,
                  minimize_size=False, allow_mixed=False)


if __name__ == "__main__":
    if sys.argv[1] == "scene":
        np.save(sys.argv[2], make_scene())
    else:
        join(pathlib.Path(sys.argv[2]), sys.argv[3])
