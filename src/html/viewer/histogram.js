'use strict';
// Histogram and figures of the layer that is shown.

let histogramShown = '';
let histogramTimer = 0; // not 0: it waits until the picture is seen

function showHistogram() {
  const [cell] = cells();
  const layer = readyLayer(cell.image, cell.frame);
  if (!layer) return;
  const canvas = $('histogram');
  const ratio = window.devicePixelRatio || 1;
  const box = canvas.getBoundingClientRect();
  const key = JSON.stringify([scene.layers.indexOf(layer.info), state.exposure, state.channel, box.width]);
  if (key === histogramShown || histogramTimer) return;
  if (!hasStatistics(layer)) {
    histogramTimer = setTimeout(() => {
      statisticsOf(layer);
      histogramTimer = 0;
      showHistogram();
    }, 0);
    return;
  }
  histogramShown = key;
  const statistics = statisticsOf(layer);
  canvas.width = Math.max(1, Math.round(box.width * ratio));
  canvas.height = Math.max(1, Math.round(box.height * ratio));
  const context = canvas.getContext('2d');
  $('histogram-name').textContent = `Histogram: ${nameOf(cell.image)}`;
  showStatistics(statistics, layer);
  const ends = statistics.range();
  showEnds(ends ? [short(ends[0], 3), 'logarithmic; heights: square roots', short(ends[1], 3)] : ['No value is above zero.']);
  if (!ends) return;
  const [low, high] = ends;
  const bins = 128;
  const all = statistics.histogram(low, high * 1.0001, bins);
  const colors = layer.planes.length === 3 ? ['#ff5a5a', '#4fd06a', '#6a9cff'] : ['#ddd', '#f7b955', '#8fd3d6', '#c79bf2'];
  const wanted = channelNumbers[state.channel];
  const most = Math.max(...all.flatMap((counts) => [...counts]));
  context.globalCompositeOperation = 'lighter';
  all.forEach((counts, c) => {
    if (wanted >= 0 && wanted < all.length && wanted !== c) return;
    context.fillStyle = colors[c % colors.length];
    context.globalAlpha = 0.62;
    context.beginPath();
    context.moveTo(0, canvas.height);
    counts.forEach((count, bin) => {
      const y = canvas.height * (1 - Math.sqrt(count / most));
      context.lineTo((bin / bins) * canvas.width, y);
      context.lineTo(((bin + 1) / bins) * canvas.width, y);
    });
    context.lineTo(canvas.width, canvas.height);
    context.fill();
  });
  context.globalCompositeOperation = 'source-over';
  context.globalAlpha = 1;
  const white = Math.log(1 / 2 ** state.exposure / low) / Math.log(high / low);
  if (layer.info.kind !== 'map' && white > 0 && white < 1) {
    context.fillStyle = '#fff';
    context.fillRect(Math.round(white * canvas.width), 0, ratio, canvas.height);
  }
}

/** Writes texts below the histogram. */
function showEnds(texts) {
  $('histogram-ends').replaceChildren(
    ...texts.map((text) => {
      const span = document.createElement('span');
      span.textContent = text;
      return span;
    }),
  );
}

function showStatistics(statistics, layer) {
  const percent = (count) => (count ? ` (${short((100 * count) / statistics.pixels, 2)} %)` : '');
  const finite = (value) => (Number.isFinite(value) ? short(value) : 'none'); // of a layer that has no finite sample
  const count = (number) => `${number.toLocaleString('en')}${percent(number)}`;
  const lines = [
    ['size', `${layer.width} × ${layer.height}`],
    ['lowest', finite(statistics.min)],
    ['mean', finite(statistics.mean)],
    ['highest', finite(statistics.max)],
    ['NaN', count(statistics.nan), statistics.nan],
    ['infinite', count(statistics.infinite), statistics.infinite],
    ['negative', count(statistics.negative)],
  ];
  if (layer.info.kind !== 'map') lines.push(['clipped', count(statistics.clipped(2 ** state.exposure))]);
  $('statistics').replaceChildren(
    ...lines.map(([name, value, alarm]) => {
      const box = document.createElement('div');
      const dt = document.createElement('dt');
      const dd = document.createElement('dd');
      dt.textContent = name;
      dd.textContent = value;
      dd.dataset.name = name;
      if (alarm) box.className = 'alarm';
      box.append(dt, dd);
      return box;
    }),
  );
}
