// SPDX-License-Identifier: BSD-3-Clause
// Points and lines in WebGL 2. A line is a strip of triangles as wide as is said, as WebGL's own are one pixel wide.

const POINTS = [`#version 300 es
in vec3 at;
uniform mat4 clip_from_map;
uniform float size;
void main() {
  gl_Position = clip_from_map * vec4(at, 1);
  gl_PointSize = size;
}`, `#version 300 es
precision highp float;
uniform vec4 color;
uniform float size;
uniform bool ring;
out vec4 result;
void main() {
  float r = 2.0 * length(gl_PointCoord - 0.5), soft = 1.4 / size;
  float opacity = 1.0 - smoothstep(1.0 - soft, 1.0 + 0.5 * soft, r);
  if (ring) opacity *= smoothstep(0.55 - soft, 0.55, r);
  if (opacity <= 0.02) discard;
  result = vec4(color.rgb, color.a * opacity);
}`];

const LINES = [`#version 300 es
in vec3 a, b;
in vec2 corner;  // 0 at a, 1 at b; -1 on one side, 1 on the other
uniform mat4 clip_from_map;
uniform vec2 half_size;  // of the canvas in pixels
uniform float width;
out float along_px;
void main() {
  const float near = 1e-3;
  vec4 p = clip_from_map * vec4(a, 1), q = clip_from_map * vec4(b, 1);
  along_px = 0.0;
  gl_Position = vec4(2, 2, 2, 1);
  if (p.w < near && q.w < near) return;
  if (p.w < near) p = mix(p, q, (near - p.w) / (q.w - p.w));
  if (q.w < near) q = mix(q, p, (near - q.w) / (p.w - q.w));
  vec2 way = (q.xy / q.w - p.xy / p.w) * half_size;
  vec2 along = length(way) > 1e-4 ? normalize(way) : vec2(1, 0);
  vec2 side = vec2(-along.y, along.x);
  vec4 end = corner.x < 0.5 ? p : q;
  vec2 shift = 0.5 * width * corner.y * side;
  gl_Position = vec4(end.xy + shift / half_size * end.w, end.zw);
  along_px = corner.x * length(way);
}`, `#version 300 es
precision mediump float;
uniform vec4 color;
uniform float dash;  // pixels; 0: none
in float along_px;
out vec4 result;
void main() {
  if (dash > 0.0 && mod(along_px, 2.0 * dash) > dash) discard;
  result = color;
}`];

function program(gl, [vertex, fragment]) {
  const made = gl.createProgram();
  for (const [type, source] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
    const shader = gl.createShader(type);
    gl.shaderSource(shader, source);
    gl.compileShader(shader);
    gl.attachShader(made, shader);
  }
  ['at', 'a'].forEach(name => gl.bindAttribLocation(made, 0, name));
  gl.bindAttribLocation(made, 1, 'b');
  gl.bindAttribLocation(made, 2, 'corner');
  gl.linkProgram(made);
  if (!gl.getProgramParameter(made, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(made));
  return {made, place: name => gl.getUniformLocation(made, name)};
}

// '#rrggbb' and an opacity as WebGL wants it.
export function rgba(hex, opacity = 1) {
  const value = parseInt(hex.slice(1), 16);
  return [(value >> 16) / 255, ((value >> 8) & 255) / 255, (value & 255) / 255, opacity];
}

export class Drawing {
  constructor(canvas) {
    this.canvas = canvas;
    this.gl = canvas.getContext('webgl2', {antialias: true, alpha: false});
    if (!this.gl) throw new Error('no WebGL 2');
    this.prepare();
  }

  // Once, and again after the context was lost.
  prepare() {
    const gl = this.gl;
    this.points = program(gl, POINTS);
    this.lines = program(gl, LINES);
    this.corners = this.buffer(new Float32Array([0, -1, 0, 1, 1, -1, 1, 1]));
    gl.enable(gl.DEPTH_TEST);
    gl.depthFunc(gl.LEQUAL);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
    gl.clearColor(1, 1, 1, 1);
  }

  buffer(array) {
    const gl = this.gl, made = gl.createBuffer();
    gl.bindBuffer(gl.ARRAY_BUFFER, made);
    gl.bufferData(gl.ARRAY_BUFFER, array, gl.STATIC_DRAW);
    return made;
  }

  free(buffer) {
    if (buffer) this.gl.deleteBuffer(buffer);
  }

  begin(clipFromMap) {
    const gl = this.gl, scale = window.devicePixelRatio || 1;
    this.scale = scale;
    this.canvas.width = Math.max(1, Math.round(this.canvas.clientWidth * scale));
    this.canvas.height = Math.max(1, Math.round(this.canvas.clientHeight * scale));
    gl.viewport(0, 0, this.canvas.width, this.canvas.height);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    this.clipFromMap = clipFromMap;
  }

  use(which, color) {
    const gl = this.gl;
    gl.useProgram(which.made);
    gl.uniformMatrix4fv(which.place('clip_from_map'), false, this.clipFromMap);
    gl.uniform4fv(which.place('color'), color);
  }

  attribute(place, buffer, size, stride, offset, divisor) {
    const gl = this.gl;
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    gl.enableVertexAttribArray(place);
    gl.vertexAttribPointer(place, size, gl.FLOAT, false, stride, offset);
    gl.vertexAttribDivisor(place, divisor);
  }

  // x, y, z each.
  drawPoints(buffer, n, {color, size, ring = false}) {
    if (!n) return;
    const gl = this.gl;
    this.use(this.points, color);
    gl.uniform1f(this.points.place('size'), size * this.scale);
    gl.uniform1i(this.points.place('ring'), ring);
    this.attribute(0, buffer, 3, 0, 0, 0);
    gl.disableVertexAttribArray(1);
    gl.disableVertexAttribArray(2);
    gl.drawArrays(gl.POINTS, 0, n);
  }

  // x, y, z of one end, x, y, z of the other. round: so that many short ones are one smooth line.
  drawLines(buffer, n, {color, width, dash = 0, round = false}) {
    if (!n) return;
    const gl = this.gl;
    this.use(this.lines, color);
    gl.uniform2f(this.lines.place('half_size'), this.canvas.width / 2, this.canvas.height / 2);
    gl.uniform1f(this.lines.place('width'), width * this.scale);
    gl.uniform1f(this.lines.place('dash'), dash * this.scale);
    this.attribute(0, buffer, 3, 24, 0, 1);
    this.attribute(1, buffer, 3, 24, 12, 1);
    this.attribute(2, this.corners, 2, 0, 0, 0);
    gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, n);
    if (round) this.drawPoints(buffer, 2 * n, {color, size: width});
  }

  // What is to be seen in front of what was drawn.
  onTop(draw) {
    this.gl.disable(this.gl.DEPTH_TEST);
    draw();
    this.gl.enable(this.gl.DEPTH_TEST);
  }
}
