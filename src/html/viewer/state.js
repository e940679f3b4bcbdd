'use strict';
// The state of the page: everything that the controls, keys and links change.

const $ = (id) => document.getElementById(id);

/** Inferno, magma, and blue-black-orange for values with a sign: 256 colours each. */
const rampColors = (() => {
  const out = new Uint8Array(3 * 256 * 3);
  scene.ramps.forEach((text, row) => out.set(Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0)), row * 768));
  for (let i = 0; i < 256; ++i) {
    const t = (i - 127.5) / 127.5;
    const size = Math.abs(t) ** 0.7;
    const white = Math.max(0, size - 0.6) / 0.4;
    const end = t < 0 ? [40, 130, 255] : [255, 120, 20];
    for (let c = 0; c < 3; ++c) out[3 * (512 + i) + c] = size * end[c] + white * 0.75 * (255 - end[c]);
  }
  return out;
})();
const signedRamp = 2;

const modes = [
  { name: 'single', label: 'Single', key: 's' },
  { name: 'wipe', label: 'Wipe', key: 'w' },
  { name: 'blink', label: 'Blink', key: 'b' },
  { name: 'difference', label: 'Difference', key: 'd' },
  { name: 'grid', label: 'Side by side', key: 'g' },
  { name: 'sheet', label: 'All frames', key: 'a' },
].filter((mode) => mode.name !== 'sheet' || scene.frames.length > 1)
  .filter((mode) => scene.images.length > 1 || ['single', 'sheet'].includes(mode.name));

const channelNames = { rgb: 'RGB', r: 'red', g: 'green', b: 'blue', l: 'luminance' };
const channelNumbers = { rgb: -1, r: 0, g: 1, b: 2, l: 3 };

const blinkSeconds = 0.6;

/** All that a link keeps. x, y: the place in the image that is in the middle of a cell. zoom: pixels of the screen for
 * one of the image; 0: what fits. pixel: the one whose values stay shown; null: that under the pointer. */
const state = {
  a: scene.first,
  b: referenceImage >= 0 && referenceImage !== scene.first ? referenceImage : scene.first === 0 ? 1 : 0,
  mode: 'single',
  kind: 'signed',
  slot: scene.layers[layersOf(scene.first, 0)[0]]?.slot ?? '',
  channel: 'rgb',
  frame: 0,
  exposure: scene.exposure,
  transform: scene.transform,
  x: 0,
  y: 0,
  zoom: 0,
  wipe: 0.5,
  falseColor: false,
  marks: false,
  pixel: null,
  ranges: {}, // by scale: [low, high, logarithmic], where the reader has changed it
};

let pointer = null; // the pixel that was last under it
let blinking = false; // B is shown
let painter = null;
let drawRequested = false;
const tables = new Map(); // of transforms, by index

/** The pixel whose values are shown. */
const spotted = () => state.pixel ?? pointer;
