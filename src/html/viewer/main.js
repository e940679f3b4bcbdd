'use strict';
// What is shown, and the controls that change it.

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

// ---- geometry

/** The cells of the canvas in its pixels, each with the image and the frame that it shows. */
function cells() {
  const { width, height } = $('picture');
  const shown =
    state.mode === 'grid' ? scene.images.map((_, image) => ({ image, frame: state.frame }))
      : state.mode === 'sheet' ? scene.frames.map((_, frame) => ({ image: state.a, frame }))
        : [{ image: state.mode === 'blink' && blinking ? state.b : state.a, frame: state.frame }];
  if (shown.length === 1) return [{ ...shown[0], x: 0, y: 0, width, height }];
  const [, , w, h] = extentOf(state.frame);
  let columns = 1;
  let best = 0;
  for (let count = 1; count <= shown.length; ++count) {
    const scale = Math.min(width / count / w, height / Math.ceil(shown.length / count) / h);
    if (scale > best * 1.001) [best, columns] = [scale, count];
  }
  const rows = Math.ceil(shown.length / columns);
  const gap = 2;
  return shown.map((cell, i) => {
    const x = Math.round(((i % columns) * width) / columns);
    const y = Math.round((Math.floor(i / columns) * height) / rows);
    return {
      ...cell,
      x,
      y,
      width: Math.round((((i % columns) + 1) * width) / columns) - x - gap,
      height: Math.round(((Math.floor(i / columns) + 1) * height) / rows) - y - gap,
    };
  });
}

function fittingZoom(cell) {
  const [, , w, h] = extentOf(state.frame);
  const zoom = Math.min(cell.width / w, cell.height / h);
  return zoom >= 2 ? Math.floor(zoom) : zoom; // whole pixels of the screen, so that all pixels look alike
}

/** Zoom, and the place in the image of the cell's upper left corner. */
function geometryOf(cell) {
  const zoom = state.zoom || fittingZoom(cell);
  const [x0, y0, w, h] = extentOf(state.frame);
  const [x, y] = state.zoom ? [state.x, state.y] : [x0 + w / 2, y0 + h / 2];
  // On whole pixels of the screen, so that none of the image's is a pixel narrower than its neighbour.
  const snap = (value) => (zoom >= 1 ? Math.round(value * zoom) / zoom : value);
  return { zoom, originX: snap(x - cell.width / zoom / 2), originY: snap(y - cell.height / zoom / 2) };
}

/** The cell at a place of the canvas, and the place in the image, not rounded. */
function hit(canvasX, canvasY) {
  const all = cells();
  const cell =
    all.find((c) => canvasX >= c.x && canvasY >= c.y && canvasX < c.x + c.width && canvasY < c.y + c.height) ?? all[0];
  const { zoom, originX, originY } = geometryOf(cell);
  return { cell, x: originX + (canvasX - cell.x) / zoom, y: originY + (canvasY - cell.y) / zoom };
}

// ---- looks

/** The scale of false colours of a slot: what the reader chose, else one that holds for all images that have the slot. */
function rangeOf(slot, layer) {
  if (state.ranges[slot]) return state.ranges[slot];
  const known = scene.layers.filter((info) => info.slot === slot && info.range);
  if (known.length) {
    const widest = known.reduce((most, info) => (info.range[1] > most.range[1] ? info : most));
    return [...widest.range, widest.logarithmic];
  }
  const statistics = statisticsOf(layer);
  const high = statistics.percentile(0.999) || 1;
  return [Math.max(statistics.percentile(0.01), high * 1e-4), high, true];
}

const differenceScale = () => `difference ${state.kind}`;

const differenceRanges = new Map();

/** The scale of a difference, from a sample of its values. */
function rangeOfDifference(a, b) {
  if (state.ranges[differenceScale()]) return state.ranges[differenceScale()];
  const key = `${state.kind} ${scene.layers.indexOf(a.info)} ${scene.layers.indexOf(b.info)}`;
  if (!differenceRanges.has(key)) {
    const sizes = [];
    const step = Math.max(1, Math.floor(a.pixels / 200000));
    for (let i = 0; i < a.pixels; i += step) {
      const x = a.x + (i % a.width);
      const y = a.y + Math.floor(i / a.width);
      if (!b.contains(x, y)) continue;
      const size = Math.abs(difference(state.kind, a.values(x, y), b.values(x, y)));
      if (Number.isFinite(size)) sizes.push(size);
    }
    sizes.sort((one, other) => one - other);
    const high = sizes[Math.floor(0.995 * (sizes.length - 1))] || sizes.at(-1) || 1;
    const { signed } = differences[state.kind];
    differenceRanges.set(key, signed ? [-high, high, false] : [high * 1e-3, high, true]);
  }
  return differenceRanges.get(key);
}

/** How one layer is drawn. */
function lookOf(layer) {
  const { info } = layer;
  const falseColor = state.falseColor || info.kind === 'map';
  const [low, high, logarithmic] = falseColor ? rangeOf(info.slot, layer) : [0, 1, false];
  let planes = layer.rgbPlanes();
  if (planes[1] === planes[0]) {
    const wanted = channelNumbers[state.channel];
    planes = Array(3).fill(wanted >= 0 && wanted < layer.planes.length ? wanted : 0);
  }
  return { layer, planes, falseColor, low, high, logarithmic, ramp: info.ramp };
}

/** The layer of an image if it is unpacked; otherwise it is unpacked and the page drawn again. */
function readyLayer(image, frame) {
  const index = layerFor(image, frame, state.slot);
  if (index < 0) return null;
  const layer = layers.get(index);
  if (!layer) layers.load(index).then(changed, failed);
  return layer ?? null;
}

/** All that changes how a picture comes out, for each cell. */
function drawnCell(cell, first, second) {
  const looks = { first: lookOf(first), second: second ? lookOf(second) : undefined };
  const compared = !second ? 0 : state.mode === 'wipe' ? 1 : 2;
  if (compared === 2) {
    const [low, high, logarithmic] = rangeOfDifference(first, second);
    const ramp = differences[state.kind].signed ? signedRamp : 0;
    looks.first = { ...looks.first, low, high, logarithmic, ramp };
  }
  return {
    ...cell,
    ...looks,
    ...geometryOf(cell),
    compared,
    wipe: Math.round(state.wipe * cell.width),
    differenceKind: Object.keys(differences).indexOf(state.kind),
    channel: channelNumbers[state.channel],
    gain: 2 ** state.exposure,
    table: tables.get(state.transform) ?? null,
    marked: state.marks,
  };
}

// ---- drawing

function changed() {
  if (drawRequested) return;
  drawRequested = true;
  requestAnimationFrame(() => {
    drawRequested = false;
    draw();
  });
}

function failed(error) {
  $('message').textContent = `This picture cannot be shown: ${error.message}`;
  console.error(error);
}

function resize() {
  const box = $('stage').getBoundingClientRect();
  const ratio = window.devicePixelRatio || 1;
  for (const id of ['picture', 'overlay']) {
    const canvas = $(id);
    const [width, height] = [Math.max(1, Math.round(box.width * ratio)), Math.max(1, Math.round(box.height * ratio))];
    if (canvas.width !== width || canvas.height !== height) [canvas.width, canvas.height] = [width, height];
  }
}

const tooLarge = (layer) => layer.width > painter.largest || layer.height > painter.largest;

const two = () => state.mode === 'wipe' || state.mode === 'difference';

function draw() {
  resize();
  let missing = false;
  const waiting = new Set();
  painter.begin(0.102);
  for (const cell of cells()) {
    const first = readyLayer(cell.image, cell.frame);
    const second = two() ? readyLayer(state.b, cell.frame) : null;
    if (!first || (two() && !second)) {
      missing ||= layerFor(cell.image, cell.frame, state.slot) >= 0;
      waiting.add(cell.image);
      continue;
    }
    if (tooLarge(first) || (second && tooLarge(second))) {
      useCanvas();
      return;
    }
    painter.draw(drawnCell(cell, first, second));
  }
  const none = !layersOf(state.a, state.frame).length;
  $('message').textContent = missing ? 'Unpacking …' : none ? 'This image has no such frame.' : '';
  drawOverlay();
  showValues();
  showScale();
  showHistogram();
  showControls();
  keepLink();
  document.documentElement.dataset.drawn = missing ? '' : String(Number(document.documentElement.dataset.drawn || 0) + 1);
  if (!missing) unpackNext();
}

/** Unpacks the layers that are most likely wanted next, one at a time while nothing else happens. */
function unpackNext() {
  for (const frame of [state.frame, state.frame + 1])
    for (let image = 0; image < scene.images.length; ++image) {
      const index = layerFor(image, frame, state.slot);
      if (index < 0 || layers.get(index)) continue;
      layers.load(index).then(() => setTimeout(changed, 0), failed);
      return;
    }
}

function drawOverlay() {
  const canvas = $('overlay');
  const context = canvas.getContext('2d');
  context.clearRect(0, 0, canvas.width, canvas.height);
  const ratio = window.devicePixelRatio || 1;
  const all = cells();
  const label = (text, x, y, align) => {
    context.font = `${12 * ratio}px system-ui, "DejaVu Sans", sans-serif`;
    context.textAlign = align;
    const width = context.measureText(text).width;
    context.fillStyle = 'rgba(20,20,20,.78)';
    context.fillRect(align === 'right' ? x - width - 10 * ratio : x, y, width + 10 * ratio, 19 * ratio);
    context.fillStyle = '#eee';
    context.fillText(text, align === 'right' ? x - 5 * ratio : x + 5 * ratio, y + 14 * ratio);
  };
  for (const cell of all) {
    const geometry = geometryOf(cell);
    context.save();
    context.beginPath();
    context.rect(cell.x, cell.y, cell.width, cell.height);
    context.clip();
    if (geometry.zoom >= 56 * ratio && state.mode !== 'sheet') drawNumbers(context, cell, geometry, ratio);
    const spot = spotted();
    if (spot && geometry.zoom >= 3) {
      const x = cell.x + (spot[0] - geometry.originX) * geometry.zoom;
      const y = cell.y + (spot[1] - geometry.originY) * geometry.zoom;
      context.lineWidth = ratio;
      for (const [grow, color] of [[1.5, '#000'], [0.5, '#fff']]) {
        context.strokeStyle = color;
        context.strokeRect(x - grow * ratio, y - grow * ratio, geometry.zoom + 2 * grow * ratio, geometry.zoom + 2 * grow * ratio);
      }
    } else if (spot && state.pixel) {
      const x = Math.round(cell.x + (spot[0] + 0.5 - geometry.originX) * geometry.zoom);
      const y = Math.round(cell.y + (spot[1] + 0.5 - geometry.originY) * geometry.zoom);
      for (const [width, color] of [[3, '#000'], [1, '#fff']]) {
        context.lineWidth = width * ratio;
        context.strokeStyle = color;
        context.beginPath();
        for (const [dx, dy] of [[1, 0], [-1, 0], [0, 1], [0, -1]]) {
          context.moveTo(x + 4 * ratio * dx, y + 4 * ratio * dy);
          context.lineTo(x + 11 * ratio * dx, y + 11 * ratio * dy);
        }
        context.stroke();
      }
    }
    context.restore();
    if (all.length > 1) label(state.mode === 'sheet' ? scene.frames[cell.frame] : nameOf(cell.image), cell.x, cell.y, 'left');
  }
  const [cell] = all;
  if (state.mode === 'wipe') {
    const x = Math.round(state.wipe * cell.width);
    context.fillStyle = '#fff';
    context.fillRect(x - ratio, 0, 2 * ratio, cell.height);
    context.fillStyle = '#000';
    context.fillRect(x + ratio, 0, ratio, cell.height);
    label(nameOf(state.a), x - 2 * ratio, 0, 'right');
    label(nameOf(state.b), x + 2 * ratio, 0, 'left');
  }
  if (state.mode === 'difference') label(`A: ${nameOf(state.a)}   B: ${nameOf(state.b)}`, 0, 0, 'left');
  if (state.mode === 'blink' || state.mode === 'single') label(nameOf(cell.image), 0, 0, 'left');
}

const nameOf = (image) => scene.images[image]?.name ?? '';

/** The values in each pixel, where pixels are large enough to hold them. */
function drawNumbers(context, cell, { zoom, originX, originY }, ratio) {
  const layer = readyLayer(cell.image, cell.frame);
  if (!layer) return;
  const size = Math.min(12 * ratio, zoom / 5);
  context.font = `${size}px ui-monospace, "DejaVu Sans Mono", monospace`;
  context.textAlign = 'center';
  context.lineWidth = 2.5 * ratio;
  context.strokeStyle = 'rgba(0,0,0,.75)';
  context.fillStyle = '#fff';
  for (let y = Math.floor(originY); y < originY + cell.height / zoom; ++y)
    for (let x = Math.floor(originX); x < originX + cell.width / zoom; ++x) {
      const values = layer.values(x, y);
      if (!values) continue;
      const lines = values.slice(0, 4);
      lines.forEach((value, i) => {
        const at = [
          cell.x + (x + 0.5 - originX) * zoom,
          cell.y + (y + 0.5 - originY) * zoom + (i - (lines.length - 1) / 2 + 0.35) * size * 1.15,
        ];
        context.strokeText(short(value, 3), ...at);
        context.fillText(short(value, 3), ...at);
      });
    }
}

// ---- panels

/** The pixel whose values are shown. */
const spotted = () => state.pixel ?? pointer;

function row(cells, header) {
  const tr = document.createElement('tr');
  for (const content of cells) {
    const cell = document.createElement(header ? 'th' : 'td');
    if (content instanceof Node) cell.append(content);
    else if (typeof content === 'number') {
      cell.textContent = short(content);
      cell.dataset.value = String(content);
      cell.className = 'number';
    } else cell.textContent = content ?? '';
    tr.append(cell);
  }
  return tr;
}

const channelLabel = (name) => name.slice(name.lastIndexOf('.') + 1);

let valuesShown = '';

/** Two rows for each image: its number key and name, and its values at the pixel. */
function showValues() {
  const spot = spotted();
  const shown = scene.images.map((_, image) => readyLayer(image, state.frame));
  const all = $('all-layers').checked;
  const key = JSON.stringify([spot, state.a, state.b, state.pixel, state.frame, state.slot, all, shown.map((layer) => !!layer)]);
  if (key === valuesShown) return;
  valuesShown = key;
  $('place').textContent = spot ? `Pixel ${spot[0]}, ${spot[1]}${state.pixel ? ' (held)' : ''}` : 'Point at a pixel, or use the arrow keys';
  const main = shown.find((layer) => layer && layer.info.slot === state.slot);
  const channels = main ? main.info.channels.map(channelLabel) : [];
  const colored = channels.length === 3;
  const reference = referenceImage >= 0 ? shown[referenceImage] : null;
  const referenceValues = spot && reference?.info.slot === state.slot ? reference.values(...spot) : null;
  const heads = [...channels, ...(colored ? ['luminance'] : []), ...(referenceImage >= 0 ? ['rel. error'] : [])];
  $('values').tHead.replaceChildren(row(heads, true));
  const rows = scene.images.flatMap((one, image) => {
    const layer = shown[image];
    const button = document.createElement('button');
    button.type = 'button';
    button.textContent = one.name;
    button.title = one.path;
    button.dataset.image = image;
    button.setAttribute('aria-pressed', String(image === state.a));
    const badge = document.createElement('span');
    badge.className = 'badge';
    badge.textContent = image < 9 ? `${image + 1} ` : '  ';
    const letter = document.createElement('b');
    letter.className = 'letter';
    letter.textContent = image === state.a ? ' A' : image === state.b && scene.images.length > 1 ? ' B' : '';
    const head = document.createElement('th');
    head.colSpan = Math.max(heads.length, 1);
    head.scope = 'rowgroup';
    head.append(badge, button, letter);
    const title = document.createElement('tr');
    title.className = image === state.a ? 'a' : '';
    title.append(head);
    const values = spot && layer?.info.slot === state.slot ? layer.values(...spot) : null;
    if (!values) return [title];
    const numbers = channels.map((_, c) => values[c] ?? '');
    if (colored) numbers.push(values.length === 3 ? luminance(values) : '');
    if (referenceImage >= 0) numbers.push(referenceValues && image !== referenceImage ? difference('squared', values, referenceValues) : '');
    const line = row(numbers);
    line.className = title.className;
    return [title, line];
  });
  $('values').tBodies[0].replaceChildren(...rows);
  showFurther(spot, shown, all);
}

/** The values of the layers that tell most about a pixel, or of all layers, below the names of their images. */
function showFurther(spot, shown, all) {
  const rows = [];
  let some = false;
  scene.images.forEach((image, i) => {
    let named = false;
    for (const index of layersOf(i, state.frame)) {
      const info = scene.layers[index];
      if (info.slot === state.slot && shown[i]?.info === info) continue;
      some = true;
      if (!spot || (!all && !info.listed)) continue;
      const layer = layers.get(index);
      if (!layer) {
        layers.load(index).then(forgetValues, failed);
        continue;
      }
      const values = layer.values(...spot);
      if (!values) continue;
      if (!named) {
        const head = document.createElement('tr');
        const cell = document.createElement('th');
        cell.colSpan = 2;
        cell.textContent = image.name;
        head.append(cell);
        rows.push(head);
        named = true;
      }
      const text = document.createElement('span');
      values.forEach((value, c) => {
        const number = document.createElement('span');
        number.className = 'number';
        number.dataset.value = String(value);
        number.dataset.channel = info.channels[c];
        number.textContent = short(value);
        text.append(number, ' ');
      });
      if (info.meaning === 'variance') {
        const noise = document.createElement('div');
        noise.textContent = `noise ${values.map((value) => short(Math.sqrt(value), 3)).join(' ')}`;
        text.append(noise);
      }
      rows.push(row([info.label, text]));
    }
  });
  $('maps').tBodies[0].replaceChildren(...rows);
  $('further').hidden = !some;
}

function forgetValues() {
  valuesShown = '';
  changed();
}

/** What the scale belongs to: {key, name, range, ramp, signed}; null where nothing is in false colours. */
function currentScale() {
  const [cell] = cells();
  const first = readyLayer(cell.image, cell.frame);
  if (!first) return null;
  if (state.mode === 'difference') {
    const second = readyLayer(state.b, cell.frame);
    if (!second) return null;
    const { label, signed } = differences[state.kind];
    return { key: differenceScale(), name: `Difference, ${label}`, range: rangeOfDifference(first, second), ramp: signed ? signedRamp : 0, signed };
  }
  const look = lookOf(first);
  if (!look.falseColor) return null;
  const { slot, label } = first.info;
  return { key: slot, name: label, range: rangeOf(slot, first), ramp: look.ramp, signed: false };
}

let scaleBounds = null; // of what the handles can reach, fixed while the reader drags

function showScale() {
  const scale = currentScale();
  $('scale-box').hidden = !scale;
  if (!scale) return;
  const [low, high, logarithmic] = scale.range;
  $('scale-name').textContent = scale.name;
  $('logarithmic').checked = logarithmic;
  $('logarithmic').disabled = scale.signed;
  if (scaleBounds?.key !== `${scale.key} ${logarithmic}`) resetBounds(scale);
  const { from, to } = scaleBounds;
  const at = (value) => (logarithmic ? Math.log(value / from) / Math.log(to / from) : (value - from) / (to - from));
  for (const [id, value] of [['low', low], ['high', high]]) {
    $(id).style.left = `${100 * Math.min(Math.max(at(value), 0), 1)}%`;
    $(id).setAttribute('aria-valuenow', short(value));
    $(id).setAttribute('aria-valuetext', short(value));
    if (document.activeElement !== $(`${id}-number`)) $(`${id}-number`).value = short(value);
  }
  const context = $('ramp').getContext('2d');
  const picture = context.createImageData(256, 1);
  for (let i = 0; i < 256; ++i) {
    const position = i / 255;
    const value = logarithmic ? from * (to / from) ** position : from + (to - from) * position;
    const color = rampColor(value, { low, high, logarithmic, ramp: scale.ramp });
    picture.data.set([...color.map((c) => Math.round(255 * c)), 255], 4 * i);
  }
  context.putImageData(picture, 0, 0);
}

function resetBounds(scale) {
  const [low, high, logarithmic] = scale.range;
  const room = logarithmic ? (high / low) ** 0.25 : 0.25 * (high - low);
  scaleBounds = {
    key: `${scale.key} ${logarithmic}`,
    from: logarithmic ? low / room : low - room,
    to: logarithmic ? high * room : high + room,
  };
}

/** Sets one end of the scale; a scale with a sign stays symmetrical. */
function setRange(end, value) {
  const scale = currentScale();
  if (!scale || !Number.isFinite(value)) return;
  let [low, high, logarithmic] = scale.range;
  if (scale.signed) {
    high = Math.abs(value) || high;
    low = -high;
  } else if (end === 'low') low = logarithmic ? Math.min(Math.max(value, 1e-30), high * 0.999) : Math.min(value, high);
  else high = logarithmic ? Math.max(value, low * 1.001) : Math.max(value, low);
  if (!(high > low)) return;
  state.ranges = { ...state.ranges, [scale.key]: [low, high, logarithmic] };
  changed();
}

let histogramShown = '';

function showHistogram() {
  const [cell] = cells();
  const layer = readyLayer(cell.image, cell.frame);
  if (!layer) return;
  const canvas = $('histogram');
  const ratio = window.devicePixelRatio || 1;
  const box = canvas.getBoundingClientRect();
  const key = JSON.stringify([scene.layers.indexOf(layer.info), state.exposure, state.channel, box.width]);
  if (key === histogramShown) return;
  histogramShown = key;
  const statistics = statisticsOf(layer);
  canvas.width = Math.max(1, Math.round(box.width * ratio));
  canvas.height = Math.max(1, Math.round(box.height * ratio));
  const context = canvas.getContext('2d');
  const high = Math.max(statistics.max, 1e-7);
  const low = Math.min(Math.max(statistics.percentile(0.002), high * 1e-7), high * 0.5);
  const bins = 128;
  const all = statistics.histogram(low, high * 1.0001, bins);
  const colors = layer.planes.length === 3 ? ['#ff5a5a', '#4fd06a', '#6a9cff'] : ['#ddd', '#f7b955', '#8fd3d6', '#c79bf2'];
  const wanted = channelNumbers[state.channel];
  const most = Math.max(...all.flatMap((counts) => [...counts]));
  context.globalCompositeOperation = 'lighter';
  all.forEach((counts, c) => {
    if (wanted >= 0 && wanted < all.length && wanted !== c) return;
    context.fillStyle = colors[c % colors.length];
    context.globalAlpha = 0.62;
    context.beginPath();
    context.moveTo(0, canvas.height);
    counts.forEach((count, bin) => {
      const y = canvas.height * (1 - Math.sqrt(count / most));
      context.lineTo((bin / bins) * canvas.width, y);
      context.lineTo(((bin + 1) / bins) * canvas.width, y);
    });
    context.lineTo(canvas.width, canvas.height);
    context.fill();
  });
  context.globalCompositeOperation = 'source-over';
  context.globalAlpha = 1;
  const white = Math.log(1 / 2 ** state.exposure / low) / Math.log(high / low);
  if (layer.info.kind !== 'map' && white > 0 && white < 1) {
    context.fillStyle = '#fff';
    context.fillRect(Math.round(white * canvas.width), 0, ratio, canvas.height);
  }
  $('histogram-name').textContent = `Histogram: ${nameOf(cell.image)}`;
  $('histogram-ends').replaceChildren(...[short(low, 3), 'logarithmic; heights: square roots', short(high, 3)].map((text) => {
    const span = document.createElement('span');
    span.textContent = text;
    return span;
  }));
  showStatistics(statistics, layer);
}

function showStatistics(statistics, layer) {
  const percent = (count) => (count ? ` (${short((100 * count) / statistics.pixels, 2)} %)` : '');
  const count = (number) => `${number.toLocaleString('en')}${percent(number)}`;
  const lines = [
    ['size', `${layer.width} × ${layer.height}`],
    ['lowest', short(statistics.min)],
    ['mean', short(statistics.mean)],
    ['highest', short(statistics.max)],
    ['NaN', count(statistics.nan), statistics.nan],
    ['infinite', count(statistics.infinite), statistics.infinite],
    ['negative', count(statistics.negative)],
  ];
  if (layer.info.kind !== 'map') lines.push(['clipped', count(statistics.clipped(2 ** state.exposure))]);
  $('statistics').replaceChildren(
    ...lines.map(([name, value, alarm]) => {
      const box = document.createElement('div');
      const dt = document.createElement('dt');
      const dd = document.createElement('dd');
      dt.textContent = name;
      dd.textContent = value;
      dd.dataset.name = name;
      if (alarm) box.className = 'alarm';
      box.append(dt, dd);
      return box;
    }),
  );
}

function fill(select, options) {
  const key = JSON.stringify(options);
  if (select.dataset.options === key) return;
  select.dataset.options = key;
  select.replaceChildren(...options.map(([value, text]) => new Option(text, value)));
}

function showControls() {
  for (const radio of $('modes').querySelectorAll('input')) radio.checked = radio.value === state.mode;
  $('kind-label').hidden = state.mode !== 'difference';
  $('kind').value = state.kind;
  fill($('layer'), [...slotsOf(state.frame)]);
  $('layer').value = state.slot;
  const index = layerFor(state.a, state.frame, state.slot);
  const names = index < 0 ? [] : scene.layers[index].channels.map(channelLabel);
  fill(
    $('channel'),
    names.length === 3 ? Object.entries(channelNames).map(([value, text], i) => [value, i > 0 && i < 4 ? names[i - 1] : text]) : names.slice(0, 3).map((name, c) => ['rgb'[c], name]),
  );
  $('channel').value = [...$('channel').options].some((o) => o.value === state.channel) ? state.channel : $('channel').options[0]?.value;
  $('transform').value = state.transform;
  $('exposure').value = state.exposure;
  if (document.activeElement !== $('exposure-number')) $('exposure-number').value = state.exposure;
  $('false-color').checked = state.falseColor;
  $('marks').checked = state.marks;
  const { zoom } = geometryOf(cells()[0]);
  const percent = (100 * zoom) / (window.devicePixelRatio || 1);
  $('zoom').textContent = `${percent >= 10 ? Math.round(percent) : short(percent, 2)} %`;
  $('frame').value = state.frame;
  $('frame-label').textContent = scene.frames[state.frame] ?? '';
}

let lastSaid = '';

/** Tells readers of the screen what has changed. */
function say(text) {
  if (text === lastSaid) return;
  lastSaid = text;
  $('said').textContent = text;
}

// ---- the link

const linked = { a: 'a', b: 'b', mode: 'mode', kind: 'kind', slot: 'layer', channel: 'channel', frame: 'frame', exposure: 'exposure', transform: 'view', x: 'x', y: 'y', zoom: 'zoom', wipe: 'wipe', falseColor: 'false', marks: 'marks', pixel: 'pixel', ranges: 'ranges' };
const initial = structuredClone(state);
let linkTimer = 0;
let ownHash = location.hash;

function linkText() {
  const parameters = new URLSearchParams();
  for (const [name, key] of Object.entries(linked)) {
    const value = state[name];
    if (JSON.stringify(value) === JSON.stringify(initial[name])) continue;
    if ((name === 'x' || name === 'y') && !state.zoom) continue;
    if (name === 'transform') parameters.set(key, scene.transforms[value].name);
    else if (typeof value === 'number') parameters.set(key, String(Number(value.toPrecision(8))));
    else parameters.set(key, typeof value === 'string' ? value : JSON.stringify(value));
  }
  const text = parameters.toString();
  return text ? `#${text}` : '';
}

function keepLink() {
  clearTimeout(linkTimer);
  linkTimer = setTimeout(() => {
    ownHash = linkText();
    try {
      history.replaceState(null, '', ownHash || location.pathname + location.search);
    } catch {
      // Browsers limit how often this may be called; the link is kept at the next change.
    }
  }, 250);
}

/** Takes over what a link says. It may come from anyone, so each value is checked. */
function readLink() {
  const parameters = new URLSearchParams(location.hash.slice(1));
  const next = structuredClone(initial);
  const number = (key, low, high, fallback) => {
    const value = parameters.has(key) ? Number(parameters.get(key)) : NaN;
    return Number.isFinite(value) ? Math.min(Math.max(value, low), high) : fallback;
  };
  const whole = (key, count, fallback) => Math.round(number(key, 0, count - 1, fallback));
  next.a = whole('a', scene.images.length, next.a);
  next.b = whole('b', scene.images.length, next.b);
  next.frame = whole('frame', scene.frames.length, next.frame);
  if (modes.some((mode) => mode.name === parameters.get('mode'))) next.mode = parameters.get('mode');
  if (Object.hasOwn(differences, parameters.get('kind'))) next.kind = parameters.get('kind');
  if (Object.hasOwn(channelNames, parameters.get('channel'))) next.channel = parameters.get('channel');
  if (slotsOf(next.frame).has(parameters.get('layer'))) next.slot = parameters.get('layer');
  const view = scene.transforms.findIndex((transform) => transform.name === parameters.get('view'));
  if (view >= 0) next.transform = view;
  next.exposure = number('exposure', -40, 40, next.exposure);
  next.zoom = number('zoom', 0, maxZoom, next.zoom);
  next.x = number('x', -1e6, 1e6, next.x);
  next.y = number('y', -1e6, 1e6, next.y);
  next.wipe = number('wipe', 0, 1, next.wipe);
  next.falseColor = parameters.get('false') === 'true';
  next.marks = parameters.get('marks') === 'true';
  const numbers = (value) => Array.isArray(value) && value.slice(0, 2).every(Number.isFinite);
  try {
    const pixel = JSON.parse(parameters.get('pixel'));
    if (numbers(pixel) && pixel.length === 2) next.pixel = pixel.map(Math.round);
    const ranges = JSON.parse(parameters.get('ranges') ?? '{}');
    for (const [key, range] of Object.entries(ranges))
      if (numbers(range) && range.length === 3 && range[0] < range[1] && (!range[2] || range[0] > 0)) next.ranges[key] = [range[0], range[1], range[2] === true];
  } catch {
    // No JSON: what was read so far counts.
  }
  Object.assign(state, next);
  startBlinking();
  loadTransform();
}

// ---- changes

const maxZoom = 256;

function set(changes) {
  Object.assign(state, changes);
  if ('mode' in changes) startBlinking();
  if ('transform' in changes) loadTransform();
  changed();
}

let blinkTimer = 0;

function startBlinking() {
  clearInterval(blinkTimer);
  blinking = false;
  if (state.mode === 'blink')
    blinkTimer = setInterval(() => {
      blinking = !blinking;
      changed();
    }, 1000 * blinkSeconds);
}

/** Unpacks the table of the display transform. */
async function loadTransform() {
  const index = state.transform;
  const { table } = scene.transforms[index];
  if (!table || tables.has(index)) return;
  const layer = new Layer({ type: 'half', channels: ['R', 'G', 'B'], window: [0, 0, table.size * table.size, table.size] }, await inflated(table.block));
  const colors = new Float32Array(3 * layer.pixels);
  for (let c = 0; c < 3; ++c) for (let i = 0; i < layer.pixels; ++i) colors[3 * i + c] = halfValues[layer.planes[c][i]];
  tables.set(index, { ...table, colors });
  changed();
}

/** Zooms by a factor; the place of the image at this place of the canvas stays there. */
function zoomBy(factor, canvasX, canvasY) {
  const { cell, x, y } = hit(canvasX, canvasY);
  const old = geometryOf(cell).zoom;
  let zoom = old * factor;
  if (zoom > 1) zoom = factor > 1 ? Math.max(Math.round(zoom), Math.floor(old) + 1) : Math.min(Math.round(zoom), Math.ceil(old) - 1);
  zoom = Math.min(Math.max(zoom, Math.min(fittingZoom(cell), 1) / 4), maxZoom);
  set({
    zoom,
    x: x + (cell.x + cell.width / 2 - canvasX) / zoom,
    y: y + (cell.y + cell.height / 2 - canvasY) / zoom,
  });
}

function zoomInTheMiddle(factor) {
  const [cell] = cells();
  const { zoom, originX, originY } = geometryOf(cell);
  const spot = spotted();
  const x = spot ? cell.x + (spot[0] + 0.5 - originX) * zoom : cell.x + cell.width / 2;
  const y = spot ? cell.y + (spot[1] + 0.5 - originY) * zoom : cell.y + cell.height / 2;
  const inside = x >= cell.x && x < cell.x + cell.width && y >= cell.y && y < cell.y + cell.height;
  if (inside) zoomBy(factor, x, y);
  else zoomBy(factor, cell.x + cell.width / 2, cell.y + cell.height / 2);
}

function zoomTo(zoom) {
  const { zoom: old } = geometryOf(cells()[0]);
  if (zoom) zoomInTheMiddle(zoom / old);
  else set({ zoom: 0 });
}

/** Moves the held pixel by keys; the picture follows where it would leave the cell. */
function movePixel(dx, dy) {
  const [x0, y0, w, h] = extentOf(state.frame);
  const from = spotted() ?? [x0 + Math.floor(w / 2) - dx, y0 + Math.floor(h / 2) - dy];
  const pixel = [Math.min(Math.max(from[0] + dx, x0), x0 + w - 1), Math.min(Math.max(from[1] + dy, y0), y0 + h - 1)];
  const changes = { pixel };
  const [cell] = cells();
  const { zoom, originX, originY } = geometryOf(cell);
  const right = originX + cell.width / zoom;
  const lower = originY + cell.height / zoom;
  if (state.zoom) {
    if (pixel[0] < originX) changes.x = state.x - (originX - pixel[0]);
    if (pixel[0] + 1 > right) changes.x = state.x + (pixel[0] + 1 - right);
    if (pixel[1] < originY) changes.y = state.y - (originY - pixel[1]);
    if (pixel[1] + 1 > lower) changes.y = state.y + (pixel[1] + 1 - lower);
  }
  set(changes);
  const layer = readyLayer(state.a, state.frame);
  const values = layer?.values(...pixel);
  say(`Pixel ${pixel.join(', ')}${values ? `: ${values.map((value) => short(value)).join(', ')}` : ''}`);
}

const around = (value, count, step) => (value + step + count) % count;

function cycle(select, step) {
  const options = [...select.options].map((option) => option.value);
  return options[around(options.indexOf(select.value), options.length, step)];
}

function chooseA(image) {
  if (image >= scene.images.length) return;
  set({ a: image, ...(image === state.b ? { b: state.a } : {}) });
  say(`A: ${nameOf(image)}`);
}

function chooseB(image) {
  if (image >= scene.images.length) return;
  set({ b: image, ...(image === state.a ? { a: state.b } : {}) });
  say(`B: ${nameOf(image)}`);
}

function setFrame(frame) {
  const next = Math.min(Math.max(frame, 0), scene.frames.length - 1);
  set({ frame: next });
  say(`${scene.frameName} ${scene.frames[next]}`);
}

let playTimer = 0;

function play() {
  clearInterval(playTimer);
  const playing = $('play').getAttribute('aria-pressed') === 'true';
  $('play').setAttribute('aria-pressed', String(!playing));
  $('play').textContent = playing ? 'Play' : 'Stop';
  if (!playing) playTimer = setInterval(() => set({ frame: around(state.frame, scene.frames.length, 1) }), 250);
}

async function copyLink() {
  keepLink();
  const address = location.href.split('#')[0] + linkText();
  try {
    await navigator.clipboard.writeText(address);
    say('The link was copied');
    $('link').textContent = 'Copied';
  } catch {
    $('link').textContent = 'See address bar';
  }
  setTimeout(() => ($('link').textContent = 'Copy link'), 1500);
}

/** Keys, what they do in words, and what they do. Those with `stage` act only while the pictures have the focus, as the
 * page itself needs them elsewhere. */
const keys = [
  { keys: '123456789', text: '1 … 9', does: 'image A', act: (event, i) => chooseA(i) },
  { codes: Array.from({ length: 9 }, (_, i) => `Digit${i + 1}`), shift: true, text: 'Shift + 1 … 9', does: 'image B', act: (event, i) => chooseB(i) },
  { keys: ['n', 'N'], text: 'N, Shift + N', does: 'next image, the one before', act: (event, i) => chooseA(around(state.a, scene.images.length, i ? -1 : 1)) },
  { keys: [' '], stage: true, text: 'Space', does: 'exchange A and B', act: () => set({ a: state.b, b: state.a }) },
  ...modes.map((mode) => ({ keys: [mode.key], text: mode.key.toUpperCase(), does: mode.label.toLowerCase(), act: () => set({ mode: mode.name }) })),
  { keys: ['k', 'K'], text: 'K', does: 'next kind of difference', act: (event, i) => set({ kind: cycle($('kind'), i ? -1 : 1) }) },
  { keys: ['[', ']'], text: '[  ]', does: 'move the line of a wipe', act: (event, i) => set({ wipe: Math.min(Math.max(state.wipe + (i ? 0.02 : -0.02), 0), 1) }) },
  { keys: ['ArrowLeft', 'ArrowRight', 'ArrowUp', 'ArrowDown'], stage: true, text: 'Arrows', does: 'pixel whose values are shown (with Shift: ten)', act: (event, i) => movePixel([-1, 1, 0, 0][i] * (event.shiftKey ? 10 : 1), [0, 0, -1, 1][i] * (event.shiftKey ? 10 : 1)) },
  { keys: ['+', '=', '-', '_'], text: '+  −', does: 'zoom', act: (event, i) => zoomInTheMiddle(i < 2 ? 2 : 0.5) },
  { keys: ['f', '0'], text: 'F', does: 'whole picture', act: () => zoomTo(0) },
  { keys: ['z'], text: 'Z', does: 'one pixel of the image for one of the screen', act: () => zoomTo(1) },
  { keys: ['e', 'E'], text: 'E, Shift + E', does: 'exposure half a stop up, down', act: (event, i) => setExposure(state.exposure + (i ? -0.5 : 0.5)) },
  { keys: ['r'], text: 'R', does: 'reset exposure and scales', act: () => set({ exposure: initial.exposure, ranges: {} }) },
  { keys: ['t', 'T'], text: 'T', does: 'next view transform', act: (event, i) => set({ transform: around(state.transform, scene.transforms.length, i ? -1 : 1) }) },
  { keys: ['c', 'C'], text: 'C', does: 'next channel', act: (event, i) => set({ channel: cycle($('channel'), i ? -1 : 1) }) },
  { keys: ['l', 'L'], text: 'L', does: 'next layer', act: (event, i) => set({ slot: cycle($('layer'), i ? -1 : 1) }) },
  { keys: ['x'], text: 'X', does: 'false colour', act: () => set({ falseColor: !state.falseColor }) },
  { keys: ['m'], text: 'M', does: 'mark negative (blue) and clipped (yellow) pixels', act: () => set({ marks: !state.marks }) },
  ...(scene.frames.length > 1
    ? [
        { keys: [',', '.'], text: ',  .', does: `${scene.frameName} before, next one`, act: (event, i) => setFrame(state.frame + (i ? 1 : -1)) },
        { keys: ['p'], text: 'P', does: 'play, stop', act: play },
      ]
    : []),
  { keys: ['Escape'], stage: true, text: 'Escape', does: 'let the pixel go', act: () => set({ pixel: null }) },
  { keys: ['?', 'h'], text: '?', does: 'this list', act: () => $('keys').showModal() },
];

function pressed(event) {
  if (event.ctrlKey || event.altKey || event.metaKey || $('keys').open) return;
  const { target } = event;
  // Keys belong to the fields that take text, and single letters to lists.
  if (target.matches('input:not([type=checkbox]):not([type=radio]), select, textarea')) return;
  const inStage = target === $('stage') || (target === document.body && !document.querySelector('.report'));
  for (const entry of keys) {
    const found = entry.codes ? (event.shiftKey ? entry.codes.indexOf(event.code) : -1) : [...entry.keys].indexOf(event.key);
    if (found < 0 || (entry.stage && !inStage)) continue;
    event.preventDefault();
    entry.act(event, found);
    return;
  }
}

const setExposure = (value) => {
  if (Number.isFinite(value)) set({ exposure: Math.min(Math.max(Math.round(value * 100) / 100, -40), 40) });
};

// ---- the pointer

function listenToPointer() {
  const stage = $('stage');
  const ratio = () => window.devicePixelRatio || 1;
  const placeOf = (event) => {
    const box = stage.getBoundingClientRect();
    return [(event.clientX - box.left) * ratio(), (event.clientY - box.top) * ratio()];
  };
  let drag = null;
  stage.addEventListener('pointerdown', (event) => {
    if (event.button !== 0) return;
    const [x, y] = placeOf(event);
    const { cell } = hit(x, y);
    const line = state.mode === 'wipe' && Math.abs(x - state.wipe * cell.width) < 8 * ratio();
    const geometry = geometryOf(cell);
    drag = { x, y, line, moved: false, geometry, cell };
    stage.setPointerCapture(event.pointerId);
  });
  stage.addEventListener('pointermove', (event) => {
    const [x, y] = placeOf(event);
    if (drag && (drag.moved || Math.hypot(x - drag.x, y - drag.y) > 3 * ratio())) {
      drag.moved = true;
      if (drag.line) set({ wipe: Math.min(Math.max(x / drag.cell.width, 0), 1) });
      else {
        const { zoom, originX, originY } = drag.geometry;
        set({
          zoom,
          x: originX + (drag.cell.width / 2 - (x - drag.x)) / zoom,
          y: originY + (drag.cell.height / 2 - (y - drag.y)) / zoom,
        });
      }
      return;
    }
    const found = hit(x, y);
    const [x0, y0, w, h] = extentOf(state.frame);
    const [px, py] = [Math.floor(found.x), Math.floor(found.y)];
    // Outside of the picture the last pixel stays, so that nothing in the panels moves under the pointer.
    if (px >= x0 && py >= y0 && px < x0 + w && py < y0 + h) pointer = [px, py];
    changed();
  });
  stage.addEventListener('pointerup', () => {
    if (drag && !drag.moved) {
      const same = state.pixel && pointer && state.pixel[0] === pointer[0] && state.pixel[1] === pointer[1];
      const found = hit(drag.x, drag.y);
      const changes = { pixel: same ? null : pointer };
      if (state.mode === 'sheet') Object.assign(changes, { frame: found.cell.frame });
      set(changes);
    }
    drag = null;
  });
  stage.addEventListener('wheel', (event) => {
    event.preventDefault();
    zoomBy(event.deltaY < 0 ? 1.25 : 0.8, ...placeOf(event));
  }, { passive: false });
  stage.addEventListener('dblclick', (event) => {
    const found = hit(...placeOf(event));
    if (state.mode === 'grid') set({ mode: 'single', a: found.cell.image });
    if (state.mode === 'sheet') set({ mode: 'single', frame: found.cell.frame });
  });
}

function listenToScale() {
  const bar = $('scale');
  const valueAt = (part) => {
    const { from, to } = scaleBounds;
    return $('logarithmic').checked ? from * (to / from) ** part : from + (to - from) * part;
  };
  const partOf = (event) => {
    const box = bar.getBoundingClientRect();
    return Math.min(Math.max((event.clientX - box.left) / box.width, 0), 1);
  };
  let dragged = null;
  bar.addEventListener('pointerdown', (event) => {
    const part = partOf(event);
    const [low, high] = ['low', 'high'].map((id) => Math.abs(parseFloat($(id).style.left) / 100 - part));
    dragged = low < high ? 'low' : 'high';
    $(dragged).focus();
    bar.setPointerCapture(event.pointerId);
    setRange(dragged, valueAt(part));
  });
  bar.addEventListener('pointermove', (event) => {
    if (dragged) setRange(dragged, valueAt(partOf(event)));
  });
  bar.addEventListener('pointerup', () => {
    dragged = null;
    scaleBounds = null;
    changed();
  });
  for (const id of ['low', 'high']) {
    $(id).addEventListener('keydown', (event) => {
      const step = { ArrowLeft: -1, ArrowDown: -1, ArrowRight: 1, ArrowUp: 1, PageUp: 5, PageDown: -5 }[event.key];
      if (!step) return;
      event.preventDefault();
      event.stopPropagation();
      setRange(id, valueAt(parseFloat($(id).style.left) / 100 + 0.02 * step));
      scaleBounds = null;
    });
    $(`${id}-number`).addEventListener('change', (event) => {
      scaleBounds = null;
      setRange(id, Number(event.target.value));
    });
  }
  $('reset-range').addEventListener('click', () => {
    const scale = currentScale();
    if (!scale) return;
    const ranges = { ...state.ranges };
    delete ranges[scale.key];
    scaleBounds = null;
    set({ ranges });
  });
  $('logarithmic').addEventListener('change', (event) => {
    const scale = currentScale();
    if (!scale) return;
    const [low, high] = scale.range;
    const range = event.target.checked ? [low > 0 ? low : high * 1e-4, high, true] : [0, high, false];
    set({ ranges: { ...state.ranges, [scale.key]: range } });
  });
}

// ---- the start

function useCanvas() {
  const old = $('picture');
  const fresh = old.cloneNode();
  old.replaceWith(fresh);
  painter = new CanvasPainter(fresh);
  changed();
}

function start() {
  // `canvas` in the address chooses the drawing without WebGL2, for tests and for drivers that draw wrongly.
  try {
    if (new URLSearchParams(location.search).has('canvas')) throw new Error('wanted');
    painter = new GlPainter($('picture'));
  } catch {
    useCanvas();
  }
  $('modes').replaceChildren(
    ...modes.map((mode) => {
      const label = document.createElement('label');
      const radio = document.createElement('input');
      Object.assign(radio, { type: 'radio', name: 'mode', value: mode.name });
      radio.addEventListener('change', () => set({ mode: mode.name }));
      const text = document.createElement('span');
      text.textContent = mode.label;
      label.append(radio, text);
      return label;
    }),
  );
  $('modes').hidden = modes.length < 2;
  fill($('kind'), Object.entries(differences).map(([value, { label }]) => [value, label]));
  fill($('transform'), scene.transforms.map(({ name }, i) => [String(i), name]));
  $('transform-label').hidden = scene.transforms.length < 2;
  $('frames').hidden = scene.frames.length < 2;
  $('frame').max = scene.frames.length - 1;
  $('frame-name').textContent = scene.frameName;
  for (const text of scene.notes) {
    const p = document.createElement('p');
    p.textContent = text;
    $('notes').append(p);
  }
  $('key-rows').replaceChildren(
    ...keys.map((entry) => {
      const kbd = document.createElement('kbd');
      kbd.textContent = entry.text;
      return row([kbd, entry.does]);
    }),
  );
  $('kind').addEventListener('change', (event) => set({ kind: event.target.value }));
  $('layer').addEventListener('change', (event) => set({ slot: event.target.value }));
  $('channel').addEventListener('change', (event) => set({ channel: event.target.value }));
  $('transform').addEventListener('change', (event) => set({ transform: Number(event.target.value) }));
  for (const id of ['exposure', 'exposure-number']) $(id).addEventListener('input', (event) => setExposure(parseFloat(event.target.value)));
  $('false-color').addEventListener('change', (event) => set({ falseColor: event.target.checked }));
  $('marks').addEventListener('change', (event) => set({ marks: event.target.checked }));
  $('all-layers').addEventListener('change', changed);
  $('fit').addEventListener('click', () => zoomTo(0));
  $('one').addEventListener('click', () => zoomTo(1));
  $('smaller').addEventListener('click', () => zoomInTheMiddle(0.5));
  $('larger').addEventListener('click', () => zoomInTheMiddle(2));
  $('link').addEventListener('click', copyLink);
  $('help').addEventListener('click', () => $('keys').showModal());
  $('frame').addEventListener('input', (event) => setFrame(Number(event.target.value)));
  $('play').addEventListener('click', play);
  $('values').addEventListener('click', (event) => {
    const { image } = event.target.dataset;
    if (image !== undefined) (event.shiftKey ? chooseB : chooseA)(Number(image));
  });
  listenToPointer();
  listenToScale();
  document.addEventListener('keydown', pressed);
  new ResizeObserver(changed).observe($('stage'));
  window.addEventListener('beforeprint', draw);
  // Links of the page, such as those to a pixel, change the fragment.
  window.addEventListener('hashchange', () => {
    if (location.hash === ownHash) return;
    readLink();
    changed();
    $('viewer').scrollIntoView({ block: 'start' });
    $('stage').focus({ preventScroll: true });
  });
  readLink();
  if (!document.querySelector('.report')) $('stage').focus({ preventScroll: true });
  if (typeof DecompressionStream === 'undefined')
    $('message').textContent = 'This browser is too old for the pictures: use Chromium 80, Firefox 113, Safari 16.4 or later.';
  else draw();
}

// A page of figures alone has no viewer.
if (scene.images.length) start();
else $('viewer').hidden = true;
