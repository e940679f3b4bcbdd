'use strict';
// The table of values at a pixel.

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

/** The values of a pixel in one line. */
function numbersOf(values, info) {
  const text = document.createElement('span');
  values.forEach((value, c) => {
    const number = document.createElement('span');
    number.className = 'number';
    number.dataset.value = String(value);
    number.dataset.channel = info.channels[c];
    number.textContent = short(value);
    text.append(number, ' ');
  });
  return text;
}

let valuesShown = '';

/** Two rows for each image: its number key and name, and its values at the pixel. */
function showValues() {
  const spot = spotted();
  const shown = scene.images.map((_, image) => layers.get(layerFor(image, state.frame, state.slot)));
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
    const values = spot && layer ? layer.values(...spot) : null;
    if (layer && layer.info.slot !== state.slot) {
      const other = document.createElement('span');
      other.className = 'layer';
      other.textContent = layer.info.label;
      head.append(other);
      if (!values) return [title];
      const line = document.createElement('tr');
      const cell = document.createElement('td');
      cell.colSpan = head.colSpan;
      cell.append(numbersOf(values, layer.info));
      line.append(cell);
      line.className = title.className;
      return [title, line];
    }
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
      if (shown[i]?.info === info) continue;
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
      const text = numbersOf(values, info);
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
