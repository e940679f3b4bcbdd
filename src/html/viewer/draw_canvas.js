'use strict';
// Drawing without WebGL2: the same pictures, more slowly. Each function does what the one of its name in the shader of
// draw_gl.js does.

class CanvasPainter {
  constructor(canvas) {
    this.canvas = canvas;
    this.context = canvas.getContext('2d', { alpha: false, willReadFrequently: true });
    this.largest = Infinity;
  }

  begin(ground) {
    const level = Math.round(255 * ground);
    this.context.fillStyle = `rgb(${level},${level},${level})`;
    this.context.fillRect(0, 0, this.canvas.width, this.canvas.height);
  }

  draw(cell) {
    const picture = this.context.getImageData(cell.x, cell.y, cell.width, cell.height);
    for (let y = 0, at = 0; y < cell.height; ++y)
      for (let x = 0; x < cell.width; ++x, at += 4) {
        const color = this.#pixel(cell, x + 0.5, y + 0.5);
        if (color) for (let c = 0; c < 3; ++c) picture.data[at + c] = Math.round(255 * color[c]);
      }
    this.context.putImageData(picture, cell.x, cell.y);
  }

  #pixel(cell, screenX, screenY) {
    const x = cell.originX + screenX / cell.zoom;
    const y = cell.originY + screenY / cell.zoom;
    const second = cell.compared === 1 && screenX >= cell.wipe;
    const a = second ? null : this.#read(cell, cell.first, x, y);
    if (!second && !a) return null;
    if (cell.compared === 0 || (cell.compared === 1 && !second)) return this.#marked(a.mark, this.#shown(cell, cell.first, a.rgb, screenX, screenY));
    const b = this.#read(cell, cell.second, x, y);
    if (!b) return null;
    if (second) return this.#marked(b.mark, this.#shown(cell, cell.second, b.rgb, screenX, screenY));
    const kind = Object.values(differences)[cell.differenceKind];
    const d = a.rgb.map((value, c) => kind.of(value, b.rgb[c]));
    const value = cell.channel < 0 ? (d[0] + d[1] + d[2]) / 3 : cell.channel > 2 ? luminance(d) : d[cell.channel];
    return this.#marked(Math.max(a.mark, b.mark), rampColor(value, cell.first));
  }

  #read(cell, look, x, y) {
    const { layer } = look;
    const count = cell.zoom < 1 ? Math.min(Math.ceil(1 / cell.zoom), averagedTexels) : 1;
    const rgb = [0, 0, 0];
    let parts = 0;
    let mark = 0;
    for (let j = 0; j < count; ++j)
      for (let i = 0; i < count; ++i) {
        const px = Math.floor(x + (i + 0.5 - 0.5 * count) / (count * cell.zoom));
        const py = Math.floor(y + (j + 0.5 - 0.5 * count) / (count * cell.zoom));
        if (!layer.contains(px, py)) continue;
        ++parts;
        const bad = layer.marks ? layer.marks[(py - layer.y) * layer.width + (px - layer.x)] : 0;
        mark = Math.max(mark, bad);
        if (!bad) for (let c = 0; c < 3; ++c) rgb[c] += layer.at(look.planes[c], px, py);
      }
    return parts ? { rgb: rgb.map((sum) => sum / parts), mark } : null;
  }

  #shown(cell, look, rgb, screenX, screenY) {
    const grey = look.planes[1] === look.planes[0];
    const chosen = grey ? rgb[0] : cell.channel < 0 || cell.channel > 2 ? luminance(rgb) : rgb[cell.channel];
    if (look.falseColor) return rampColor(chosen, look);
    if (cell.marked) {
      const [x, y] = [Math.floor(cell.x + screenX), this.canvas.height - 1 - Math.floor(cell.y + screenY)];
      if (rgb.some((v) => v < 0) && ((x >> 2) + (y >> 2)) % 2 === 0) return [0.1, 0.45, 1];
      if (rgb.some((v) => v * cell.gain > 1) && (x + y) % 8 < 4) return [1, 0.85, 0];
    }
    const linear = (cell.channel < 0 || grey ? rgb : [chosen, chosen, chosen]).map((v) => v * cell.gain);
    return cell.table ? throughTable(cell.table, linear) : linear.map(srgb);
  }

  #marked(mark, color) {
    if (mark === Mark.NaN) return [1, 0, 1];
    if (mark === Mark.NegativeInfinite) return [0, 0.8, 0.2];
    return mark ? [0, 1, 1] : color;
  }
}

function srgb(value) {
  const x = Math.min(Math.max(value, 0), 1);
  return x < 0.0031308 ? 12.92 * x : 1.055 * x ** (1 / 2.4) - 0.055;
}

function rampColor(value, look) {
  const t = look.logarithmic
    ? value > 0 ? Math.log(value / look.low) / Math.log(look.high / look.low) : 0
    : (value - look.low) / (look.high - look.low);
  const at = 3 * (256 * look.ramp + Math.round(255 * Math.min(Math.max(t || 0, 0), 1)));
  return [0, 1, 2].map((c) => rampColors[at + c] / 255);
}

/** Trilinear in the table, as textures are. */
function throughTable(table, rgb) {
  const last = table.size - 1;
  const levels = rgb.map((v) => last * Math.min(Math.max(Math.log2(Math.max(v, 0) * table.scale + 1) / table.length, 0), 1));
  const low = levels.map((level) => Math.min(Math.floor(level), last - 1));
  const out = [0, 0, 0];
  for (let corner = 0; corner < 8; ++corner) {
    let weight = 1;
    let at = 0;
    for (let c = 2; c >= 0; --c) {
      const up = (corner >> c) & 1;
      const part = levels[c] - low[c];
      weight *= up ? part : 1 - part;
      at = at * table.size + low[c] + up;
    }
    for (let c = 0; c < 3; ++c) out[c] += weight * table.colors[3 * at + c];
  }
  return out;
}
