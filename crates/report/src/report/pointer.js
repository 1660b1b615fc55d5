// Mouse, touch and keys.
const VIEWS = {
  all: HOME, top: { ...HOME, azimuth: -Math.PI / 2, elevation: Math.PI / 2 - 1e-4 },
  front: { ...HOME, target: middle(0.5), azimuth: -Math.PI / 2, elevation: 0 },
  side: { ...HOME, target: middle(0.5), azimuth: 0, elevation: 0 },
};
function forget() {
  show.mark = null;
  show.measured = [];
  held = false;
  $('readout').textContent = '';
  placeButtons.forEach(b => b.removeAttribute('aria-current'));
}
for (const button of document.querySelectorAll('[data-view]')) {
  button.addEventListener('click', () => { forget(); setFollow(false); fly(VIEWS[button.dataset.view]); });
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
/** Pointers that are down, by their number: where they are, where they began, whether they moved. */
const pointers = new Map();
canvas.addEventListener('contextmenu', event => event.preventDefault());
canvas.addEventListener('pointerdown', event => {
  canvas.setPointerCapture(event.pointerId);
  const at = place(event);
  pointers.set(event.pointerId, { at, moved: false, shifts: event.button !== 0 || event.shiftKey });
  if (pointers.size > 1) for (const p of pointers.values()) p.moved = true;
});

/** Two fingers: their distance zooms, their middle shifts. */
function pinch(pointer, at) {
  const other = [...pointers.values()].find(p => p !== pointer);
  const size = p => Math.max(Math.hypot(p[0] - other.at[0], p[1] - other.at[1]), 1);
  zoom(size(pointer.at) / size(at));
  shift((at[0] - pointer.at[0]) / 2, (at[1] - pointer.at[1]) / 2);
}
canvas.addEventListener('pointermove', event => {
  const at = place(event), pointer = pointers.get(event.pointerId);
  if (!pointer) { if (!pointers.size) look(at); return; }
  const [dx, dy] = [at[0] - pointer.at[0], at[1] - pointer.at[1]];
  if (!pointer.moved && Math.hypot(dx, dy) < 4) return;
  pointer.moved = true;
  if (pointers.size === 2) pinch(pointer, at);
  else if (pointers.size === 1 && pointer.shifts) shift(dx, dy);
  else if (pointers.size === 1) turn(dx * 0.008, dy * 0.008);
  pointer.at = at;
});
for (const name of ['pointerup', 'pointercancel']) {
  canvas.addEventListener(name, event => {
    const pointer = pointers.get(event.pointerId);
    pointers.delete(event.pointerId);
    if (name === 'pointerup' && pointer && !pointer.moved && measuring) measureAt(place(event));
  });
}
canvas.addEventListener('pointerleave', () => { if (!held) $('readout').textContent = ''; });

/** The wheel belongs to the page, unless the canvas has the focus or Ctrl is held. */
const wheelIsFor = (element, event) => event.ctrlKey || event.metaKey || document.activeElement === element;
canvas.addEventListener('wheel', event => {
  if (!wheelIsFor(canvas, event)) return;
  event.preventDefault();
  zoom(Math.exp(event.deltaY * 0.0012));
}, { passive: false });
function hints() {
  const active = document.activeElement;
  $('hint').textContent = measuring ? `click ${show.measured.length === 1 ? 'the second point' : 'two points'} · Esc ends`
    : matchMedia('(pointer: coarse)').matches ? 'one finger turns, two fingers zoom and shift'
      : active === canvas ? 'wheel zooms, drag turns, right drag shifts, double click sets the centre · Esc gives the wheel back to the page'
        : 'wheel scrolls the page: click first, or hold Ctrl, to zoom';
  $('plots-hint').textContent = `${active === plots ? 'wheel zooms' : 'click first, or hold Ctrl, to zoom by the wheel'}; + and - zoom, drag shifts, a click puts the tool there, arrow keys step by one block, Home shows all`;
  $('nc-hint').textContent = !program.count ? '' : active === $('nc') ? 'click a block: the tool goes there; arrow keys step by block' : 'click to scroll by the wheel; keys , and . step by block';
}
for (const name of ['focusin', 'focusout']) document.addEventListener(name, () => setTimeout(hints));

// Measuring.
let measuring = false;
function setMeasuring(on) {
  measuring = on;
  $('measure').setAttribute('aria-pressed', String(on));
  canvas.style.cursor = on ? 'crosshair' : '';
  if (on) { forget(); redraw(); }
  hints();
}
$('measure').addEventListener('click', () => setMeasuring(!measuring));
function measureAt(at) {
  const point = pointAt(...at);
  if (!point) return;
  show.measured = show.measured.length === 1 ? [show.measured[0], point] : [point];
  held = true;
  const figures = p => p.map(v => v.toFixed(3)).join(', ');
  if (show.measured.length === 2) {
    const d = [0, 1, 2].map(k => point[k] - show.measured[0][k]);
    $('readout').textContent = `distance ${Math.hypot(...d).toFixed(3)} mm\nalong x, y, z: ${figures(d)} mm`;
  } else {
    $('readout').textContent = `first point at ${figures(point)} mm`;
  }
  hints();
  redraw();
}
canvas.addEventListener('dblclick', event => {
  if (measuring) return;
  const target = pointAt(...place(event));
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
    const found = surfaceAt(...looking);
    looking = null;
    if (held) return;
    if (!found) { $('readout').textContent = ''; return; }
    const surface = data.part.surfaces[found.surface];
    const name = `${surface ? surface.name : 'surface'}, sector ${found.sector + 1}`;
    const value = found.without === NOT_REACHED ? 'not reached' : found.without === NOT_MILLED ? 'turned, not milled'
      : `${found.deviation < 0 ? 'cut' : 'left'} ${Math.abs(found.deviation).toFixed(2)} µm`;
    $('readout').textContent = `${name}: ${value}`;
  });
}

// Mouse and keys of the plots.
let plotDrag = null;
plots.addEventListener('wheel', event => {
  if (!wheelIsFor(plots, event)) return;
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
  if (event.key === 'ArrowRight') step(1);
  else if (event.key === 'ArrowLeft') step(-1);
  else if (event.key === '+' || event.key === '=') zoomSpan(0.7, 0.5);
  else if (event.key === '-') zoomSpan(1 / 0.7, 0.5);
  else if (event.key === 'Home') setSpan(0, moves.total);
  else return;
  event.preventDefault();
});

/** Keys of the whole page, where nothing is being entered. */
const KEYS = {
  ',': () => step(-1), '.': () => step(1), p: () => play(!playing), t: () => showTool(!show.tool),
  f: () => setFollow(!show.follow), m: () => setMeasuring(!measuring),
};
document.addEventListener('keydown', event => {
  if (event.ctrlKey || event.metaKey || event.altKey) return;
  if (event.key === 'Escape') {
    if (measuring || show.measured.length) { setMeasuring(false); forget(); redraw(); }
    else document.activeElement.blur();
    return;
  }
  const entering = event.target.matches('select, input:not([type=checkbox]):not([type=range])');
  if (entering || !KEYS[event.key]) return;
  event.preventDefault();
  KEYS[event.key]();
});
