'use strict';
// Drawing what has changed: the pictures, then the panels around them.

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

/** Gives the canvases as many pixels as they cover of the screen. */
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

let painted = ''; // the last request to the painter

/** Paints cells, unless the canvas shows them already: without a graphics processor a large picture takes a second. */
function paint(parts) {
  const { width, height } = $('picture');
  const asked = JSON.stringify([width, height, parts], (name, value) =>
    value instanceof Layer ? scene.layers.indexOf(value.info) : name === 'table' ? value && state.transform : value,
  );
  if (asked === painted) return;
  painted = asked;
  painter.begin(0.102);
  for (const part of parts) painter.draw(part);
}

function draw() {
  resize();
  let missing = false;
  const parts = [];
  for (const cell of cells()) {
    const first = readyLayer(cell.image, cell.frame);
    const second = two() ? readyLayer(state.b, cell.frame) : null;
    if (!first || (two() && !second)) {
      missing ||= layerFor(cell.image, cell.frame, state.slot) >= 0;
      continue;
    }
    if (tooLarge(first) || (second && tooLarge(second))) {
      useCanvas();
      return;
    }
    parts.push(drawnCell(cell, first, second));
  }
  paint(parts);
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

/** Draws for a printer, which may see nothing of a canvas with WebGL2: the picture goes under the overlay. */
function printed() {
  painted = '';
  draw();
  const context = $('overlay').getContext('2d');
  context.globalCompositeOperation = 'destination-over';
  context.drawImage($('picture'), 0, 0);
  context.globalCompositeOperation = 'source-over';
}

/** Unpacks the layers that are most likely wanted next, as many at once as there are workers. */
function unpackNext() {
  for (const frame of [state.frame, state.frame + 1])
    for (let image = 0; image < scene.images.length; ++image) {
      if (layers.busy >= workers.limit) return;
      const index = layerFor(image, frame, state.slot);
      if (index < 0 || layers.get(index)) continue;
      layers.load(index).then(unpackedAhead, failed);
    }
}

/** A layer is unpacked that no cell waits for: its values at the pixel are shown. */
function unpackedAhead() {
  showValues();
  if (document.documentElement.dataset.drawn) unpackNext();
}

/** Draws on a canvas without WebGL2 from now on. */
function useCanvas() {
  const old = $('picture');
  const fresh = old.cloneNode();
  old.replaceWith(fresh);
  usePainter(new CanvasPainter(fresh));
}

function usePainter(next) {
  painter = next;
  painted = '';
  changed();
}
