'use strict';
// The data of the page: its description, and its layers, which are unpacked when they are first needed.

const scene = JSON.parse(document.getElementById('scene').textContent);

/** Luminance of linear Rec. 709 colours. */
const luminanceWeights = [0.2126, 0.7152, 0.0722];

/** Added to the squared reference that relative errors divide by, as in relMSE. */
const relativeFloor = scene.relativeFloor;

/** The values of all 65536 half floats. */
const halfValues = (() => {
  const values = new Float32Array(65536);
  for (let code = 0; code < 65536; ++code) {
    const exponent = (code >> 10) & 31;
    const fraction = code & 1023;
    let size = exponent ? 2 ** (exponent - 15) * (1 + fraction / 1024) : 2 ** -14 * (fraction / 1024);
    if (exponent === 31) size = fraction ? NaN : Infinity;
    values[code] = code & 32768 ? -size : size;
  }
  return values;
})();

/** What Layer.marks says of a pixel. */
const Mark = { NaN: 1, Infinite: 2, NegativeInfinite: 3 };

/**
 * One layer of one image in one frame, unpacked. Halves stay halves; a sample's place in its plane is
 * (y - this.y) * width + (x - this.x).
 */
class Layer {
  /** planes: of each channel. marks: where a pixel is not finite; null: nowhere. */
  constructor(info, { planes, marks }) {
    [this.x, this.y, this.width, this.height] = info.window;
    this.info = info;
    this.half = info.type === 'half';
    this.pixels = this.width * this.height;
    this.planes = planes;
    this.marks = marks;
    this.bytes = this.planes.length * this.pixels * (this.half ? 2 : 4);
  }

  contains(x, y) {
    return x >= this.x && y >= this.y && x < this.x + this.width && y < this.y + this.height;
  }

  at(channel, x, y) {
    const sample = this.planes[channel][(y - this.y) * this.width + (x - this.x)];
    return this.half ? halfValues[sample] : sample;
  }

  /** The values of a pixel, one for each channel; null outside. */
  values(x, y) {
    return this.contains(x, y) ? this.planes.map((_, c) => this.at(c, x, y)) : null;
  }

  /** The planes that are shown as red, green and blue. */
  rgbPlanes() {
    return this.planes.length === 3 ? [0, 1, 2] : [0, 0, 0];
  }
}

/** Unpacks layers once and keeps the ones used last, up to a limit of memory. */
class LayerCache {
  #limit = 1.5e9; // bytes
  #promises = new Map();
  #ready = new Map();

  /** The layer if it is unpacked already. */
  get(index) {
    const layer = this.#ready.get(index);
    if (layer) {
      this.#ready.delete(index); // moves it to the end: it was used last
      this.#ready.set(index, layer);
    }
    return layer;
  }

  load(index) {
    const ready = this.get(index);
    if (ready) return Promise.resolve(ready);
    if (!this.#promises.has(index)) this.#promises.set(index, this.#unpack(index));
    return this.#promises.get(index);
  }

  /** How many layers are being unpacked. */
  get busy() {
    return this.#promises.size;
  }

  async #unpack(index) {
    const info = scene.layers[index];
    const layer = new Layer(info, await unpacked(info));
    this.#promises.delete(index);
    this.#ready.set(index, layer);
    let bytes = 0;
    for (const one of this.#ready.values()) bytes += one.bytes;
    for (const [old, one] of this.#ready) {
      if (bytes <= this.#limit || old === index) break;
      bytes -= one.bytes;
      this.#ready.delete(old);
    }
    return layer;
  }
}

const layers = new LayerCache();

/** Indices of an image's layers in a frame; empty where it has none. */
const layersOf = (image, frame) => scene.images[image]?.frames[frame] ?? [];

/** The layer of an image that is shown for a slot, as an index: the one of that slot, else its first; -1: none. */
function layerFor(image, frame, slot) {
  const all = layersOf(image, frame);
  return all.find((index) => scene.layers[index].slot === slot) ?? all[0] ?? -1;
}

/** The slots of all images in a frame, each once, with the text for people. */
function slotsOf(frame) {
  const found = new Map();
  scene.images.forEach((_, image) => {
    for (const index of layersOf(image, frame)) {
      const { slot, label } = scene.layers[index];
      if (!found.has(slot)) found.set(slot, label);
    }
  });
  return found;
}

/** The rectangle that holds all layers of a frame: [x, y, width, height]. */
function extentOf(frame) {
  const windows = scene.images.flatMap((_, image) => layersOf(image, frame).map((index) => scene.layers[index].window));
  if (!windows.length) return [0, 0, 1, 1];
  const x0 = Math.min(...windows.map((w) => w[0]));
  const y0 = Math.min(...windows.map((w) => w[1]));
  const x1 = Math.max(...windows.map((w) => w[0] + w[2]));
  const y1 = Math.max(...windows.map((w) => w[1] + w[3]));
  return [x0, y0, x1 - x0, y1 - y0];
}

/** The label of the layer that is shown of an image where it has none of the slot that is looked at; empty otherwise. */
function otherLayerOf(image, frame) {
  const index = layerFor(image, frame, state.slot);
  return index < 0 || scene.layers[index].slot === state.slot ? '' : scene.layers[index].label;
}

const nameOf = (image) => scene.images[image]?.name ?? '';

/** The name of a channel without that of its layer. */
const channelLabel = (name) => name.slice(name.lastIndexOf('.') + 1);

const referenceImage = scene.images.findIndex((image) => image.reference);

const luminance = (rgb) => rgb[0] * luminanceWeights[0] + rgb[1] * luminanceWeights[1] + rgb[2] * luminanceWeights[2];

/** The kinds of difference of A and B: of two samples, and whether it has a sign. The shader has the same formulas. */
const differences = {
  signed: { label: 'A - B', signed: true, of: (a, b) => a - b },
  absolute: { label: '|A - B|', signed: false, of: (a, b) => Math.abs(a - b) },
  relative: { label: '(A - B) / B', signed: true, of: (a, b) => (a - b) / Math.sqrt(b * b + relativeFloor) },
  squared: { label: 'squared relative', signed: false, of: (a, b) => ((a - b) * (a - b)) / (b * b + relativeFloor) },
};

/** Mean over the channels of a difference of two pixels. */
function difference(kind, a, b) {
  const n = Math.min(a.length, b.length);
  let sum = 0;
  for (let c = 0; c < n; ++c) sum += differences[kind].of(a[c], b[c]);
  return sum / n;
}

/** A number in few letters. */
function short(value, digits = 4) {
  if (!Number.isFinite(value)) return Number.isNaN(value) ? 'NaN' : value > 0 ? '+Inf' : '-Inf';
  if (value === 0) return '0';
  const size = Math.abs(value);
  if (size >= 1e6 || size < 1e-4) return value.toExponential(digits - 2).replace('e+', 'e');
  if (Number.isInteger(value)) return String(value);
  return value.toPrecision(digits);
}
