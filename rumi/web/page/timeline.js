// SPDX-License-Identifier: BSD-3-Clause
// Two bars as below the pictures: what became of the images as they came, and where they are in the map now.

// States of track_t, and colours as in viewer_offscreen/canvas/palette.h.
const NOT_TRACKED = {
  0: {words: 'not initialized', color: '#b0b2b8', height: 0.3},
  2: {words: 'recently lost', color: '#be7882', height: 0.55},
  3: {words: 'lost', color: '#781e28', height: 0.55},
};
const LABELS = 74, AXIS = 16, BAR = 18, GAP = 5; // pixels
const FRAME = '#d6d6d2', MUTED = '#63666e', EMPTY = '#efefec';

export class Timeline {
  constructor(canvas, text) {
    Object.assign(this, {canvas, text, submaps: []});
    canvas.addEventListener('pointermove', e => this.point(e.offsetX));
    canvas.addEventListener('pointerleave', () => this.point(null));
    new ResizeObserver(() => this.draw()).observe(canvas);
  }

  set(timeline, submaps) {
    this.timeline = timeline;
    this.submaps = submaps;
    this.draw();
  }

  x(seconds) {
    return LABELS + (this.canvas.clientWidth - LABELS - 6) * seconds / (this.timeline.end || 1);
  }
  draw() {
    const {canvas, timeline} = this, scale = window.devicePixelRatio || 1;
    canvas.width = Math.round(canvas.clientWidth * scale);
    canvas.height = Math.round(canvas.clientHeight * scale);
    const c = canvas.getContext('2d');
    c.scale(scale, scale);
    c.font = '12px system-ui, "DejaVu Sans", sans-serif';
    c.textBaseline = 'middle';
    c.fillStyle = MUTED;
    c.fillText('as it came', 0, BAR / 2);
    c.fillText('in the map', 0, BAR + GAP + BAR / 2);
    c.fillStyle = EMPTY;
    for (const y of [0, BAR + GAP]) c.fillRect(LABELS, y, canvas.clientWidth - LABELS - 6, BAR);
    if (!timeline?.frames) return this.point(null);
    this.drawAxis(c);
    for (const [from, to, state, submap] of timeline.tracked) this.drawSpan(c, 0, from, to, this.look(state, submap));
    for (const [from, to, submap] of timeline.placed)
      if (submap >= 0) this.drawSpan(c, BAR + GAP, from, to, this.look(1, submap));
    this.point(null);
  }
  look(state, submap) {
    return NOT_TRACKED[state] ?? {color: this.submaps[submap]?.color ?? '#8a8d94', height: 1,
      core: this.submaps[submap]?.kind === 'back'};
  }
  drawSpan(c, y, from, to, {color, height, core}) {
    const x = this.x(from), width = Math.max(1, this.x(to) - x);
    c.fillStyle = color;
    c.fillRect(x, y + BAR * (1 - height), width, BAR * height);
    c.fillStyle = '#fff';
    if (core) c.fillRect(x, y + BAR / 2 - 2, width, 4);
  }
  drawAxis(c) {
    const {end} = this.timeline, top = 2 * BAR + GAP;
    const most = Math.max(2, (this.canvas.clientWidth - LABELS) / 70);
    const step = [1, 2, 5, 10, 20, 30, 60, 120, 300, 600, 1200, 1800, 3600].find(s => end / s <= most) ?? 7200;
    c.fillStyle = MUTED;
    for (let t = 0; t <= end; t += step) {
      c.fillRect(this.x(t), top + 1, 1, 4);
      const words = clock(t), half = c.measureText(words).width / 2;
      c.fillText(words, Math.min(this.x(t) - half, this.canvas.clientWidth - 2 * half), top + AXIS - 3);
    }
    c.strokeStyle = FRAME;
  }

  // In words: what is below the pointer, else all of it.
  point(x) {
    const {timeline} = this;
    if (!timeline?.frames) return this.say('No image was tracked yet');
    const seconds = x === null ? -1 : (x - LABELS) / (this.canvas.clientWidth - LABELS - 6) * timeline.end;
    if (seconds < 0)
      return this.say(`${timeline.in_map} of ${timeline.frames} images have a pose in the map` +
        (timeline.filled ? `, ${timeline.filled} of them by what was rebuilt alone` : ''));
    const at = spans => spans.findLast(span => span[0] <= seconds);
    const came = at(timeline.tracked), now = at(timeline.placed);
    const then = came ? NOT_TRACKED[came[2]]?.words ?? `tracked in ${this.name(came[3])}` : 'not heard of';
    this.say(`${clock(seconds)}: ${then}; now ${now?.[2] >= 0 ? `in ${this.name(now[2])}` : 'without a pose in the map'}`);
  }
  name(index) {
    const submap = this.submaps[index];
    return submap ? `${submap.kind} submap ${Math.abs(submap.id)}` : 'a submap that was not told of yet';
  }
  say(words) {
    this.text.textContent = words;
  }
}

export function clock(seconds) {
  const whole = Math.floor(seconds), pad = n => String(n).padStart(2, '0');
  if (whole < 60) return `${whole} s`;
  if (whole < 3600) return `${Math.floor(whole / 60)}:${pad(whole % 60)}`;
  return `${Math.floor(whole / 3600)}:${pad(Math.floor(whole / 60) % 60)}:${pad(whole % 60)}`;
}
