// SPDX-License-Identifier: BSD-3-Clause
// The map in 3D: submaps, where they were joined, and the camera.
import {Drawing, rgba} from './drawing.js';
import {Orbit, add, dot, length, turned} from './orbit.js';
import {readSubmap} from './submap_blob.js';

const CAMERA = '#19191e', JOIN = '#323238', GRID = '#e2e4e8', LOST = '#781e28';
const MANY = 20000;        // landmarks, which are drawn smaller
const MOST_SAMPLES = 4000; // of points that the view is fitted to
const FINEST = 500;        // parts of a path's extent that are told apart
const OUTLIERS = 0.05;     // of landmarks at either end that it is not fitted to

export class MapView {
  constructor(canvas) {
    this.canvas = canvas;
    this.drawing = new Drawing(canvas);
    this.orbit = new Orbit(canvas, {
      changed: () => this.redraw(),
      taken: () => this.setMode('free'),
      key: key => this.press(key),
    });
    this.submaps = new Map(); // by name
    this.shown = {landmarks: true, keyframes: false, links: true};
    this.mode = 'fit'; // the whole map; 'follow': the camera; 'free'
    this.modeChanged = () => {};
    this.lost = [];
    canvas.addEventListener('webglcontextlost', e => e.preventDefault());
    canvas.addEventListener('webglcontextrestored', () => this.restore());
    new ResizeObserver(() => this.redraw()).observe(canvas);
  }

  setMode(mode) {
    this.mode = mode;
    this.modeChanged(mode);
    if (mode === 'fit') this.fit();
    if (mode === 'follow' && this.pose?.at) this.orbit.target = this.pose.at;
    this.redraw();
  }
  lookFromAbove() {
    this.orbit.elevation = Math.PI / 2 - 0.01;
    this.redraw();
  }
  press(key) {
    const action = {h: () => this.setMode('fit'), f: () => this.setMode('follow'), t: () => this.lookFromAbove()}[key];
    action?.();
    return Boolean(action);
  }
  show(what, on) {
    this.shown[what] = on;
    this.redraw();
  }

  // What the server tells; the submaps that are new or have changed are fetched.
  setMap(map) {
    this.map = map;
    const listed = new Set(map.submaps.map(submap => submap.name));
    for (const [name, submap] of this.submaps)
      if (!listed.has(name)) this.forget(name, submap);
    for (const told of map.submaps) {
      const submap = this.submaps.get(told.name) ?? {version: -1};
      this.submaps.set(told.name, submap);
      submap.told = told;
      if (told.version > 0 && told.version !== submap.version) this.fetch(submap);
    }
    if (map.up) this.orbit.setUp(map.up);
    this.setJoins(map.merges ?? []);
    this.refit();
  }
  setTimeline(timeline) {
    const lost = timeline.lost.map(([from, to]) => [timeline.first + from, timeline.first + to]);
    if (JSON.stringify(lost) === JSON.stringify(this.lost)) return;
    this.lost = lost;
    for (const submap of this.submaps.values()) this.uploadPath(submap);
    this.redraw();
  }
  setPose(pose) {
    this.pose = pose;
    if (this.mode === 'follow' && pose.at) this.orbit.target = pose.at;
    this.redraw();
  }

  async fetch(submap) {
    if (submap.fetching) return; // the next event asks again
    submap.fetching = true;
    const version = submap.told.version;
    try {
      const response = await fetch(`submap/${submap.told.name}?version=${version}`);
      if (response.ok) {
        submap.data = readSubmap(await response.arrayBuffer());
        submap.version = version;
        this.upload(submap);
        this.refit();
      }
    } catch (error) { // the connection: main.js tells of it
      console.warn(error);
    }
    submap.fetching = false;
  }

  points(array) { return {buffer: this.drawing.buffer(array), n: array.length / 3}; }
  lines(list) { return {buffer: this.drawing.buffer(new Float32Array(list)), n: list.length / 6}; }
  upload(submap) {
    const {data} = submap;
    if (!data) return;
    this.free(submap, ['landmarks', 'centers', 'pairs']);
    const centers = new Float32Array(data.keyframes.length / 7 * 3);
    for (let i = 0; i < centers.length / 3; ++i) centers.set(data.keyframes.subarray(7 * i, 7 * i + 3), 3 * i);
    submap.landmarks = this.points(data.landmarks);
    submap.centers = this.points(centers);
    submap.pairs = this.lines([...data.pairs].flatMap(i => [...centers.subarray(3 * i, 3 * i + 3)]));
    this.uploadPath(submap);
  }
  uploadPath(submap) {
    if (!submap.data) return;
    this.free(submap, ['path', 'gaps']);
    const {path, gaps} = this.split(submap.data);
    submap.path = this.lines(path);
    submap.gaps = this.lines(gaps);
  }
  free(submap, parts) {
    for (const part of parts) this.drawing.free(submap[part]?.buffer);
  }
  // Where images between two points of the path have no pose, there is a gap. Points that nobody could tell apart are
  // left out.
  split({times, path}) {
    const found = {path: [], gaps: []}, finest = extentOf(path) / FINEST;
    const at = i => path.subarray(3 * i, 3 * i + 3);
    let next = 0, last = 0;
    for (let i = 1; i < times.length; ++i) {
      while (next < this.lost.length && this.lost[next][1] < times[i - 1]) ++next;
      const lost = next < this.lost.length && this.lost[next][0] < times[i];
      const ends = i + 1 === times.length || lost;
      if (lost && last < i - 1) found.path.push(...at(last), ...at(i - 1));
      if (lost) found.gaps.push(...at(i - 1), ...at(i));
      else if (ends || length(add(at(i), at(last), -1)) >= finest) found.path.push(...at(last), ...at(i));
      else continue;
      last = i;
    }
    return found;
  }
  setJoins(merges) {
    this.free(this.joins ?? {}, ['lines', 'rings']);
    const ends = new Float32Array(merges.flatMap(m => [...m.a, ...m.b]));
    this.joins = {lines: this.lines(ends), rings: this.points(ends)};
    this.redraw();
  }
  forget(name, submap) {
    this.free(submap, ['landmarks', 'path', 'gaps', 'centers', 'pairs']);
    this.submaps.delete(name);
  }
  restore() {
    this.drawing.prepare();
    for (const submap of this.submaps.values()) this.upload(submap);
    this.setJoins(this.map?.merges ?? []);
    this.bounds = null;
    this.redraw();
  }

  placed() {
    return [...this.submaps.values()].filter(submap => submap.data && submap.told.placed);
  }
  refit() {
    this.bounds = null;
    if (this.mode === 'fit') this.fit();
    this.redraw();
  }
  // Along the axes of the view's ground: what the path and most landmarks take; far landmarks do not shrink the path.
  measure() {
    if (this.bounds) return this.bounds;
    const {ahead, aside, up} = this.orbit, axes = [ahead, aside, up];
    const paths = sample(this.placed().map(s => s.data.path)), marks = sample(this.placed().map(s => s.data.landmarks));
    if (!paths.length && !marks.length) return null;
    const ranges = axes.map(axis => range(paths.map(p => dot(p, axis)), 0));
    const extent = Math.max(...ranges.map(([low, high]) => high - low), 0);
    const all = axes.map((axis, i) => {
      const [low, high] = range(marks.map(p => dot(p, axis)), OUTLIERS), [from, to] = ranges[i];
      if (low > high || !paths.length) return low > high ? [from, to] : [low, high];
      return [Math.min(from, Math.max(low, from - 1.2 * extent)), Math.max(to, Math.min(high, to + 1.2 * extent))];
    });
    const middle = all.map(([low, high]) => (low + high) / 2);
    const center = axes.reduce((sum, axis, i) => add(sum, axis, middle[i]), [0, 0, 0]);
    const radius = 0.5 * Math.hypot(...all.map(([low, high]) => high - low));
    return this.bounds = {center, radius: radius || 1, floor: all[2][0] - middle[2], extent};
  }
  fit() {
    const bounds = this.measure();
    if (bounds) this.orbit.fit(bounds.center, 0.85 * bounds.radius);
  }

  redraw() {
    if (this.asked) return;
    this.asked = true;
    requestAnimationFrame(() => {
      this.asked = false;
      this.draw();
    });
  }
  draw() {
    const {drawing, canvas} = this;
    if (drawing.gl.isContextLost()) return;
    drawing.begin(this.orbit.clipFromMap((canvas.clientWidth || 1) / (canvas.clientHeight || 1)));
    const submaps = this.placed();
    this.drawGrid();
    const landmarks = submaps.reduce((sum, s) => sum + s.landmarks.n, 0);
    const style = landmarks < MANY ? {opacity: 0.75, size: 2.6} : {opacity: 0.6, size: 2};
    if (this.shown.landmarks)
      for (const s of submaps) this.drawPoints(s.landmarks, {color: rgba(s.told.color, style.opacity), size: style.size});
    for (const s of submaps) this.drawSubmap(s);
    drawing.onTop(() => {
      if (this.shown.links && this.joins) this.drawJoins();
      this.drawCamera();
    });
    canvas.dataset.landmarks = landmarks;
    canvas.dataset.submaps = submaps.length;
    canvas.dataset.camera = this.pose?.at ? 'placed' : 'none';
  }
  drawPoints({buffer, n}, style) { this.drawing.drawPoints(buffer, n, style); }
  drawLines({buffer, n}, style) { this.drawing.drawLines(buffer, n, style); }
  // As in the pictures: a front submap is a full line, a back submap a wider one with a white core.
  drawSubmap(s) {
    const isBack = s.told.kind === 'back';
    if (this.shown.keyframes) {
      this.drawLines(s.pairs, {color: rgba(s.told.color, 0.18), width: 1});
      this.drawPoints(s.centers, {color: rgba(s.told.color), size: 6});
    }
    this.drawLines(s.gaps, {color: rgba(LOST), width: 1.6, dash: 4});
    this.drawLines(s.path, {color: rgba(s.told.color), width: isBack ? 5.5 : 3.2, round: true});
    if (isBack) this.drawLines(s.path, {color: rgba('#ffffff'), width: 2, round: true});
  }
  drawJoins() {
    this.drawLines(this.joins.lines, {color: rgba(JOIN), width: 1.5});
    this.drawPoints(this.joins.rings, {color: rgba(JOIN), size: 9, ring: true});
  }
  drawCamera() {
    const bounds = this.measure();
    if (!this.pose?.at || !bounds) return;
    const {aspect, half_width} = this.map?.camera ?? {aspect: 4 / 3, half_width: 0.6};
    const depth = 0.08 * bounds.radius, x = depth * half_width, y = x / aspect;
    const corner = (sx, sy) => add(this.pose.at, turned(this.pose.turn, [sx * x, sy * y, depth]));
    const corners = [corner(-1, -1), corner(1, -1), corner(1, 1), corner(-1, 1)];
    const above = add(this.pose.at, turned(this.pose.turn, [0, -1.6 * y, depth])); // tells up from down
    const list = corners.flatMap((c, i) => [...this.pose.at, ...c, ...c, ...corners[(i + 1) % 4]]);
    list.push(...corners[0], ...above, ...above, ...corners[1]);
    this.drawOnce(list, {color: rgba(CAMERA), width: 2});
  }
  drawGrid() {
    const bounds = this.measure();
    if (!bounds) return;
    const {ahead, aside, up} = this.orbit, cell = roundLength(bounds.radius / 5), n = 8;
    const center = add(bounds.center, up, bounds.floor);
    const at = (i, k) => add(add(center, ahead, i * cell), aside, k * cell);
    const list = [];
    for (let i = -n; i <= n; ++i) list.push(...at(i, -n), ...at(i, n), ...at(-n, i), ...at(n, i));
    this.drawOnce(list, {color: rgba(GRID), width: 1});
  }
  drawOnce(list, style) {
    const buffer = this.drawing.buffer(new Float32Array(list));
    this.drawing.drawLines(buffer, list.length / 6, style);
    this.drawing.free(buffer);
  }
}

// Of the box around all points.
function extentOf(points) {
  const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
  for (let i = 0; i < points.length; ++i) {
    low[i % 3] = Math.min(low[i % 3], points[i]);
    high[i % 3] = Math.max(high[i % 3], points[i]);
  }
  return points.length ? length(add(high, low, -1)) : 0;
}

// At most MOST_SAMPLES of the points in all of the arrays.
function sample(arrays) {
  const all = arrays.reduce((sum, array) => sum + array.length / 3, 0), step = 3 * Math.ceil(all / MOST_SAMPLES);
  const points = [];
  for (const array of arrays)
    for (let i = 0; i < array.length; i += step) points.push([array[i], array[i + 1], array[i + 2]]);
  return points;
}

// From the smallest to the largest value, without a share at either end; of none [Infinity, -Infinity].
function range(values, share) {
  if (!values.length) return [Infinity, -Infinity];
  values.sort((a, b) => a - b);
  const cut = Math.floor(share * values.length);
  return [values[cut], values[values.length - 1 - cut]];
}

// 1, 2 or 5 times a power of ten.
function roundLength(length) {
  const power = 10 ** Math.floor(Math.log10(length));
  return power * ([5, 2].find(factor => factor * power <= length) ?? 1);
}
