'use strict';
// The place on the canvas where each image is drawn, and its zoom.

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

/** The zoom at which the picture fits into every cell: one that holds for all, so that they show the same. */
function fittingZoom() {
  const [, , w, h] = extentOf(state.frame);
  const zoom = Math.min(...cells().map((cell) => Math.min(cell.width / w, cell.height / h)));
  return zoom >= 2 ? Math.floor(zoom) : zoom; // whole pixels of the screen, so that all pixels look alike
}

/** Zoom, and the place in the image of the cell's upper left corner. */
function geometryOf(cell) {
  const zoom = state.zoom || fittingZoom();
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
