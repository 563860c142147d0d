#!/usr/bin/env python3
"""Draws docs/images/overview.svg: boxes in an octree, colliding boxes highlighted, and the steps of the search.

    draw_overview.py > docs/images/overview.svg

The card has its own background, and looks equal on white and on dark pages.
"""
import math
import random

WIDTH, HEIGHT = 960, 470
SCALE, ORIGIN = 198, (252, 236)
COLD = ("#7c93b8", "#5b7299", "#445879")
WARM = ("#ffb454", "#f28c28", "#c4661a")
STEPS = [("boxes", "what you own", "#7c93b8"), ("encode", "box → octal codes", "#38bdf8"),
         ("scatter", "entries to octants", "#38bdf8"), ("count", "entries per octant", "#38bdf8"),
         ("scan", "each octant, once", "#38bdf8"), ("pairs", "exactly those that touch", "#f28c28")]


def project(x, y, z):
    """Projects a point isometrically: x to the lower right, y to the lower left, z up."""
    return ORIGIN[0] + (x - y) * SCALE * math.cos(math.pi / 6), ORIGIN[1] + (x + y) * SCALE / 2 - z * SCALE


def polygon(points, **style):
    text = " ".join(f"{u:.1f},{v:.1f}" for u, v in (project(*p) for p in points))
    return f'<polygon points="{text}" ' + " ".join(f'{k.replace("_", "-")}="{v}"' for k, v in style.items()) + "/>"


def make_boxes():
    """Returns small boxes as (low, high), many near one corner."""
    chance = random.Random(11)
    boxes = []
    while len(boxes) < 96:
        near = len(boxes) < 62
        centre = [min(0.93, max(0.07, chance.gauss(0.66, 0.17) if near else chance.uniform(0.07, 0.93)))
                  for _ in range(3)]
        size = [chance.uniform(0.018, 0.05 if near else 0.07) for _ in range(3)]
        boxes.append(([c - s for c, s in zip(centre, size)], [c + s for c, s in zip(centre, size)]))
    return boxes


def overlap(a, b):
    return all(a[0][i] <= b[1][i] and b[0][i] <= a[1][i] for i in range(3))


def wall_cells(boxes, axes, cell=(0.0, 0.0), size=1.0):
    """Returns the octants that meet a wall: squares are split while they contain more than three centres."""
    inside = [b for b in boxes
              if all(c <= (b[0][a] + b[1][a]) / 2 < c + size for a, c in zip(axes, cell))]
    if len(inside) <= 3 or size < 0.1:
        return [(cell, size)]
    half = size / 2
    return [leaf for i in (0, 1) for j in (0, 1)
            for leaf in wall_cells(inside, axes, (cell[0] + i * half, cell[1] + j * half), half)]


def draw_walls(boxes):
    for axes, place, fill in (((0, 1), lambda u, v: (u, v, 0), "#16213a"), ((0, 2), lambda u, v: (u, 0, v), "#1b2845"),
                              ((1, 2), lambda u, v: (0, u, v), "#1e2d4d")):
        for (u, v), size in wall_cells(boxes, axes):
            corners = [place(u, v), place(u + size, v), place(u + size, v + size), place(u, v + size)]
            yield polygon(corners, fill=fill, stroke="#4a6390", stroke_width=0.8)


def draw_box(box, colours, opacity):
    (x0, y0, z0), (x1, y1, z1) = box
    faces = [[(x0, y0, z1), (x1, y0, z1), (x1, y1, z1), (x0, y1, z1)],
             [(x0, y1, z0), (x1, y1, z0), (x1, y1, z1), (x0, y1, z1)],
             [(x1, y0, z0), (x1, y1, z0), (x1, y1, z1), (x1, y0, z1)]]
    for face, colour in zip(faces, colours):
        yield polygon(face, fill=colour, fill_opacity=opacity, stroke="#0f172a", stroke_width=0.7)


def draw_steps():
    left, top, width, height, gap = 500, 62, 400, 44, 16
    for i, (name, caption, colour) in enumerate(STEPS):
        y = top + i * (height + gap)
        yield (f'<rect x="{left}" y="{y}" width="{width}" height="{height}" rx="10" fill="#1b2845" '
               f'stroke="{colour}" stroke-width="1.5"/>')
        yield f'<text x="{left + 22}" y="{y + 28}" class="name" fill="{colour}">{name}</text>'
        yield f'<text x="{left + 120}" y="{y + 28}" class="caption">{caption}</text>'
        yield f'<text x="{left + width - 20}" y="{y + 28}" class="code">{EXAMPLES[i]}</text>'
        if i:
            x = left + 40
            yield f'<path d="M{x} {y - gap + 2}v{gap - 8}m-4 -1l4 5l4 -5" fill="none" stroke="#64748b" stroke-width="1.6"/>'


EXAMPLES = ["min, max", "7 in {8,1}", "{8,1} → 7, 19", "{8,1}: 2", "7 × 19", "(7, 19)"]


def main():
    boxes = make_boxes()
    hit = {i for i, a in enumerate(boxes) for j, b in enumerate(boxes) if i != j and overlap(a, b)}
    print(f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" width="{WIDTH}" height="{HEIGHT}" '
          'role="img" aria-label="Boxes in an octree; encode, scatter, count and scan find the pairs that overlap">')
    print('<style>text{font-family:"DejaVu Sans",Verdana,sans-serif}.name{font-size:17px;font-weight:bold}'
          '.caption{font-size:14px;fill:#cbd5e1}.code{font-size:12.5px;fill:#94a3b8;text-anchor:end;'
          'font-family:"DejaVu Sans Mono",Menlo,monospace}</style>')
    print(f'<rect width="{WIDTH}" height="{HEIGHT}" rx="18" fill="#0f172a"/>')
    print("\n".join(draw_walls(boxes)))
    for i in sorted(range(len(boxes)), key=lambda i: sum(boxes[i][0]) + sum(boxes[i][1])):
        print("\n".join(draw_box(boxes[i], WARM if i in hit else COLD, 0.92 if i in hit else 0.62)))
    print("\n".join(draw_steps()))
    print("</svg>")


main()
