"""Draws curves of scores as SVG: one panel per parameter, with easy values on the left and hard ones on the right."""
from xml.sax.saxutils import escape

# Colour of the curves of each preset.
COLORS = {"published": "#e08214", "default": "#2166ac"}
# Drawn scores: key, name in the legend, dash pattern.
CURVES = [("PQ", "named objects: panoptic quality", ""), ("IoU_unknown", "unknown objects: mean IoU", "5 4")]
PANEL_WIDTH, PANEL_HEIGHT, COLUMNS = 250, 190, 4
LEFT, RIGHT, TOP, BOTTOM = 38, 12, 30, 38  # margins of a panel


def text(x, y, string, size=11, anchor="middle", color="#333", weight="normal"):
    return (f'<text x="{x:.1f}" y="{y:.1f}" font-size="{size}" text-anchor="{anchor}" fill="{color}" '
            f'font-weight="{weight}">{escape(string)}</text>')


def line(x1, y1, x2, y2, color="#ddd", width=1.0, dash=""):
    dashed = f' stroke-dasharray="{dash}"' if dash else ""
    return (f'<line x1="{x1:.1f}" y1="{y1:.1f}" x2="{x2:.1f}" y2="{y2:.1f}" stroke="{color}" '
            f'stroke-width="{width}"{dashed}/>')


def curve(points, color, dash):
    """A curve through the points (x, y), without those whose y is None."""
    seen = [(x, y) for x, y in points if y is not None]
    dashed = f' stroke-dasharray="{dash}"' if dash else ""
    path = " ".join(f"{x:.1f},{y:.1f}" for x, y in seen)
    parts = [f'<polyline points="{path}" fill="none" stroke="{color}" stroke-width="2"{dashed}/>']
    parts += [f'<circle cx="{x:.1f}" cy="{y:.1f}" r="2.4" fill="{color}"/>' for x, y in seen]
    return parts


def panel(axis, scores, x0, y0):
    """`axis`: title, labels; `scores`: {preset: [row of scores in percent per label]}."""
    width, height = PANEL_WIDTH - LEFT - RIGHT, PANEL_HEIGHT - TOP - BOTTOM
    x = [x0 + LEFT + width * i / max(len(axis["labels"]) - 1, 1) for i in range(len(axis["labels"]))]
    parts = [text(x0 + LEFT + width / 2, y0 + 18, axis["title"], 13, weight="bold")]
    for percent in (0, 25, 50, 75, 100):
        y = y0 + TOP + height * (1 - percent / 100)
        parts += [line(x0 + LEFT, y, x0 + LEFT + width, y),
                  text(x0 + LEFT - 6, y + 4, f"{percent}", 10, "end", "#666")]
    for at, label in zip(x, axis["labels"]):
        parts += [line(at, y0 + TOP + height, at, y0 + TOP + height + 4, "#999"),
                  text(at, y0 + TOP + height + 16, label, 10, color="#666")]
    parts.append(text(x0 + LEFT + width / 2, y0 + TOP + height + 31, axis["unit"], 10, color="#666"))
    for preset, rows in scores.items():
        for key, _, dash in CURVES:
            points = [(at, None if row[key] is None else y0 + TOP + height * (1 - row[key] / 100))
                      for at, row in zip(x, rows)]
            parts += curve(points, COLORS[preset], dash)
    return parts


def legend(presets, note, x0, y0):
    parts, y = [], y0 + TOP + 6
    for preset in presets:
        for _, name, dash in CURVES:
            parts += [line(x0 + 16, y - 4, x0 + 46, y - 4, COLORS[preset], 2, dash),
                      text(x0 + 52, y, name, 11, "start")]
            y += 18
        parts.insert(-4, text(x0 + 16, y - 2 * 18 - 18, f"{preset} preset", 12, "start", COLORS[preset], "bold"))
        y += 28
    return parts + [text(x0 + 16, y - 14 + 14 * i, words, 10, "start", "#666") for i, words in enumerate(note)]


def draw(axes, presets, note):
    """All panels and a legend as the text of an SVG file. `axes`: dicts with title, unit, labels and scores."""
    rows = -(-(len(axes) + 1) // COLUMNS)
    width, height = COLUMNS * PANEL_WIDTH, rows * PANEL_HEIGHT + 8
    parts = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" '
             f'height="{height}" font-family="Helvetica, Arial, DejaVu Sans, sans-serif">',
             f'<rect width="{width}" height="{height}" rx="6" fill="white"/>']
    for i, axis in enumerate(axes):
        parts += panel(axis, axis["scores"], i % COLUMNS * PANEL_WIDTH, i // COLUMNS * PANEL_HEIGHT)
    i = len(axes)
    parts += legend(presets, note, i % COLUMNS * PANEL_WIDTH, i // COLUMNS * PANEL_HEIGHT + 12)
    return "\n".join(parts + ["</svg>"]) + "\n"
