'use strict';
// The pointer on the pictures.

function listenToPointer() {
  const stage = $('stage');
  const ratio = () => window.devicePixelRatio || 1;
  const placeOf = (event) => {
    const box = stage.getBoundingClientRect();
    return [(event.clientX - box.left) * ratio(), (event.clientY - box.top) * ratio()];
  };
  let drag = null;
  const fingers = new Map(); // places by the pointer's number
  const pair = () => {
    const [a, b] = [...fingers.values()];
    return { distance: Math.max(Math.hypot(a[0] - b[0], a[1] - b[1]), 1), middle: [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2] };
  };
  stage.addEventListener('pointerdown', (event) => {
    if (event.button !== 0) return;
    const [x, y] = placeOf(event);
    if (event.pointerType === 'touch') fingers.set(event.pointerId, [x, y]);
    if (fingers.size > 1) {
      drag = null;
      return;
    }
    const { cell } = hit(x, y);
    const line = state.mode === 'wipe' && Math.abs(x - state.wipe * cell.width) < 8 * ratio();
    const geometry = geometryOf(cell);
    drag = { x, y, line, moved: false, geometry, cell };
    stage.setPointerCapture(event.pointerId);
  });
  stage.addEventListener('pointermove', (event) => {
    const [x, y] = placeOf(event);
    if (fingers.size === 2 && fingers.has(event.pointerId)) {
      const before = pair();
      fingers.set(event.pointerId, [x, y]);
      const { distance, middle } = pair();
      const { cell } = hit(...middle);
      const old = geometryOf(cell);
      moveBy(middle[0] - before.middle[0], middle[1] - before.middle[1], cell, old);
      zoomAt((old.zoom * distance) / before.distance, ...middle);
      return;
    }
    if (drag && (drag.moved || Math.hypot(x - drag.x, y - drag.y) > 3 * ratio())) {
      drag.moved = true;
      if (drag.line) set({ wipe: Math.min(Math.max(x / drag.cell.width, 0), 1) });
      else moveBy(x - drag.x, y - drag.y, drag.cell, drag.geometry);
      return;
    }
    const found = hit(x, y);
    const [x0, y0, w, h] = extentOf(state.frame);
    const [px, py] = [Math.floor(found.x), Math.floor(found.y)];
    // Outside of the picture the last pixel stays, so that nothing in the panels moves under the pointer.
    if (px >= x0 && py >= y0 && px < x0 + w && py < y0 + h) pointer = [px, py];
    changed();
  });
  for (const ended of ['pointerup', 'pointercancel']) stage.addEventListener(ended, (event) => fingers.delete(event.pointerId));
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
