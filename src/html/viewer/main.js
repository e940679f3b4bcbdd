'use strict';
// The start.

function start() {
  // `canvas` in the address chooses the drawing without WebGL2, for tests and for drivers that draw wrongly.
  try {
    if (new URLSearchParams(location.search).has('canvas')) throw new Error('wanted');
    const canvas = $('picture');
    usePainter(new GlPainter(canvas));
    canvas.addEventListener('webglcontextlost', (event) => event.preventDefault());
    canvas.addEventListener('webglcontextrestored', () => usePainter(new GlPainter(canvas)));
  } catch {
    useCanvas();
  }
  $('modes').replaceChildren(
    ...modes.map((mode) => {
      const label = document.createElement('label');
      const radio = document.createElement('input');
      Object.assign(radio, { type: 'radio', name: 'mode', value: mode.name });
      radio.addEventListener('change', () => set({ mode: mode.name }));
      const text = document.createElement('span');
      text.textContent = mode.label;
      label.append(radio, text);
      return label;
    }),
  );
  $('modes').hidden = modes.length < 2;
  fill($('kind'), Object.entries(differences).map(([value, { label }]) => [value, label]));
  fill($('transform'), scene.transforms.map(({ name }, i) => [String(i), name]));
  $('transform-label').hidden = scene.transforms.length < 2;
  $('frames').hidden = scene.frames.length < 2;
  $('frame').max = scene.frames.length - 1;
  $('frame-name').textContent = scene.frameName;
  for (const text of scene.notes) {
    const p = document.createElement('p');
    p.textContent = text;
    $('notes').append(p);
  }
  $('key-rows').replaceChildren(
    ...keys.map((entry) => {
      const kbd = document.createElement('kbd');
      kbd.textContent = entry.text;
      return row([kbd, entry.does]);
    }),
  );
  $('a').addEventListener('change', (event) => chooseA(Number(event.target.value)));
  $('b').addEventListener('change', (event) => chooseB(Number(event.target.value)));
  $('kind').addEventListener('change', (event) => set({ kind: event.target.value }));
  $('layer').addEventListener('change', (event) => set({ slot: event.target.value }));
  $('channel').addEventListener('change', (event) => set({ channel: event.target.value }));
  $('transform').addEventListener('change', (event) => set({ transform: Number(event.target.value) }));
  for (const id of ['exposure', 'exposure-number']) $(id).addEventListener('input', (event) => setExposure(parseFloat(event.target.value)));
  $('false-color').addEventListener('change', (event) => set({ falseColor: event.target.checked }));
  $('marks').addEventListener('change', (event) => set({ marks: event.target.checked }));
  $('all-layers').addEventListener('change', changed);
  $('fit').addEventListener('click', () => zoomTo(0));
  $('one').addEventListener('click', () => zoomTo(1));
  $('smaller').addEventListener('click', () => zoomInTheMiddle(0.5));
  $('larger').addEventListener('click', () => zoomInTheMiddle(2));
  $('link').addEventListener('click', copyLink);
  $('help').addEventListener('click', showKeys);
  $('frame').addEventListener('input', (event) => setFrame(Number(event.target.value)));
  $('play').addEventListener('click', play);
  $('values').addEventListener('click', (event) => {
    const { image } = event.target.dataset;
    if (image !== undefined) (event.shiftKey ? chooseB : chooseA)(Number(image));
  });
  listenToPointer();
  listenToScale();
  document.addEventListener('keydown', pressed);
  new ResizeObserver(changed).observe($('stage'));
  window.addEventListener('beforeprint', printed);
  window.addEventListener('afterprint', changed);
  // Links of the page, such as those to a pixel, change the fragment.
  window.addEventListener('hashchange', () => {
    if (location.hash === ownHash) return;
    readLink();
    changed();
    $('viewer').scrollIntoView({ block: 'start' });
    $('stage').focus({ preventScroll: true });
  });
  readLink();
  if (!document.querySelector('.report')) $('stage').focus({ preventScroll: true });
  if (typeof DecompressionStream === 'undefined')
    $('message').textContent = 'This browser is too old for the pictures: use Chromium 80, Firefox 113, Safari 16.4 or later.';
  else draw();
}

// A page of figures alone has no viewer.
if (scene.images.length) start();
else $('viewer').hidden = true;
