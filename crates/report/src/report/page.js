// What the reader chooses: scale, body, section, paths, playback, places.

/** An element with a class and a text; texts of the job never become markup. */
function make(tag, text, className) {
  const element = document.createElement(tag);
  if (text !== undefined) element.textContent = text;
  if (className) element.className = className;
  return element;
}

// Colour bar.
const um = v => `${+v.toPrecision(3)}`;

/** Colour of a deviation in units of the tolerance, as the picture of the part has it. */
function colourOfShare(t) {
  const side = t < 0 ? 0 : 1, mix = (a, b, s) => rgb(a).map((v, k) => v + (rgb(b)[k] - v) * s);
  let a = Math.abs(t), colour;
  if (a <= 1) {
    if (show.bands) a = Math.floor(a * 4) / 4;
    colour = mix(COLOUR.neutral, COLOUR.shades[side], a * shaded()[side]);
  } else {
    let x = 2 * Math.min((a - 1) / (BEYOND - 1), 1);
    if (show.bands) x = Math.min(Math.floor(x * 2) / 2, 2);
    const ramp = side ? COLOUR.excess : COLOUR.gouge;
    colour = x < 1 ? mix(ramp[0], ramp[1], x) : mix(ramp[1], ramp[2], x - 1);
  }
  return `rgb(${colour.map(v => Math.round(255 * v)).join(' ')})`;
}

/** Share of the bar from its middle to an end that the tolerance takes. */
const INSIDE = 0.48;

function drawScale() {
  const bar = $('scale'), scale = ratio(), context = bar.getContext('2d');
  bar.width = Math.round(bar.clientWidth * scale);
  bar.height = Math.round(bar.clientHeight * scale);
  context.setTransform(scale, 0, 0, scale, 0, 0);
  const width = bar.clientWidth, high = 20, [low, left] = show.scale;
  for (let x = 0; x < width; x++) {
    const s = 2 * (x + 0.5) / width - 1, a = Math.abs(s);
    context.fillStyle = colourOfShare(Math.sign(s) * (a < INSIDE ? a / INSIDE : 1 + 1e-9 + (a - INSIDE) / (1 - INSIDE) * (BEYOND - 1)));
    context.fillRect(x, 0, 1.5, high);
  }
  context.font = '12px system-ui, "Segoe UI", "DejaVu Sans", sans-serif';
  context.fillStyle = context.strokeStyle = getComputedStyle(document.documentElement).getPropertyValue('--ink').trim();
  context.beginPath();
  const at = s => (s + 1) / 2 * width;
  for (const [s, label, align] of [[-1, `−${um(BEYOND * low)}`, 'left'], [-INSIDE, `−${um(low)}`, 'center'], [0, '0', 'center'], [INSIDE, um(left), 'center'], [1, `${um(BEYOND * left)} µm`, 'right']]) {
    if (Math.abs(s) < 1) {
      context.moveTo(at(s), high - 4);
      context.lineTo(at(s), high + 4);
    }
    context.textAlign = align;
    context.fillText(label, align === 'left' ? 1 : align === 'right' ? width - 1 : at(s), high + 17);
  }
  context.stroke();
  context.fillStyle = '#222';
  context.textAlign = 'center';
  context.fillText(show.required.some(r => r) ? 'inside tolerance' : 'inside the scale', at(0), 14);
}

/** Says where the ends of the tolerance come from. */
function scaleNote() {
  const [gouge, excess] = show.required, given = show.scale.some((v, k) => v !== data.scale[k] * 1e3);
  if (given) return 'Tolerance as entered here.';
  if (gouge && excess) return 'Tolerance as the contracts require.';
  const free = gouge ? 'excess' : 'gouge';
  return gouge || excess
    ? `No contract bounds the ${free}: 99 % of what is finished lies inside that end.`
    : 'No contract bounds gouge or excess: 99 % of what is finished lies inside the scale.';
}

function describeScale() {
  const list = $('legend');
  list.replaceChildren();
  const entries = [
    [COLOUR.neutral, 'inside tolerance'], [COLOUR.gouge[1], 'cut too deep'], [COLOUR.excess[1], 'too much left'],
    [`repeating-linear-gradient(135deg, #404040 0 3px, #777 3px 6px)`, 'not reached'], [COLOUR.unmilled, 'turned'],
  ];
  for (const [colour, text] of entries) {
    const item = make('li'), swatch = make('i');
    swatch.style.background = colour;
    item.append(swatch, text);
    list.append(item);
  }
  $('low').value = um(show.scale[0]);
  $('high').value = um(show.scale[1]);
  $('scale-note').textContent = scaleNote();
}

function setScale(low, high, required) {
  const good = v => Number.isFinite(v) && v > 0;
  if (good(low) && good(high)) Object.assign(show, { scale: [low, high], required });
  describeScale();
  drawScale();
  redraw();
}

for (const id of ['low', 'high']) {
  $(id).addEventListener('change', () => setScale(parseFloat($('low').value), parseFloat($('high').value), [true, true]));
}
$('scale-reset').addEventListener('click', () => setScale(...data.scale.map(v => v * 1e3), [...data.required]));
for (const id of ['bands', 'shades']) {
  $(id).addEventListener('change', event => { show[id] = event.target.checked; drawScale(); redraw(); });
}

// Bodies: the finished part, the blank, the stock after each operation.
const bodies = [['part', 'finished part, by deviation'], ...(data.stock.length ? [['follow', 'stock at the time of the tool']] : []),
  ['blank', 'turned blank'], ...data.stock.map((s, i) => [String(i), `stock ${s.name}`]), ['none', 'nothing, paths only']];
for (const [value, text] of bodies) {
  const option = make('option', text);
  option.value = value;
  $('body').append(option);
}
function setBody(value) {
  show.body = /^\d+$/.test(value) ? Number(value) : value;
  $('body').value = value;
  describeStock();
  redraw();
}

/** Says how exact the stock is. */
function describeStock() {
  const shown = bodyNow(), s = data.stock[shown];
  const drawn = s ? Math.max(s.cell, s.mesh_cell) : 0;
  const which = show.body !== 'follow' ? '' : s ? `Stock ${s.name}. ` : 'Turned blank. ';
  $('stock-note').textContent = data.stock.length === 0 ? (show.body === 'part' ? '' : 'The stock after each operation was not simulated.')
    : s ? `${which}Simulated in cells of ${+data.cell.toPrecision(3)} mm${drawn > data.cell ? `, drawn in cells of ${+drawn.toFixed(2)} mm` : ''}. A smaller --stock-cell shows more.` : which;
}
$('body').addEventListener('change', event => { bodyChosen = true; setBody(event.target.value); });
/** True when the reader has chosen a body; then playing does not change it. */
let bodyChosen = false;

// Section plane.
function setSection(value) {
  show.section = value;
  $('section').value = value;
  $('cut').hidden = !value;
  const zs = data.blank.map(p => p[1]), r = outline();
  const [low, high] = value === 'z' ? [Math.min(...zs), Math.max(...zs)] : value === 'tool' ? [-0.5 * r, 0.5 * r] : [-r, r];
  $('offset').min = low;
  $('offset').max = high;
  $('offset').value = value === 'z' ? (low + high) / 2 : 0;
  setOffset();
}
function setOffset() {
  show.offset = Number($('offset').value);
  $('offset-value').textContent = `${show.offset.toFixed(2)} mm`;
  redraw();
}
$('section').addEventListener('change', event => setSection(event.target.value));
$('offset').addEventListener('input', setOffset);
$('other').addEventListener('change', event => { show.other = event.target.checked; redraw(); });

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
  const before = bodyNow();
  show.move = Math.min(Math.max(i, 0), moves.count - 1);
  show.share = Math.min(Math.max(share, 0), 1);
  const words = describeMove(show.move, show.share), time = timeOf(show.move, show.share);
  $('time').value = time;
  $('now').textContent = `${clock(time)} · ${words}`;
  $('now').title = words;
  $('move').textContent = `${words}\n${figuresOf(show.move, show.share)}`;
  showLine(lineOf(moves.operation[show.move], programIndex(show.move, show.share)));
  if (show.follow) { flight++; camera.target = poseOn(show.move, show.share).tip; }
  if (bodyNow() !== before) describeStock();
  redraw();
  showNow();
}
function setTime(t) {
  const i = moveAt(t), before = i ? moves.end[i - 1] : 0, size = moves.end[i] - before;
  // The end of a move is its end also where a digit of the time is missing.
  const share = size > 0 ? (t - before) / size : 1;
  setMove(i, share > 1 - 1e-6 ? 1 : share);
}

/** Puts the tool at the end of a move of the program. */
function setBlock(operation, index) {
  const i = pageMove(operation, index), to = moveIndex(i), from = follows(i) ? moveIndex(i - 1) : to - 1;
  setMove(i, to > from ? (index - from) / (to - from) : 1);
}

/** Puts the tool some blocks on, or back. */
function step(blocks) {
  if (!moves.count) return;
  play(false);
  showTool(true);
  const operations = data.paths.operations;
  let o = moves.operation[show.move], index = programIndex(show.move, show.share) + blocks;
  // A tool that is on its way in a block first comes to its end.
  if (blocks > 0 && !moves.indices.length && show.share < 1) index--;
  const last = k => operations[k].count ? moveIndex(operations[k].first + operations[k].count - 1) : -1;
  while (index > last(o) && o + 1 < operations.length) { index -= last(o) + 1; o++; }
  while (index < 0 && o > 0) { o--; index += last(o) + 1; }
  setBlock(o, Math.min(Math.max(index, 0), last(o)));
}
function showTool(on) {
  show.tool = on;
  $('tool').checked = on;
  redraw();
}
function setFollow(on) {
  show.follow = on;
  $('follow').checked = on;
  if (!on || !moves.count) return;
  showTool(true);
  const target = poseOn(show.move, show.share).tip;
  if (scene) fly({ ...camera, target, distance: Math.min(camera.distance, 1.6 * outline()) });
}
$('time').addEventListener('input', event => { showTool(true); setTime(Number(event.target.value)); });
$('tool').addEventListener('change', event => showTool(event.target.checked));
$('follow').addEventListener('change', event => setFollow(event.target.checked));
$('back').addEventListener('click', () => step(-1));
$('next').addEventListener('click', () => step(1));
let playing = false;
function play(on) {
  if (playing === on) return;
  playing = on && moves.count > 0;
  $('play').setAttribute('aria-pressed', String(playing));
  $('play').textContent = playing ? 'stop' : 'play';
  if (!playing) return;
  showTool(true);
  if (!bodyChosen && data.stock.length) setBody('follow');
  if (show.move === moves.count - 1 && show.share >= 1) setTime(0);
  let last = performance.now();
  const frame = now => {
    if (!playing) return;
    // The tool goes on when its last picture is drawn.
    if (frames.busy) { requestAnimationFrame(frame); return; }
    const t = timeOf(show.move, show.share) + (now - last) / 1e3 * Number($('pace').value);
    last = now;
    setTime(Math.min(t, moves.total));
    // In this frame, not in the next one.
    drawNow();
    if (t < moves.total) requestAnimationFrame(frame); else play(false);
  };
  requestAnimationFrame(frame);
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

/** Shows of each group the worst ones, as many as fit; all of them on request. */
function fitPlaces() {
  const list = $('places'), all = $('more').getAttribute('aria-expanded') === 'true';
  list.classList.toggle('all', all);
  const entries = [...list.querySelectorAll('button')];
  const keep = most => {
    let n = 0, whole = false;
    for (const element of list.children) {
      n = element.tagName === 'H3' ? 0 : n + 1;
      if (element.tagName === 'H3') whole = element.textContent === 'contracts';
      else element.classList.toggle('beyond', n > most && !whole);
    }
  };
  let most = 12;
  for (keep(most); !all && most > 1 && list.scrollHeight > list.clientHeight + 1; keep(most)) most--;
  const hidden = entries.filter(e => e.classList.contains('beyond')).length;
  // With a row of each group too many, the last groups lie below the edge.
  $('more').hidden = !hidden && !all && list.scrollHeight <= list.clientHeight + 1;
  $('more').textContent = all ? 'the worst only' : `all ${entries.length} places`;
}
$('more').addEventListener('click', () => {
  $('more').setAttribute('aria-expanded', String($('more').getAttribute('aria-expanded') !== 'true'));
  fitPlaces();
});
if (!data.places.length) $('places').append(make('p', 'There are none.', 'small'));

function showPlace(i) {
  const p = data.places[i];
  play(false);
  setFollow(false);
  setBody('part');
  show.mark = p.point;
  placeButtons.forEach((b, k) => b.setAttribute('aria-current', String(k === i)));
  $('readout').textContent = [`${p.name}: ${p.value}`, p.program, `at ${p.point.map(v => v.toFixed(3)).join(', ')} mm`].filter(Boolean).join('\n');
  held = true;
  if (p.at && moves.count) {
    setBlock(...p.at);
    pathBoxes.forEach((box, k) => { show.operations[k] = box.checked = k === p.at[0] && moves.count > 0; });
    const t = timeOf(show.move, show.share), size = Math.min(span.to - span.from, 60);
    setSpan(t - size / 2, t + size / 2);
  }
  if (scene) fly({ ...sight(p.point, p.normal), target: p.point, distance: 0.75 * outline() });
}
/** The figures of the tables lead to their places. */
function placeButtonsOfTables() {
  for (const button of document.querySelectorAll('[data-place]')) {
    button.addEventListener('click', () => {
      showPlace(Number(button.dataset.place));
      canvas.scrollIntoView({ block: 'nearest' });
    });
  }
}

$('theme').addEventListener('click', () => {
  const root = document.documentElement;
  const dark = root.dataset.theme ? root.dataset.theme === 'dark' : matchMedia('(prefers-color-scheme: dark)').matches;
  root.dataset.theme = dark ? 'light' : 'dark';
  drawScale();
  redrawPlots();
});

// Begin: first the part alone, then what follows in the file.
if (gl) {
  scene = build();
  canvas.addEventListener('webglcontextlost', event => { event.preventDefault(); scene = null; $('fault').hidden = false; });
} else {
  $('fault').hidden = false;
}
setBody('part');
resize();
document.documentElement.dataset.part = String(Math.round(performance.now()));
describeScale();
drawScale();
hints();
fitPlaces();

/** Reads what the first picture does not need. */
async function loadRest() {
  moves = await loadMoves();
  prepareRows();
  if (scene) { refine(); buildMoves(); await buildStock(); }
  await loadProgram();
  $('time').max = moves.total;
  setMove(0, 1);
  redraw();
  placeButtonsOfTables();
  redrawPlots();
  drawProgram();
  addEventListener('resize', () => { resize(); drawScale(); fitPlaces(); redrawPlots(); drawProgram(); });
  document.documentElement.dataset.drawn = 'yes';
}
const loaded = new Promise(done => {
  if (document.readyState !== 'loading') done(); else document.addEventListener('DOMContentLoaded', done);
});
// The part is shown before the rest is read. In a window that is not seen there are no frames.
const shown = new Promise(done => {
  requestAnimationFrame(() => requestAnimationFrame(() => setTimeout(done)));
  setTimeout(done, 1000);
});
Promise.all([loaded, shown]).then(loadRest);
