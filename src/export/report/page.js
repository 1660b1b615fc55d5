// What the reader does: scale, bodies, paths, places, mouse and keys.

/** An element with a class and a text; texts of the job never become markup. */
function make(tag, text, className) {
  const element = document.createElement(tag);
  if (text !== undefined) element.textContent = text;
  if (className) element.className = className;
  return element;
}

// Colour bar.
const um = v => `${+v.toPrecision(3)}`;

function drawScale() {
  const bar = $('scale'), scale = ratio(), context = bar.getContext('2d');
  bar.width = Math.round(bar.clientWidth * scale);
  bar.height = Math.round(bar.clientHeight * scale);
  context.setTransform(scale, 0, 0, scale, 0, 0);
  const width = bar.clientWidth, edge = 16, inner = width - 2 * edge, high = 18;
  const style = getComputedStyle(document.documentElement);
  const mix = t => {
    const at = (t + 1) * 3, i = Math.min(Math.max(Math.floor(at), 0), 5), s = at - i;
    const [a, b] = [rgb(STOPS[i]), rgb(STOPS[i + 1])];
    return `rgb(${a.map((v, k) => Math.round(255 * (v + (b[k] - v) * s))).join(' ')})`;
  };
  for (let x = 0; x < inner; x++) {
    let t = 2 * (x + 0.5) / inner - 1;
    if (show.bands) t = Math.sign(t) * (Math.min(Math.floor(Math.abs(t) * 5), 4) + 0.5) / 5;
    context.fillStyle = mix(t);
    context.fillRect(edge + x, 0, 1.5, high);
  }
  context.fillStyle = SPECIAL.under;
  context.fillRect(0, 0, edge - 2, high);
  context.fillStyle = SPECIAL.over;
  context.fillRect(width - edge + 2, 0, edge - 2, high);
  context.font = '12px system-ui, "Segoe UI", "DejaVu Sans", sans-serif';
  context.textBaseline = 'alphabetic';
  context.fillStyle = context.strokeStyle = style.getPropertyValue('--ink').trim();
  const [low, left] = show.scale;
  context.beginPath();
  // Labels between the ends only where there is room for them.
  const room = inner / 4 - 6;
  for (const [t, label, align] of [[-1, `−${um(low)}`, 'left'], [-0.5, `−${um(low / 2)}`, 'center'], [0, '0', 'center'], [0.5, um(left / 2), 'center'], [1, `${um(left)} µm`, 'right']]) {
    const x = edge + (t + 1) / 2 * inner;
    context.moveTo(x, high - 4);
    context.lineTo(x, high + 4);
    if (Math.abs(t) === 0.5 && 0.5 * context.measureText(label).width + context.measureText(t < 0 ? `−${um(low)}` : `${um(left)} µm`).width > room + edge) continue;
    context.textAlign = align;
    context.fillText(label, align === 'left' ? 2 : align === 'right' ? width - 2 : x, high + 17);
  }
  context.stroke();
}

function describeScale() {
  const list = $('legend');
  list.replaceChildren();
  const entries = [
    [SPECIAL.under, `cut deeper than ${um(show.scale[0])} µm`], [SPECIAL.over, `left more than ${um(show.scale[1])} µm`],
    [SPECIAL.unreached, 'not reached'], [SPECIAL.unmilled, 'turned'],
  ];
  for (const [colour, text] of entries) {
    const item = make('li'), swatch = make('i');
    swatch.style.background = colour;
    item.append(swatch, text);
    list.append(item);
  }
  $('low').value = um(show.scale[0]);
  $('high').value = um(show.scale[1]);
}

function setScale(low, high) {
  const good = v => Number.isFinite(v) && v > 0;
  if (good(low) && good(high)) show.scale = [low, high];
  describeScale();
  drawScale();
  redraw();
}

for (const id of ['low', 'high']) {
  $(id).addEventListener('change', () => setScale(parseFloat($('low').value), parseFloat($('high').value)));
}
$('scale-reset').addEventListener('click', () => setScale(...data.scale.map(v => v * 1e3)));
$('bands').addEventListener('change', event => { show.bands = event.target.checked; drawScale(); redraw(); });

// Bodies: the finished part, the blank, the stock after each operation.
const bodies = [['part', 'finished part, by deviation'], ['blank', 'turned blank'],
  ...data.stock.map((s, i) => [String(i), `stock ${s.name}`]), ['none', 'nothing, paths only']];
for (const [value, text] of bodies) {
  const option = make('option', text);
  option.value = value;
  $('body').append(option);
}
function setBody(value) {
  show.body = /^\d+$/.test(value) ? Number(value) : value;
  $('body').value = value;
  const s = data.stock[show.body];
  const drawn = s ? Math.max(s.cell, s.mesh_cell) : 0;
  $('stock-note').textContent = data.stock.length === 0 ? 'The stock after each operation was not simulated.'
    : s ? `Simulated in cells of ${data.cell} mm${drawn > data.cell ? `, drawn in cells of ${+drawn.toFixed(2)} mm` : ''}: edges look ragged by that much, and nothing smaller is sure to be seen. A smaller --stock-cell shows more.` : '';
  redraw();
}
$('body').addEventListener('change', event => setBody(event.target.value));

// Paths by operation.
const pathBoxes = data.paths.operations.map((o, k) => {
  const label = make('label'), box = make('input'), swatch = make('i', undefined, 'swatch');
  box.type = 'checkbox';
  swatch.style.background = colourOf(k);
  box.addEventListener('change', () => { show.operations[k] = box.checked; redraw(); });
  label.append(box, swatch, o.name);
  label.title = `${o.name}: tool ${o.tool}, ${o.speed} rpm, ${o.feed} mm/min`;
  $('operations').append(label);
  return box;
});
for (const box of document.querySelectorAll('[data-kind]')) {
  box.addEventListener('change', () => { show.kinds[Number(box.dataset.kind)] = box.checked; redraw(); });
}

// The tool on its way.
function setMove(i, share) {
  if (!moves.count) return;
  show.move = Math.min(Math.max(i, 0), moves.count - 1);
  show.share = Math.min(Math.max(share, 0), 1);
  $('time').value = timeOf(show.move, show.share);
  $('move').textContent = `${describeMove(show.move)}\n${figuresOf(show.move, show.share)}`;
  redraw();
  redrawPlots();
}
function setTime(t) {
  const i = moveAt(t), before = i ? moves.end[i - 1] : 0, size = moves.end[i] - before;
  setMove(i, size > 0 ? (t - before) / size : 1);
}
function showTool(on) {
  show.tool = on;
  $('tool').checked = on;
  redraw();
}
$('time').max = moves.total;
$('time').addEventListener('input', event => { showTool(true); setTime(Number(event.target.value)); });
$('tool').addEventListener('change', event => showTool(event.target.checked));
let playing = false;
function play(on) {
  playing = on;
  $('play').setAttribute('aria-pressed', String(on));
  $('play').textContent = on ? 'stop' : 'play';
  if (!on || !moves.count) return;
  showTool(true);
  let last = performance.now();
  const step = now => {
    if (!playing) return;
    const t = timeOf(show.move, show.share) + (now - last) / 1e3 * Number($('pace').value);
    last = now;
    setTime(Math.min(t, moves.total));
    if (t < moves.total) requestAnimationFrame(step); else play(false);
  };
  requestAnimationFrame(step);
}
$('play').addEventListener('click', () => play(!playing));

// Places: a click shows them from where nothing hides them.
const placeButtons = [];
let group = null;
const groups = [...new Set(data.places.map(p => p.group))].sort((a, b) => (b === 'contracts') - (a === 'contracts'));
const listed = groups.flatMap(g => data.places.map((p, i) => [p, i]).filter(([p]) => p.listed && p.group === g).sort((a, b) => b[0].rank - a[0].rank));
listed.forEach(([p, i]) => {
  if (p.group !== group) { $('places').append(make('h3', p.group)); group = p.group; }
  const button = make('button', undefined, p.fails ? 'fails' : '');
  button.type = 'button';
  button.append(make('span', p.listed), make('b', p.value));
  button.title = p.program;
  button.addEventListener('click', () => showPlace(i));
  $('places').append(button);
  placeButtons[i] = button;
});
if (!data.places.length) $('places').append(make('p', 'There are none.', 'small'));

function showPlace(i) {
  const p = data.places[i];
  play(false);
  setBody('part');
  show.mark = p.point;
  placeButtons.forEach((b, k) => b.setAttribute('aria-current', String(k === i)));
  $('readout').textContent = [`${p.name}: ${p.value}`, p.program, `at ${p.point.map(v => v.toFixed(3)).join(', ')} mm`].filter(Boolean).join('\n');
  held = true;
  if (p.at) {
    setMove(pageMove(...p.at), 1);
    pathBoxes.forEach((box, k) => { show.operations[k] = box.checked = k === p.at[0] && moves.count > 0; });
    const t = timeOf(show.move, 1), size = Math.min(span.to - span.from, 60);
    setSpan(t - size / 2, t + size / 2);
  }
  if (scene) fly({ ...sight(p.point, p.normal), target: p.point, distance: 0.75 * outline() });
}
for (const button of document.querySelectorAll('[data-place]')) {
  button.addEventListener('click', () => {
    showPlace(Number(button.dataset.place));
    canvas.scrollIntoView({ block: 'nearest' });
  });
}

// Views and mouse.
const VIEWS = {
  all: HOME, top: { ...HOME, azimuth: -Math.PI / 2, elevation: Math.PI / 2 - 1e-4 },
  front: { ...HOME, azimuth: -Math.PI / 2, elevation: 0 }, side: { ...HOME, azimuth: 0, elevation: 0 },
};
function forget() {
  show.mark = null;
  held = false;
  $('readout').textContent = '';
  placeButtons.forEach(b => b.removeAttribute('aria-current'));
}
for (const button of document.querySelectorAll('[data-view]')) {
  button.addEventListener('click', () => { forget(); fly(VIEWS[button.dataset.view]); });
}

/** True while the readout tells of a place and not of what lies under the pointer. */
let held = false;
function turn(dx, dy) {
  flight++;
  camera.azimuth -= dx;
  camera.elevation = Math.min(Math.max(camera.elevation + dy, -1.57), 1.57);
  redraw();
}
function shift(dx, dy) {
  flight++;
  const { right, up } = frameOf(camera);
  const size = 2 * FIELD * camera.distance / Math.max(canvas.clientHeight, 1);
  camera.target = camera.target.map((v, k) => v - (dx * right[k] - dy * up[k]) * size);
  redraw();
}
function zoom(factor) {
  flight++;
  camera.distance = Math.min(Math.max(camera.distance * factor, 0.5), 30 * RADIUS);
  redraw();
}
const place = event => {
  const box = event.currentTarget.getBoundingClientRect();
  return [event.clientX - box.left, event.clientY - box.top];
};
let drag = null;
canvas.addEventListener('contextmenu', event => event.preventDefault());
canvas.addEventListener('pointerdown', event => {
  canvas.setPointerCapture(event.pointerId);
  drag = { at: place(event), shifts: event.button !== 0 || event.shiftKey };
});
canvas.addEventListener('pointermove', event => {
  const at = place(event);
  if (drag) {
    const [dx, dy] = [at[0] - drag.at[0], at[1] - drag.at[1]];
    if (drag.shifts) shift(dx, dy); else turn(dx * 0.008, dy * 0.008);
    drag.at = at;
  } else {
    look(at);
  }
});
for (const name of ['pointerup', 'pointercancel']) canvas.addEventListener(name, () => { drag = null; });
canvas.addEventListener('pointerleave', () => { if (!held) $('readout').textContent = ''; });
canvas.addEventListener('wheel', event => { event.preventDefault(); zoom(Math.exp(event.deltaY * 0.0012)); }, { passive: false });
canvas.addEventListener('dblclick', event => {
  const target = pick(...place(event), true);
  if (target) fly({ ...camera, target, distance: camera.distance * 0.6 });
});
canvas.addEventListener('keydown', event => {
  const step = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key];
  if (step && event.shiftKey) shift(30 * step[0], 30 * step[1]);
  else if (step) turn(0.12 * step[0], 0.12 * step[1]);
  else if (event.key === '+' || event.key === '=') zoom(0.85);
  else if (event.key === '-') zoom(1 / 0.85);
  else if (event.key === '0') { forget(); fly(HOME); }
  else return;
  event.preventDefault();
});

/** Tells what lies under the pointer, once a frame. */
let looking = null;
function look(at) {
  if (held || !scene) return;
  const first = looking === null;
  looking = at;
  if (!first) return;
  requestAnimationFrame(() => {
    const found = pick(...looking, false);
    looking = null;
    if (held) return;
    if (!found) { $('readout').textContent = ''; return; }
    const surface = data.part.surfaces[found.surface];
    const name = `${surface ? surface.name : 'surface'} ${found.sector}`;
    const value = found.code === NOT_REACHED ? 'not reached' : found.code === NOT_MILLED ? 'turned, not milled'
      : `${decode(found.code) < 0 ? 'cut' : 'left'} ${Math.abs(decode(found.code)).toFixed(2)} µm`;
    $('readout').textContent = `${name}: ${value}`;
  });
}

// Mouse and keys of the plots.
let plotDrag = null;
plots.addEventListener('wheel', event => {
  event.preventDefault();
  zoomSpan(Math.exp(event.deltaY * 0.0015), Math.min(Math.max((place(event)[0] - LEFT) / layout().width, 0), 1));
}, { passive: false });
plots.addEventListener('pointerdown', event => {
  plots.setPointerCapture(event.pointerId);
  plotDrag = { x: place(event)[0], from: span.from, moved: false };
});
plots.addEventListener('pointermove', event => {
  if (!plotDrag) return;
  const dx = place(event)[0] - plotDrag.x;
  plotDrag.moved ||= Math.abs(dx) > 3;
  const size = span.to - span.from;
  if (plotDrag.moved) setSpan(plotDrag.from - dx / layout().width * size, plotDrag.from - dx / layout().width * size + size);
});
plots.addEventListener('pointerup', event => {
  if (plotDrag && !plotDrag.moved) {
    const share = Math.min(Math.max((place(event)[0] - LEFT) / layout().width, 0), 1);
    showTool(true);
    setTime(span.from + share * (span.to - span.from));
  }
  plotDrag = null;
});
plots.addEventListener('keydown', event => {
  if (event.key === 'ArrowRight') setMove(show.move + 1, 1);
  else if (event.key === 'ArrowLeft') setMove(show.move - 1, 1);
  else if (event.key === '+' || event.key === '=') zoomSpan(0.7, 0.5);
  else if (event.key === '-') zoomSpan(1 / 0.7, 0.5);
  else if (event.key === 'Home') setSpan(0, moves.total);
  else return;
  event.preventDefault();
});

$('theme').addEventListener('click', () => {
  const root = document.documentElement;
  const dark = root.dataset.theme ? root.dataset.theme === 'dark' : matchMedia('(prefers-color-scheme: dark)').matches;
  root.dataset.theme = dark ? 'light' : 'dark';
  drawScale();
  drawPlots();
});

// Begin.
if (gl) {
  scene = build();
  canvas.addEventListener('webglcontextlost', event => { event.preventDefault(); scene = null; $('fault').hidden = false; });
} else {
  $('fault').hidden = false;
}
describeScale();
setBody('part');
setMove(0, 1);
addEventListener('resize', () => { resize(); drawScale(); drawPlots(); });
resize();
drawScale();
drawPlots();
document.documentElement.dataset.drawn = 'yes';
