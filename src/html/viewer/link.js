'use strict';
// The link, which keeps the view.

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
