'use strict';
// The actions of keys, pointer and controls: each changes the state and has the page drawn again.

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
  const { size, block } = table;
  const { planes } = await unpacked({ block, type: 'half', channels: ['R', 'G', 'B'], window: [0, 0, size * size, size] });
  const colors = new Float32Array(3 * size ** 3);
  for (let c = 0; c < 3; ++c) planes[c].forEach((half, i) => (colors[3 * i + c] = halfValues[half]));
  tables.set(index, { ...table, colors });
  changed();
}

/** Zooms; the place of the image at this place of the canvas stays there. */
function zoomAt(wanted, canvasX, canvasY) {
  const { cell, x, y } = hit(canvasX, canvasY);
  const zoom = Math.min(Math.max(wanted, Math.min(fittingZoom(), 1) / 4), maxZoom);
  set({
    zoom,
    x: x + (cell.x + cell.width / 2 - canvasX) / zoom,
    y: y + (cell.y + cell.height / 2 - canvasY) / zoom,
  });
}

/** Zooms by a factor, to whole pixels of the screen where they are larger than one. */
function zoomBy(factor, canvasX, canvasY) {
  const old = geometryOf(hit(canvasX, canvasY).cell).zoom;
  let zoom = old * factor;
  if (zoom > 1) zoom = factor > 1 ? Math.max(Math.round(zoom), Math.floor(old) + 1) : Math.min(Math.round(zoom), Math.ceil(old) - 1);
  zoomAt(zoom, canvasX, canvasY);
}

/** Moves the picture by pixels of the canvas. cell, zoom, originX, originY: where it was. */
function moveBy(x, y, cell, { zoom, originX, originY }) {
  set({ zoom, x: originX + (cell.width / 2 - x) / zoom, y: originY + (cell.height / 2 - y) / zoom });
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
  const window = scene.layers[layerFor(state.a, state.frame, state.slot)]?.window ?? [x0, y0, w, h];
  const middle = [0, 1].map((axis) => window[axis] + Math.floor(window[axis + 2] / 2));
  const from = spotted() ?? [middle[0] - dx, middle[1] - dy];
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

const setExposure = (value) => {
  if (Number.isFinite(value)) set({ exposure: Math.min(Math.max(Math.round(value * 100) / 100, -40), 40) });
};
