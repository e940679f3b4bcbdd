'use strict';
// Figures of a layer: counts of what is not finite, negative or clipped, extremes, mean, histogram.

/** Floats above zero are counted by their bits without so many of the lowest ones. */
const droppedBits = 13;

/** The values of the codes of floats, in their order; their number is the code of infinity. */
let floatValues = null;

function valuesOfFloats() {
  floatValues ??= new Float32Array(Uint32Array.from({ length: 0x7f800000 >>> droppedBits }, (_, code) => code << droppedBits).buffer);
  return floatValues;
}

/**
 * All follows from how often each sample above zero occurs, so that figures for another exposure need no pass over the
 * pixels. Halves are counted exactly, floats to ten bits of their fractions; their extremes and mean are exact.
 */
class Statistics {
  constructor(layer) {
    const channels = layer.planes.length;
    this.pixels = layer.pixels;
    this.values = layer.half ? halfValues.subarray(0, 31744) : valuesOfFloats(); // of the codes that are counted
    const codes = layer.half ? 65536 : this.values.length;
    this.counts = Array.from({ length: channels }, () => new Uint32Array(codes)); // of each channel
    this.largest = new Uint32Array(codes); // of the largest channel of each pixel, where that is above zero
    this.nan = this.infinite = 0;
    if (layer.half) this.#countHalves(layer);
    else this.#countFloats(layer);
    if (layer.marks)
      for (const mark of layer.marks) {
        if (mark === Mark.NaN) ++this.nan;
        else if (mark) ++this.infinite;
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
    const bits = planes.map((plane) => new Uint32Array(plane.buffer, plane.byteOffset, plane.length));
    for (let i = 0; i < pixels; ++i) {
      let most = -Infinity;
      let code = 0; // of the largest channel
      let least = Infinity;
      for (let c = 0; c < planes.length; ++c) {
        const value = planes[c][i];
        if (!(value - value === 0)) continue; // not finite
        if (value > 0) {
          ++this.counts[c][bits[c][i] >>> droppedBits];
          code = Math.max(code, bits[c][i] >>> droppedBits);
        }
        sum += value;
        ++finite;
        least = Math.min(least, value);
        most = Math.max(most, value);
      }
      if (least < 0) ++this.negative;
      this.min = Math.min(this.min, least);
      this.max = Math.max(this.max, most);
      if (most > 0) ++this.largest[code];
    }
    this.mean = sum / finite;
  }

  /** Pixels with a channel that is above 1 when multiplied by gain. */
  clipped(gain) {
    let count = 0;
    for (let code = 0; code < this.values.length; ++code) if (this.values[code] * gain > 1) count += this.largest[code];
    return count;
  }

  /** The value below which a part of all positive samples lie. */
  percentile(part) {
    let all = 0;
    for (const counts of this.counts) for (let code = 1; code < this.values.length; ++code) all += counts[code];
    let before = 0;
    for (let code = 1; code < this.values.length; ++code) {
      for (const counts of this.counts) before += counts[code];
      if (before >= part * all && all) return this.values[code];
    }
    return 0;
  }

  /**
   * The ends of a histogram of at most 7 decades, [low, high]; null where nothing is above zero. They end at the highest
   * value, unless more than half of the different values lie elsewhere: the distance of the sky, or a single firefly,
   * would leave nothing to be seen of all others.
   */
  range() {
    const decades = 1e7;
    const { values } = this;
    const found = [];
    for (let code = 1; code < values.length; ++code) if (this.counts.some((counts) => counts[code])) found.push(values[code]);
    if (!found.length) return null;
    let high = found.length - 1;
    const widths = [];
    for (let end = 0, begin = 0; end < found.length; ++end) {
      while (found[begin] * decades < found[end]) ++begin;
      widths.push(end - begin + 1);
    }
    if (2 * widths[high] < found.length) high = widths.indexOf(widths.reduce((most, width) => Math.max(most, width)));
    const top = found[high];
    return [Math.min(Math.max(this.percentile(0.002), top / decades), top * 0.5), top];
  }

  /** Counts in bins that are even in the logarithm from low to high, one array for each channel. */
  histogram(low, high, bins) {
    const scale = bins / Math.log(high / low);
    return this.counts.map((counts) => {
      const out = new Float64Array(bins);
      for (let code = 1; code < this.values.length; ++code) {
        if (!counts[code]) continue;
        const bin = Math.floor(Math.log(this.values[code] / low) * scale);
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
