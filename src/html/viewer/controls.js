'use strict';
// The bar of controls, and what is said to readers of the screen.

function fill(select, options) {
  const key = JSON.stringify(options);
  if (select.dataset.options === key) return;
  select.dataset.options = key;
  select.replaceChildren(...options.map(([value, text]) => new Option(text, value)));
}

function showControls() {
  for (const radio of $('modes').querySelectorAll('input')) radio.checked = radio.value === state.mode;
  const names = scene.images.map(({ name }, i) => [String(i), name]);
  for (const letter of ['a', 'b']) {
    fill($(letter), names);
    $(letter).value = state[letter];
  }
  $('a-label').hidden = scene.images.length < 2 || state.mode === 'grid';
  $('b-label').hidden = !two() && state.mode !== 'blink';
  $('kind-label').hidden = state.mode !== 'difference';
  $('kind').value = state.kind;
  fill($('layer'), [...slotsOf(state.frame)]);
  $('layer').value = state.slot;
  const index = layerFor(state.a, state.frame, state.slot);
  const channels = index < 0 ? [] : scene.layers[index].channels.map(channelLabel);
  fill(
    $('channel'),
    channels.length === 3 ? Object.entries(channelNames).map(([value, text], i) => [value, i > 0 && i < 4 ? channels[i - 1] : text]) : channels.slice(0, 3).map((name, c) => ['rgb'[c], name]),
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
