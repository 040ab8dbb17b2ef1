// SPDX-License-Identifier: BSD-3-Clause
// Listens to the server's events and shows what they tell. Nothing is ever sent but requests for what is shown.
import {MapView} from './map_view.js';
import {showFacts, showLoad, showProcesses, showSubmaps, showWindows, summaryOf} from './tables.js';
import {Timeline} from './timeline.js';

const SILENT_MS = 5000; // the server tells something every second
const RETRY_MS = 2000;
const $ = id => document.getElementById(id);

let view = null;
try {
  view = new MapView($('view'));
} catch (error) {
  console.warn(error);
  $('no-webgl').hidden = false;
  $('empty').hidden = true;
  $('submap-list').open = true;
  for (const part of document.querySelectorAll('.tools, .legend')) part.hidden = true;
}
const timeline = new Timeline($('bars'), $('bars-text'));
const latest = {map: {submaps: []}, timeline: null};

function notice(words, kind = '') {
  $('notice').hidden = !words;
  $('notice').textContent = words;
  $('notice').className = kind;
}

const on = {
  map(map) {
    if (!map.submaps) return;
    latest.map = map;
    view?.setMap(map);
    $('empty').hidden = !view || map.submaps.some(submap => submap.version > 0);
    showSubmaps($('submaps'), map.submaps);
    if (latest.timeline) timeline.set(latest.timeline, map.submaps);
  },
  timeline(told) {
    if (!told.tracked) return;
    latest.timeline = told;
    view?.setTimeline(told);
    timeline.set(told, latest.map.submaps);
  },
  pose(pose) {
    view?.setPose(pose);
    const state = (pose.state ?? 'waiting').toLowerCase().replaceAll('_', ' ');
    $('state').textContent = state;
    $('apart').hidden = pose.state !== 'TRACKING' || Boolean(pose.at) || !latest.map.submaps.length;
    $('state').className = `pill ${state.replaceAll(' ', '-')}`;
  },
  image(utime) {
    image.next = utime;
    loadImage();
  },
  status({bus, live}) {
    showProcesses($('processes'), live.processes);
    showLoad($('load'), live.processes);
    showWindows($('windows'), live.windows ?? []);
    showFacts($('facts'), live);
    $('summary').textContent = summaryOf(live);
    const heard = Object.values(live.processes), alive = heard.some(process => process.state !== 'silent');
    document.body.dataset.processes = alive ? 'alive' : 'none';
    if (alive) notice('');
    else if (heard.length) notice(`No process is on the bus any more (${bus}). What is shown is what was heard last.`);
    else notice(`No process is heard on the bus (${bus}). Start one with: rumi up`);
  },
};

// The next image is asked for when the last one is there.
const image = {next: null, loading: null};
function loadImage() {
  if (image.loading !== null || image.next === null) return;
  [image.loading, image.next] = [image.next, null];
  $('camera').src = `camera.jpg?utime=${image.loading}`;
}
for (const [event, shown] of [['load', true], ['error', false]])
  $('camera').addEventListener(event, () => {
    $('camera').hidden = !shown;
    $('no-camera').hidden = shown;
    image.loading = null;
    loadImage();
  });

let events = null, heardAt = 0, timer = 0;

function connect() {
  events?.close();
  heardAt = performance.now();
  events = new EventSource('events');
  for (const [name, show] of Object.entries(on))
    events.addEventListener(name, event => {
      heardAt = performance.now();
      document.body.dataset.connection = 'open';
      show(JSON.parse(event.data));
    });
}

function lost() {
  document.body.dataset.connection = 'lost';
  notice('The connection to `rumi web` is lost: it has ended, or shows as many pages as it can. Trying again.', 'lost');
  connect();
}

// A page that nobody sees asks for nothing.
function begin() {
  clearInterval(timer);
  if (document.hidden) {
    events?.close();
    return;
  }
  connect();
  timer = setInterval(() => {
    const closed = events.readyState !== EventSource.OPEN;
    if (closed || performance.now() - heardAt > SILENT_MS) lost();
  }, RETRY_MS);
}

if (view) {
  for (const mode of ['fit', 'follow']) $(mode).addEventListener('click', () => view.setMode(mode));
  view.modeChanged = mode => {
    for (const each of ['fit', 'follow']) $(each).setAttribute('aria-pressed', String(each === mode));
  };
  $('top').addEventListener('click', () => view.lookFromAbove());
  for (const part of ['landmarks', 'keyframes', 'links'])
    $(`show-${part}`).addEventListener('change', event => view.show(part, event.target.checked));
}
$('show-more').addEventListener('change', event => $('processes').classList.toggle('all', event.target.checked));
document.addEventListener('visibilitychange', begin);
begin();
