'use strict';
// Drawing by WebGL2. draw_canvas.js does the same where that is missing.

/** The most texels along an edge that are averaged into one pixel of the screen. */
const averagedTexels = 8;

const fragmentShader = `#version 300 es
precision highp float;
precision highp int;
precision highp sampler2DArray;
precision highp sampler3D;
uniform sampler2DArray layerA, layerB;
uniform sampler3D table;
uniform sampler2D ramps;
uniform ivec4 windowA, windowB;  // x, y, width, height in pixels of the image
uniform ivec4 planesA, planesB;  // shown as red, green and blue; the one with the marks, or -1
uniform int channelsA, channelsB;
uniform vec2 cell;               // left and upper end on the canvas
uniform float canvasHeight, zoom;
uniform vec2 origin;             // place in the image of the cell's upper left corner
uniform int compared;            // 0: A alone, 1: wipe, 2: a difference
uniform float wipe;              // pixels of the canvas from the cell's left end
uniform int differenceKind;
uniform int channel;             // 0, 1, 2, or 3: luminance; -1: colour
uniform bvec2 inFalseColor;
uniform vec3 rangeA, rangeB;     // low, high, and 1 where the scale is logarithmic
uniform vec2 rampRows;
uniform float gain;
uniform vec2 tableScale;         // 0, 0: plain sRGB
uniform bool marked;
uniform float relativeFloor;
out vec4 result;

const vec3 nanColor = vec3(1.0, 0.0, 1.0), infiniteColor = vec3(0.0, 1.0, 1.0), negativeInfiniteColor = vec3(0.0, 0.8, 0.2);
const vec3 negativeColor = vec3(0.1, 0.45, 1.0), clippedColor = vec3(1.0, 0.85, 0.0);

struct Found {
  vec3 rgb;
  float parts;  // of the footprint that lie inside the layer; 0: nothing
  float mark;
};

Found read(sampler2DArray layer, ivec4 window, ivec4 planes, vec2 place, int count) {
  Found found = Found(vec3(0.0), 0.0, 0.0);
  for (int j = 0; j < count; ++j)
    for (int i = 0; i < count; ++i) {
      vec2 at = place + (vec2(i, j) + 0.5 - 0.5 * float(count)) / (float(count) * zoom);
      ivec2 texel = ivec2(floor(at)) - window.xy;
      if (texel.x < 0 || texel.y < 0 || texel.x >= window.z || texel.y >= window.w) continue;
      found.rgb += vec3(texelFetch(layer, ivec3(texel, planes.x), 0).r, texelFetch(layer, ivec3(texel, planes.y), 0).r,
                        texelFetch(layer, ivec3(texel, planes.z), 0).r);
      found.parts += 1.0;
      if (planes.w >= 0) found.mark = max(found.mark, texelFetch(layer, ivec3(texel, planes.w), 0).r);
    }
  if (found.parts > 0.0) found.rgb /= found.parts;
  return found;
}

float luminance(vec3 rgb) { return dot(rgb, vec3(${luminanceWeights.join(', ')})); }

/// The value that false colours show, and grey pictures of one channel.
float chosen(vec3 rgb, int channels) {
  if (channels == 1) return rgb.r;
  return channel < 0 || channel > 2 ? luminance(rgb) : rgb[channel];
}

vec3 rampColor(float value, vec3 range, float row) {
  float t = range.z > 0.5 ? (value > 0.0 ? log(value / range.x) / log(range.y / range.x) : 0.0)
                          : (value - range.x) / (range.y - range.x);
  return texture(ramps, vec2((clamp(t, 0.0, 1.0) * 255.0 + 0.5) / 256.0, (row + 0.5) / 3.0)).rgb;
}

vec3 srgb(vec3 x) {
  x = clamp(x, 0.0, 1.0);
  return mix(12.92 * x, 1.055 * pow(x, vec3(1.0 / 2.4)) - 0.055, step(0.0031308, x));
}

vec3 display(vec3 rgb) {
  if (tableScale.x == 0.0) return srgb(rgb);
  vec3 level = log2(max(rgb, 0.0) * tableScale.x + 1.0) / tableScale.y;
  float size = float(textureSize(table, 0).x);
  return texture(table, (clamp(level, 0.0, 1.0) * (size - 1.0) + 0.5) / size).rgb;
}

vec3 shown(Found found, int channels, bool falseColor, vec3 range, float row) {
  vec3 color;
  if (falseColor) color = rampColor(chosen(found.rgb, channels), range, row);
  else color = display(gain * (channel < 0 || channels == 1 ? found.rgb : vec3(chosen(found.rgb, channels))));
  if (marked && !falseColor) {
    ivec2 p = ivec2(gl_FragCoord.xy);
    if (any(lessThan(found.rgb, vec3(0.0))) && ((p.x >> 2) + (p.y >> 2)) % 2 == 0) color = negativeColor;
    else if (any(greaterThan(gain * found.rgb, vec3(1.0))) && (p.x + p.y) % 8 < 4) color = clippedColor;
  }
  return color;
}

vec3 oneDifference(vec3 a, vec3 b) {
  if (differenceKind == 0) return a - b;
  if (differenceKind == 1) return abs(a - b);
  if (differenceKind == 2) return (a - b) / sqrt(b * b + relativeFloor);
  return (a - b) * (a - b) / (b * b + relativeFloor);
}

void main() {
  vec2 screen = vec2(gl_FragCoord.x, canvasHeight - gl_FragCoord.y) - cell;
  vec2 place = origin + screen / zoom;
  int count = zoom < 1.0 ? min(int(ceil(1.0 / zoom)), ${averagedTexels}) : 1;
  bool second = compared == 1 && screen.x >= wipe;
  Found a = read(layerA, windowA, planesA, place, count);
  float mark = a.mark;
  vec3 color;
  if (compared == 0 || (compared == 1 && !second)) {
    if (a.parts == 0.0) discard;
    color = shown(a, channelsA, inFalseColor.x, rangeA, rampRows.x);
  } else {
    Found b = read(layerB, windowB, planesB, place, count);
    if (b.parts == 0.0 || (!second && a.parts == 0.0)) discard;
    mark = second ? b.mark : max(a.mark, b.mark);
    if (second) color = shown(b, channelsB, inFalseColor.y, rangeB, rampRows.y);
    else {
      vec3 d = oneDifference(a.rgb, b.rgb);
      float value = channel < 0 ? (d.r + d.g + d.b) / 3.0 : channel > 2 ? luminance(d) : d[channel];
      color = rampColor(value, rangeA, rampRows.x);
    }
  }
  if (mark > 2.5) color = negativeInfiniteColor;
  else if (mark > 1.5) color = infiniteColor;
  else if (mark > 0.5) color = nanColor;
  result = vec4(color, 1.0);
}`;

/** Draws cells on a canvas. Throws where there is no WebGL2. */
class GlPainter {
  #gl;
  #places = {}; // of the uniforms
  #textures = new Map(); // by layer; the last used one at the end
  #limit = 8e8; // bytes of textures
  #table = null;
  #tableOf = null;

  constructor(canvas) {
    const gl = canvas.getContext('webgl2', { alpha: false, antialias: false });
    if (!gl) throw new Error('no WebGL2');
    this.#gl = gl;
    this.canvas = canvas;
    this.largest = gl.getParameter(gl.MAX_TEXTURE_SIZE);
    const program = gl.createProgram();
    const corners = `#version 300 es
      void main() { gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, 0.0, 1.0); }`;
    for (const [type, text] of [[gl.VERTEX_SHADER, corners], [gl.FRAGMENT_SHADER, fragmentShader]]) {
      const shader = gl.createShader(type);
      gl.shaderSource(shader, text);
      gl.compileShader(shader);
      if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
      gl.attachShader(program, shader);
    }
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program));
    gl.useProgram(program);
    for (let i = 0; i < gl.getProgramParameter(program, gl.ACTIVE_UNIFORMS); ++i) {
      const { name } = gl.getActiveUniform(program, i);
      this.#places[name] = gl.getUniformLocation(program, name);
    }
    gl.uniform1i(this.#places.layerA, 0);
    gl.uniform1i(this.#places.layerB, 1);
    gl.uniform1i(this.#places.table, 2);
    gl.uniform1i(this.#places.ramps, 3);
    gl.uniform1f(this.#places.relativeFloor, relativeFloor);
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
    gl.activeTexture(gl.TEXTURE2);
    this.#bindTable({ size: 2, colors: new Float32Array(24) });
    gl.activeTexture(gl.TEXTURE3);
    gl.bindTexture(gl.TEXTURE_2D, gl.createTexture());
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGB8, 256, 3, 0, gl.RGB, gl.UNSIGNED_BYTE, rampColors);
    for (const side of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T]) gl.texParameteri(gl.TEXTURE_2D, side, gl.CLAMP_TO_EDGE);
    for (const filter of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER])
      gl.texParameteri(gl.TEXTURE_2D, filter, gl.NEAREST);
  }

  /** ground: grey of what is outside of the pictures, 0 to 1. */
  begin(ground) {
    const gl = this.#gl;
    gl.disable(gl.SCISSOR_TEST);
    gl.clearColor(ground, ground, ground, 1);
    gl.clear(gl.COLOR_BUFFER_BIT);
    gl.enable(gl.SCISSOR_TEST);
  }

  /** One cell; look.js describes the looks. */
  draw(cell) {
    const gl = this.#gl;
    const at = this.#places;
    const { width, height } = this.canvas;
    gl.viewport(0, 0, width, height);
    gl.scissor(cell.x, height - cell.y - cell.height, cell.width, cell.height);
    const second = cell.second ?? cell.first;
    for (const [unit, letter, look] of [[0, 'A', cell.first], [1, 'B', second]]) {
      const { layer } = look;
      gl.activeTexture(gl.TEXTURE0 + unit);
      gl.bindTexture(gl.TEXTURE_2D_ARRAY, this.#texture(layer));
      gl.uniform4i(at[`window${letter}`], layer.x, layer.y, layer.width, layer.height);
      gl.uniform4i(at[`planes${letter}`], ...look.planes, layer.marks ? layer.planes.length : -1);
      gl.uniform1i(at[`channels${letter}`], look.planes[1] === look.planes[0] ? 1 : 3);
      gl.uniform3f(at[`range${letter}`], look.low, look.high, look.logarithmic ? 1 : 0);
    }
    gl.uniform2i(at.inFalseColor, cell.first.falseColor ? 1 : 0, second.falseColor ? 1 : 0);
    gl.uniform2f(at.rampRows, cell.first.ramp, second.ramp);
    gl.uniform2f(at.cell, cell.x, cell.y);
    gl.uniform1f(at.canvasHeight, height);
    gl.uniform1f(at.zoom, cell.zoom);
    gl.uniform2f(at.origin, cell.originX, cell.originY);
    gl.uniform1i(at.compared, cell.compared);
    gl.uniform1f(at.wipe, cell.wipe);
    gl.uniform1i(at.differenceKind, cell.differenceKind);
    gl.uniform1i(at.channel, cell.channel);
    gl.uniform1f(at.gain, cell.gain);
    gl.uniform1i(at.marked, cell.marked ? 1 : 0);
    gl.activeTexture(gl.TEXTURE2);
    if (cell.table && cell.table !== this.#tableOf) this.#bindTable(cell.table);
    gl.uniform2f(at.tableScale, cell.table ? cell.table.scale : 0, cell.table ? cell.table.length : 0);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
  }

  #bindTable(table) {
    const gl = this.#gl;
    if (this.#table) gl.deleteTexture(this.#table);
    this.#table = gl.createTexture();
    this.#tableOf = table;
    gl.bindTexture(gl.TEXTURE_3D, this.#table);
    gl.texImage3D(gl.TEXTURE_3D, 0, gl.RGB16F, table.size, table.size, table.size, 0, gl.RGB, gl.FLOAT, table.colors);
    for (const side of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T, gl.TEXTURE_WRAP_R])
      gl.texParameteri(gl.TEXTURE_3D, side, gl.CLAMP_TO_EDGE);
    for (const filter of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER])
      gl.texParameteri(gl.TEXTURE_3D, filter, gl.LINEAR);
  }

  /** A texture with a slice for each channel, and one for the marks where there are any. */
  #texture(layer) {
    const gl = this.#gl;
    let texture = this.#textures.get(layer);
    if (texture) {
      this.#textures.delete(layer);
      this.#textures.set(layer, texture);
      return texture;
    }
    let bytes = layer.bytes;
    for (const one of this.#textures.keys()) bytes += one.bytes;
    for (const [old, one] of this.#textures) {
      if (bytes <= this.#limit || this.#textures.size < 2) break;
      bytes -= old.bytes;
      gl.deleteTexture(one);
      this.#textures.delete(old);
    }
    texture = gl.createTexture();
    this.#textures.set(layer, texture);
    gl.bindTexture(gl.TEXTURE_2D_ARRAY, texture);
    const slices = layer.planes.length + (layer.marks ? 1 : 0);
    gl.texStorage3D(gl.TEXTURE_2D_ARRAY, 1, layer.half ? gl.R16F : gl.R32F, layer.width, layer.height, slices);
    const type = layer.half ? gl.HALF_FLOAT : gl.FLOAT;
    const put = (slice, samples) =>
      gl.texSubImage3D(gl.TEXTURE_2D_ARRAY, 0, 0, 0, slice, layer.width, layer.height, 1, gl.RED, type, samples);
    layer.planes.forEach((plane, c) => put(c, layer.marks ? withoutMarked(layer, plane) : plane));
    if (layer.marks) put(layer.planes.length, layer.half ? layer.marks.reduce(halfMark, new Uint16Array(layer.pixels)) : Float32Array.from(layer.marks));
    for (const filter of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER])
      gl.texParameteri(gl.TEXTURE_2D_ARRAY, filter, gl.NEAREST);
    return texture;
  }
}

/** A copy of a plane with 0 where the pixel is not finite: averages over neighbours stay finite. */
function withoutMarked(layer, plane) {
  const out = plane.slice();
  for (let i = 0; i < out.length; ++i) if (layer.marks[i]) out[i] = 0;
  return out;
}

/** The halves 0 to 3. */
function halfMark(out, mark, i) {
  out[i] = [0, 0x3c00, 0x4000, 0x4200][mark];
  return out;
}
