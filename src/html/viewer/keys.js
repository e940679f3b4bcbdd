'use strict';
// The keyboard.

/** Keys, what they do in words, and what they do. Those with `stage` act only while the pictures have the focus, as the
 * page itself needs them elsewhere. */
const keys = [
  { keys: '123456789', text: '1 … 9', does: 'image A', act: (event, i) => chooseA(i) },
  { codes: Array.from({ length: 9 }, (_, i) => `Digit${i + 1}`), shift: true, text: 'Shift + 1 … 9', does: 'image B', act: (event, i) => chooseB(i) },
  { keys: ['n', 'N'], text: 'N, Shift + N', does: 'next image, the one before', act: (event, i) => chooseA(around(state.a, scene.images.length, i ? -1 : 1)) },
  { keys: [' '], stage: true, text: 'Space', does: 'exchange A and B', act: () => set({ a: state.b, b: state.a }) },
  ...modes.map((mode) => ({ keys: [mode.key], text: mode.key.toUpperCase(), does: mode.label.toLowerCase(), act: () => set({ mode: mode.name }) })),
  { keys: ['k', 'K'], text: 'K', does: 'next kind of difference', act: (event, i) => set({ kind: cycle($('kind'), i ? -1 : 1) }) },
  { keys: ['[', ']'], text: '[  ]', does: 'move the line of a wipe', act: (event, i) => set({ wipe: Math.min(Math.max(state.wipe + (i ? 0.02 : -0.02), 0), 1) }) },
  { keys: ['ArrowLeft', 'ArrowRight', 'ArrowUp', 'ArrowDown'], stage: true, text: 'Arrows', does: 'pixel whose values are shown (with Shift: ten)', act: (event, i) => movePixel([-1, 1, 0, 0][i] * (event.shiftKey ? 10 : 1), [0, 0, -1, 1][i] * (event.shiftKey ? 10 : 1)) },
  { keys: ['+', '=', '-', '_'], text: '+  −', does: 'zoom', act: (event, i) => zoomInTheMiddle(i < 2 ? 2 : 0.5) },
  { keys: ['f', '0'], text: 'F', does: 'whole picture', act: () => zoomTo(0) },
  { keys: ['z'], text: 'Z', does: 'one pixel of the image for one of the screen', act: () => zoomTo(1) },
  { keys: ['e', 'E'], text: 'E, Shift + E', does: 'exposure half a stop up, down', act: (event, i) => setExposure(state.exposure + (i ? -0.5 : 0.5)) },
  { keys: ['r'], text: 'R', does: 'reset exposure and scales', act: () => set({ exposure: initial.exposure, ranges: {} }) },
  { keys: ['t', 'T'], text: 'T', does: 'next view transform', act: (event, i) => set({ transform: around(state.transform, scene.transforms.length, i ? -1 : 1) }) },
  { keys: ['c', 'C'], text: 'C', does: 'next channel', act: (event, i) => set({ channel: cycle($('channel'), i ? -1 : 1) }) },
  { keys: ['l', 'L'], text: 'L', does: 'next layer', act: (event, i) => set({ slot: cycle($('layer'), i ? -1 : 1) }) },
  { keys: ['x'], text: 'X', does: 'false colour', act: () => set({ falseColor: !state.falseColor }) },
  { keys: ['m'], text: 'M', does: 'mark negative (blue) and clipped (yellow) pixels', act: () => set({ marks: !state.marks }) },
  ...(scene.frames.length > 1
    ? [
        { keys: [',', '.'], text: ',  .', does: `${scene.frameName} before, next one`, act: (event, i) => setFrame(state.frame + (i ? 1 : -1)) },
        { keys: ['p'], text: 'P', does: 'play, stop', act: play },
      ]
    : []),
  { keys: ['Escape'], stage: true, text: 'Escape', does: 'let the pixel go', act: () => set({ pixel: null }) },
  { keys: ['?', 'h'], text: '?', does: 'this list', act: showKeys },
];

/** The focus is at the beginning: on the button at the end, a small window would show the end of the list. */
function showKeys() {
  $('keys').showModal();
  $('keys-title').focus();
}

function pressed(event) {
  if (event.ctrlKey || event.altKey || event.metaKey || $('keys').open) return;
  const { target } = event;
  // Keys belong to the fields that take text, and single letters to lists.
  if (target.matches('input:not([type=checkbox]):not([type=radio]), select, textarea')) return;
  const inStage = target === $('stage') || (target === document.body && !document.querySelector('.report'));
  for (const entry of keys) {
    const found = entry.codes ? (event.shiftKey ? entry.codes.indexOf(event.code) : -1) : [...entry.keys].indexOf(event.key);
    if (found < 0 || (entry.stage && !inStage)) continue;
    event.preventDefault();
    entry.act(event, found);
    return;
  }
}
