'use strict';
// Figures of a layer: counts of what is not finite, negative or clipped, extremes, mean, histogram.

/**
 * All follows from how often each half float occurs, so that figures for another exposure need no pass over the pixels.
 * Layers of floats are counted as the nearest halves; their extremes and mean are exact.
 */
class Statistics {
  constructor(layer) {
    const channels = layer.planes.length;
    this.pixels = layer.pixels;
    this.counts = layer.planes.map(() => new Uint32Array(65536)); // of each channel
    this.largest = new Uint32Array(65536); // of the largest channel of each pixel, where that is above zero
    this.nan = this.infinite = 0;
    if (layer.half) this.#countHalves(layer);
    else this.#countFloats(layer);
    if (layer.marks)
      for (const mark of layer.marks) {
        if (mark === Mark.NaN) ++this.nan;
        else if (mark === Mark.Infinite) ++this.infinite;
      }
  }

  // The order of halves above zero is that of their bits, so the loop compares bits. All else follows from the counts.
  #countHalves({ planes, pixels }) {
    this.negative = 0;
    const { counts, largest } = this;
    for (let i = 0; i < pixels; ++i) {
      let most = -1;
      let negative = 0;
      for (let c = 0; c < planes.length; ++c) {
        const sample = planes[c][i];
        ++counts[c][sample];
        if (sample < 31744) {
          if (sample > most) most = sample;
        } else if (sample > 32768 && sample < 64512) negative = 1;
      }
      if (most >= 0) ++largest[most];
      this.negative += negative;
    }
    this.min = Infinity;
    this.max = -Infinity;
    let sum = 0;
    let finite = 0;
    for (const found of counts)
      for (let code = 0; code < 65536; ++code) {
        if (!found[code] || (code & 31744) === 31744) continue; // none, or not finite
        const value = halfValues[code];
        sum += found[code] * value;
        finite += found[code];
        this.min = Math.min(this.min, value);
        this.max = Math.max(this.max, value);
      }
    this.mean = sum / finite;
  }

  #countFloats({ planes, pixels }) {
    this.min = Infinity;
    this.max = -Infinity;
    this.negative = 0;
    let sum = 0;
    let finite = 0;
    for (let i = 0; i < pixels; ++i) {
      let most = -Infinity;
      let least = Infinity;
      for (let c = 0; c < planes.length; ++c) {
        const value = planes[c][i];
        ++this.counts[c][nearHalf(value)];
        if (!(value - value === 0)) continue; // not finite
        sum += value;
        ++finite;
        least = Math.min(least, value);
        most = Math.max(most, value);
      }
      if (least < 0) ++this.negative;
      this.min = Math.min(this.min, least);
      this.max = Math.max(this.max, most);
      if (most > -Infinity) ++this.largest[nearHalf(most)];
    }
    this.mean = sum / finite;
  }

  /** Pixels with a channel that is above 1 when multiplied by gain. */
  clipped(gain) {
    let count = 0;
    for (let code = 0; code < 31744; ++code) if (halfValues[code] * gain > 1) count += this.largest[code];
    return count;
  }

  /** The value below which a part of all positive samples lie. */
  percentile(part) {
    let all = 0;
    for (const counts of this.counts) for (let code = 1; code < 31744; ++code) all += counts[code];
    let before = 0;
    for (let code = 1; code < 31744; ++code) {
      for (const counts of this.counts) before += counts[code];
      if (before >= part * all && all) return halfValues[code];
    }
    return 0;
  }

  /** Counts in bins that are even in the logarithm from low to high, one array for each channel. */
  histogram(low, high, bins) {
    const scale = bins / Math.log(high / low);
    return this.counts.map((counts) => {
      const out = new Float64Array(bins);
      for (let code = 1; code < 31744; ++code) {
        if (!counts[code]) continue;
        const bin = Math.floor(Math.log(halfValues[code] / low) * scale);
        if (bin >= 0 && bin < bins) out[bin] += counts[code];
      }
      return out;
    });
  }
}

const statisticsOfLayers = new WeakMap();

const hasStatistics = (layer) => statisticsOfLayers.has(layer);

function statisticsOf(layer) {
  if (!statisticsOfLayers.has(layer)) statisticsOfLayers.set(layer, new Statistics(layer));
  return statisticsOfLayers.get(layer);
}
