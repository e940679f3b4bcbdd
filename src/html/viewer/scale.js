'use strict';
// The scale of false colours, whose ends are dragged.

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
  return { key: slot, name: label, range: rangeOf(slot, first), ramp: look.ramp, signed: look.ramp === signedRamp };
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
