// SPDX-License-Identifier: BSD-3-Clause
// Processes, windows, submaps and the facts beside the camera's image. All text is set as text, never as HTML.

const number = (value, digits = 0) => value === null || value === undefined ? '–'
  : value.toLocaleString('en', {minimumFractionDigits: digits, maximumFractionDigits: digits});

function element(name, text, classes = '') {
  const made = document.createElement(name);
  made.textContent = text;
  if (classes) made.className = classes;
  return made;
}

function row(cells) {
  const made = document.createElement('tr');
  made.append(...cells);
  return made;
}

const cell = (text, classes) => element('td', text, classes);

function wholeRow(text, columns, classes = 'text muted') {
  const whole = cell(text, classes);
  whole.colSpan = columns;
  return row([whole]);
}

function fill(table, titles, rows, none) {
  const head = row(titles.map(([title, classes]) => element('th', title, classes)));
  if (!rows.length) rows = [wholeRow(none, titles.length)];
  table.replaceChildren(head, ...rows);
}

const LEFT = 'text';

export function showProcesses(table, processes) {
  const rows = Object.entries(processes).flatMap(([name, p]) => {
    const cpu = cell(`${number(p.cpu_percent)} %`), bar = document.createElement('meter');
    bar.max = 100;
    bar.value = p.cpu_percent;
    cpu.append(bar);
    const lost = p.dropped + p.undecodable;
    return [row([cell(name), cell(p.state, `text ${p.state}`), cpu, cell(`${number(p.memory_mb)} MB`),
      cell(number(p.in_hz, 1)), cell(number(p.out_hz, 1)), cell(number(lost), lost ? 'count-bad' : ''),
      cell(number(p.waiting)), cell(number(p.cpu_ms_per_frame, 1))]), saysRow(p, 9)].filter(Boolean);
  });
  fill(table, [['process', LEFT], ['state', LEFT], ['CPU'], ['memory'], ['in/s'], ['out/s'], ['dropped'], ['waiting'],
    ['CPU ms/frame']], rows, 'None was heard of');
}

function saysRow(p, columns) {
  const stages = Object.entries(p.cpu_ms_per_frame_by_stage).filter(([, ms]) => ms > 0).sort((a, b) => b[1] - a[1]);
  const cost = stages.slice(0, 5).map(([stage, ms]) => `${stage.replace(/^.*\./, '')} ${number(ms, 1)}`).join(', ');
  const text = [p.detail, cost && `ms/frame: ${cost}`].filter(Boolean).join(' · ');
  if (!text) return null;
  const says = wholeRow(text, columns, 'text says');
  says.className = `more ${p.state}`;
  return says;
}

export function showLoad(place, processes) {
  const all = Object.values(processes).filter(p => p.state !== 'silent');
  const sum = name => all.reduce((total, p) => total + p[name], 0);
  place.textContent = all.length ? `${number(sum('cpu_percent'))} % of a core, ${number(sum('memory_mb'))} MB` : '';
}

export function showWindows(table, windows) {
  const rows = [...windows].reverse().map(w => {
    const state = w.state + (w.progress > 0 && w.progress < 1 ? ` ${number(100 * w.progress)} %` : '');
    const made = row([cell(w.id), cell(state, `text ${w.state}`), cell(number(w.images))]);
    return w.reason ? [made, wholeRow(w.reason, 3, 'text says')] : [made];
  }).flat();
  fill(table, [['window', LEFT], ['state', LEFT], ['images']], rows, 'Tracking was not lost yet');
}

export function showSubmaps(table, submaps) {
  const rows = submaps.map(s => {
    const name = cell(''), swatch = element('span', '', 'swatch');
    swatch.style.background = s.color;
    name.append(swatch, `${s.kind} ${Math.abs(s.id)}`);
    return row([name, cell(s.placed ? 'in the map' : 'not joined', LEFT), cell(s.closed ? 'closed' : 'growing', LEFT),
      cell(number(s.frames)), cell(number(s.keyframes)), cell(number(s.landmarks))]);
  });
  fill(table, [['submap', LEFT], ['place', LEFT], ['', LEFT], ['images'], ['keyframes'], ['landmarks']], rows, 'None yet');
}

export function showFacts(list, {tracking: t, map: m}) {
  const facts = [];
  if (t) facts.push(['tracked, last 5 s', `${number(t.tracked_percent)} %`],
    ['images', `${number(t.rate_hz, 1)} /s`],
    ['landmarks agree', number(t.inliers)],
    ['latency, median / 95 %', `${number(t.latency_p50_ms)} / ${number(t.latency_p95_ms)} ms`]);
  if (m) facts.push(['submaps in the map', `${m.submaps_in_map} of ${m.front_submaps + m.back_submaps}`],
    ['keyframes', number(m.keyframes)], ['landmarks', number(m.landmarks)]);
  if (!facts.length) facts.push(['tracking', 'nothing heard yet']);
  list.replaceChildren(...facts.flatMap(([name, value]) => [element('dt', name), element('dd', value)]));
}

export function summaryOf({tracking: t, map: m}) {
  const parts = [];
  if (t) parts.push(`${number(t.rate_hz, 1)} images/s`);
  if (m) parts.push(`${number(m.frames_in_map)} of ${number(m.frames)} images in the map`);
  if (m?.merging) parts.push('joining');
  return parts.join(' · ');
}
