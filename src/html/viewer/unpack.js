'use strict';
// From the blocks of the page, which are text, to samples: in workers, so that the page answers meanwhile.

/** The text of a block, which is a comment in its element. The page's script runs before the blocks are parsed, so that the first picture does not wait for
 * the others. A block is whole once something follows it. */
async function blockText(id) {
  for (;;) {
    const element = document.getElementById(id);
    if (document.readyState !== 'loading' || element?.nextElementSibling) return element.firstChild.data;
    await new Promise((resolve) => setTimeout(resolve, 20));
  }
}

/** Makes the function that unpacks a block. Workers know the text of this function alone, so it uses nothing else. */
function unpacker() {
  async function inflated(text, size) {
    const packed = Uint8Array.fromBase64
      ? Uint8Array.fromBase64(text)
      : Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
    const { writable, readable } = new DecompressionStream('deflate');
    const writer = writable.getWriter();
    // The reader reports faulty bytes, too.
    writer.write(packed).catch(() => {});
    writer.close().catch(() => {});
    const bytes = new Uint8Array(size);
    let at = 0;
    for (const reader = readable.getReader(); ; ) {
      const { done, value } = await reader.read();
      if (done) break;
      bytes.set(value, at);
      at += value.length;
    }
    if (at !== size) throw new Error(`it has ${at} bytes, not ${size}`);
    return bytes;
  }

  // A plane is stored as differences of successive bit patterns, first all their high bytes, then all the lower ones:
  // so zlib packs it better.
  function halves(bytes, at, pixels, mark) {
    const out = new Uint16Array(pixels);
    const low = at + pixels;
    for (let i = 0, value = 0; i < pixels; ++i) {
      value = (value + (bytes[at + i] << 8) + bytes[low + i]) & 65535;
      out[i] = value;
      if ((value & 31744) === 31744) mark(i, value & 1023, value & 32768);
    }
    return out;
  }

  function floats(bytes, at, pixels, mark) {
    const out = new Float32Array(pixels);
    const bits = new Uint32Array(out.buffer);
    const [second, third, fourth] = [at + pixels, at + 2 * pixels, at + 3 * pixels];
    for (let i = 0, value = 0; i < pixels; ++i) {
      value = (value + (bytes[at + i] << 24) + (bytes[second + i] << 16) + (bytes[third + i] << 8) + bytes[fourth + i]) | 0;
      bits[i] = value;
      if ((value & 0x7f800000) === 0x7f800000) mark(i, value & 0x7fffff, value < 0);
    }
    return out;
  }

  /** A typed array for each channel, and the marks (see Mark) of pixels that are not finite; null: all are. */
  return async ({ text, half, channels, pixels }) => {
    const size = half ? 2 : 4;
    const bytes = await inflated(text, channels * pixels * size);
    let marks = null;
    const mark = (i, fraction, negative) => {
      marks ??= new Uint8Array(pixels);
      const found = fraction ? 1 : negative ? 3 : 2;
      marks[i] = marks[i] ? Math.min(marks[i], found) : found; // of several channels NaN is shown first
    };
    const planes = [];
    for (let c = 0; c < channels; ++c) planes.push((half ? halves : floats)(bytes, c * size * pixels, pixels, mark));
    return { planes, marks };
  };
}

/** What runs in a worker: answers each block with its samples, or with what is wrong with it. */
const workerText = `'use strict';
const unpack = (${unpacker})();
onmessage = async ({ data }) => {
  try {
    const found = await unpack(data);
    const buffers = found.planes.map((plane) => plane.buffer);
    postMessage(found, found.marks ? [...buffers, found.marks.buffer] : buffers);
  } catch (error) {
    postMessage({ error: error.message });
  }
};`;

/** Workers, each with one block at a time. Without workers the page unpacks by itself. */
class Workers {
  #idle = [];
  started = 0;
  #queue = [];
  #address = URL.createObjectURL(new Blob([workerText], { type: 'text/javascript' }));
  #works = typeof Worker !== 'undefined';
  #here = unpacker();

  /** One processor stays for the page, which is still being read. */
  limit = Math.min(Math.max((navigator.hardwareConcurrency || 2) - 1, 1), 4);

  unpack(block) {
    return new Promise((resolve, reject) => {
      this.#queue.push({ block, resolve, reject });
      this.#next();
    });
  }

  #next() {
    if (!this.#queue.length) return;
    if (!this.#works) {
      for (const { block, resolve } of this.#queue.splice(0)) resolve(this.#here(block));
      return;
    }
    let worker = this.#idle.pop();
    if (!worker) {
      if (this.started === this.limit) return;
      try {
        worker = new Worker(this.#address);
      } catch {
        this.#works = false;
        this.#next();
        return;
      }
      ++this.started;
    }
    const job = this.#queue.shift();
    worker.onmessage = ({ data }) => {
      this.#idle.push(worker);
      if (data.error) job.reject(new Error(data.error));
      else job.resolve(data);
      this.#next();
    };
    // The browser does not run it, or it has died.
    worker.onerror = () => {
      this.#works = false;
      this.#queue.push(job);
      this.#next();
    };
    worker.postMessage(job.block);
  }
}

const workers = new Workers();

/** The samples of a block that is described like a layer of the scene. */
async function unpacked({ block, type, channels, window: [, , width, height] }) {
  const text = await blockText(block);
  return workers.unpack({ text, half: type === 'half', channels: channels.length, pixels: width * height });
}
