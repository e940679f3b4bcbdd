'use strict';
// How each layer is drawn: scales of false colours, and what a painter needs to know of a cell.

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
  const low = Math.max(statistics.percentile(0.01), high * 1e-4);
  return [low < high ? low : high / 10, high, true];
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
