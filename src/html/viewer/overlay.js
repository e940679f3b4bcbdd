'use strict';
// Draws above the pictures: names, the line of a wipe, the chosen pixel, numbers in pixels.

function drawOverlay() {
  const canvas = $('overlay');
  const context = canvas.getContext('2d');
  context.clearRect(0, 0, canvas.width, canvas.height);
  const ratio = window.devicePixelRatio || 1;
  const all = cells();
  const titleOf = (image, frame = state.frame) => [nameOf(image), otherLayerOf(image, frame)].filter(Boolean).join(': ');
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
    if (all.length > 1) label(state.mode === 'sheet' ? scene.frames[cell.frame] : titleOf(cell.image), cell.x, cell.y, 'left');
  }
  const [cell] = all;
  if (state.mode === 'wipe') {
    const x = Math.round(state.wipe * cell.width);
    context.fillStyle = '#fff';
    context.fillRect(x - ratio, 0, 2 * ratio, cell.height);
    context.fillStyle = '#000';
    context.fillRect(x + ratio, 0, ratio, cell.height);
    label(titleOf(state.a), x - 2 * ratio, 0, 'right');
    label(titleOf(state.b), x + 2 * ratio, 0, 'left');
  }
  if (state.mode === 'difference') label(`A: ${titleOf(state.a)}   B: ${titleOf(state.b)}`, 0, 0, 'left');
  if (state.mode === 'blink' || state.mode === 'single') label(titleOf(cell.image), 0, 0, 'left');
}

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
