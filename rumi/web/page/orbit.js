// SPDX-License-Identifier: BSD-3-Clause
// A viewer that turns about a target, by mouse, touch and keys; and the few vectors that it takes.

export const add = (a, b, s = 1) => [a[0] + s * b[0], a[1] + s * b[1], a[2] + s * b[2]];
export const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
export const length = a => Math.hypot(a[0], a[1], a[2]);
export const unit = a => add([0, 0, 0], a, 1 / (length(a) || 1));
// q: w, x, y, z.
export function turned(q, v) {
  const u = [q[1], q[2], q[3]], t = cross(u, v).map(x => 2 * x);
  return add(add(v, t, q[0]), cross(u, t));
}

const FIELD_OF_VIEW = 45 * Math.PI / 180;
const STEEPEST = 89.5 * Math.PI / 180;
const clamp = (x, low, high) => Math.min(high, Math.max(low, x));

export class Orbit {
  // changed: called when there is something else to see; taken: when the user takes the view in hand.
  constructor(canvas, {changed, taken, key}) {
    Object.assign(this, {canvas, changed, taken, key});
    this.target = [0, 0, 0];
    this.distance = 5;
    this.azimuth = 0.6;
    this.elevation = 0.6;
    this.setUp([0, -1, 0]);
    this.pointers = new Map();
    canvas.addEventListener('pointerdown', e => this.down(e));
    canvas.addEventListener('pointermove', e => this.move(e));
    for (const end of ['pointerup', 'pointercancel']) canvas.addEventListener(end, e => this.pointers.delete(e.pointerId));
    canvas.addEventListener('wheel', e => this.wheel(e), {passive: false});
    canvas.addEventListener('keydown', e => this.press(e));
    canvas.addEventListener('contextmenu', e => e.preventDefault());
  }

  // The directions from which azimuths count stay as near as can be to what they were.
  setUp(up) {
    this.up = unit(up);
    let ahead = this.ahead ?? [0, 0, 1];
    if (Math.abs(dot(ahead, this.up)) > 0.9) ahead = this.aside ?? [1, 0, 0];
    this.ahead = unit(add(ahead, this.up, -dot(ahead, this.up)));
    this.aside = cross(this.up, this.ahead);
  }

  // From the target to the viewer.
  direction() {
    const [c, s] = [Math.cos(this.elevation), Math.sin(this.elevation)];
    let d = add([0, 0, 0], this.ahead, c * Math.cos(this.azimuth));
    d = add(d, this.aside, c * Math.sin(this.azimuth));
    return add(d, this.up, s);
  }

  axes() {
    const back = this.direction(), right = unit(cross(this.up, back));
    return {right, above: cross(back, right), back};
  }

  fit(center, radius) {
    this.target = center;
    this.distance = 1.05 * Math.max(radius, 1e-6) / Math.sin(FIELD_OF_VIEW / 2);
  }

  // Column by column, as WebGL takes it.
  clipFromMap(aspect) {
    const {right, above, back} = this.axes();
    const eye = add(this.target, back, this.distance);
    const near = this.distance / 500, far = this.distance * 50;
    // A narrow canvas sees as much across as a square one.
    const f = 1 / Math.tan(FIELD_OF_VIEW / 2) * Math.min(1, aspect);
    const rows = [
      scaled(right, -dot(right, eye), f / aspect),
      scaled(above, -dot(above, eye), f),
      scaled(back, -dot(back, eye), (far + near) / (near - far)),
      scaled(back, -dot(back, eye), -1),
    ];
    rows[2][3] += 2 * far * near / (near - far);
    return new Float32Array([0, 1, 2, 3].flatMap(column => rows.map(row => row[column])));
  }

  turn(azimuth, elevation) {
    this.azimuth -= azimuth;
    this.elevation = clamp(this.elevation + elevation, -STEEPEST, STEEPEST);
    this.act(false);
  }
  // In pixels.
  pan(dx, dy) {
    const {right, above} = this.axes();
    const unitsPerPixel = 2 * this.distance * Math.tan(FIELD_OF_VIEW / 2) / (this.canvas.clientHeight || 1);
    this.target = add(add(this.target, right, -dx * unitsPerPixel), above, dy * unitsPerPixel);
    this.act(true);
  }
  zoom(factor) {
    this.distance = clamp(this.distance * factor, 1e-6, 1e9);
    this.act(true);
  }
  // Turning does not end that the whole map is shown, or that the view stays with the camera.
  act(moved) {
    if (moved) this.taken();
    this.changed();
  }

  down(e) {
    this.canvas.setPointerCapture(e.pointerId);
    this.pointers.set(e.pointerId, [e.clientX, e.clientY]);
  }
  move(e) {
    const last = this.pointers.get(e.pointerId);
    if (!last) return;
    const [dx, dy] = [e.clientX - last[0], e.clientY - last[1]];
    const others = [...this.pointers].filter(([id]) => id !== e.pointerId).map(([, at]) => at);
    this.pointers.set(e.pointerId, [e.clientX, e.clientY]);
    if (others.length === 1) {
      const apart = at => Math.hypot(at[0] - others[0][0], at[1] - others[0][1]) || 1;
      this.zoom(apart(last) / apart([e.clientX, e.clientY]));
      this.pan(dx / 2, dy / 2);
    } else if (e.buttons & 6 || e.shiftKey) {
      this.pan(dx, dy);
    } else {
      this.turn(dx * 0.008, dy * 0.008);
    }
  }
  wheel(e) {
    e.preventDefault();
    this.zoom(Math.exp(clamp(e.deltaY, -200, 200) * 0.0015));
  }
  press(e) {
    if (e.ctrlKey || e.altKey || e.metaKey) return;
    const step = {ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1]}[e.key];
    if (step && e.shiftKey) this.pan(-24 * step[0], -24 * step[1]);
    else if (step) this.turn(0.1 * step[0], 0.1 * step[1]);
    else if (e.key === '+' || e.key === '=') this.zoom(1 / 1.15);
    else if (e.key === '-') this.zoom(1.15);
    else if (!this.key(e.key.toLowerCase())) return;
    e.preventDefault();
  }
}

function scaled(direction, offset, factor) {
  return [...direction, offset].map(x => x * factor);
}
