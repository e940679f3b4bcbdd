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
    this.largest = new Uint32Array(65536); // of the largest channel of each pixel
    this.min = Infinity;
    this.max = -Infinity;
    this.nan = this.infinite = this.negative = 0;
    let sum = 0;
    let finite = 0;
    for (let i = 0; i < layer.pixels; ++i) {
      let most = -Infinity;
      let least = Infinity;
      let code = 0;
      for (let c = 0; c < channels; ++c) {
        const sample = layer.planes[c][i];
        const own = layer.half ? sample : nearHalf(sample);
        const value = layer.half ? halfValues[sample] : sample;
        ++this.counts[c][own];
        if (!(value - value === 0)) continue; // not finite
        sum += value;
        ++finite;
        if (value < least) least = value;
        if (value > most) {
          most = value;
          code = own;
        }
      }
      if (least < 0) ++this.negative;
      if (least < this.min) this.min = least;
      if (most > this.max) this.max = most;
      if (most > -Infinity) ++this.largest[code];
    }
    if (layer.marks)
      for (const mark of layer.marks) {
        if (mark === Mark.NaN) ++this.nan;
        else if (mark === Mark.Infinite) ++this.infinite;
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

function statisticsOf(layer) {
  if (!statisticsOfLayers.has(layer)) statisticsOfLayers.set(layer, new Statistics(layer));
  return statisticsOfLayers.get(layer);
}
