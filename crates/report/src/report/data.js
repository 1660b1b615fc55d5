// Data of the page: typed arrays, the mesh of the part, the poses of the tool.
const $ = id => document.getElementById(id);
const data = JSON.parse($('data').textContent);

/** Bytes of an element with base64 text; the text is dropped, since it is large. */
function bytes(id) {
  const element = $(id);
  if (!element) return new ArrayBuffer(0);
  const text = atob(element.textContent);
  element.remove();
  const out = new Uint8Array(text.length);
  for (let i = 0; i < text.length; i++) out[i] = text.charCodeAt(i);
  return out.buffer;
}

/** Bytes of an element with deflated data; nothing where there is none. */
async function inflated(id) {
  const packed = bytes(id);
  if (!packed.byteLength) return packed;
  return new Response(new Blob([packed]).stream().pipeThrough(new DecompressionStream('deflate'))).arrayBuffer();
}

const NOT_REACHED = 32767, NOT_MILLED = -32768;

/** Deviation in um of a code. */
const decode = code => data.part.law[0] * 1e3 * Math.sinh(code / data.part.law[1]);

/** Sector 0 of the part: quantised positions and normals, surface of each vertex, triangles; deviations of all sectors. */
function loadPart() {
  const positions = new Uint16Array(bytes('positions'));
  const normals = new Int16Array(bytes('normals'));
  const deviations = new Int16Array(bytes('deviations'));
  const count = positions.length / 3;
  const { low, size } = data.part.frame;
  const place = new Float32Array(positions.length);
  for (let i = 0; i < positions.length; i++) place[i] = low[i % 3] + positions[i] / 65535 * size[i % 3];
  const surface = new Uint8Array(count), rows = [], middle = [0, 0];
  for (let i = 0; i < place.length; i++) if (i % 3 < 2) middle[i % 3] += place[i] / count;
  let start = 0;
  data.part.surfaces.forEach((s, number) => {
    rows.push(s.rows.map(([n, from, to]) => {
      surface.fill(number, start, start + n);
      start += n;
      return { start: start - n, n, from, to };
    }));
  });
  return { positions, normals, deviations, surface, count, place, rows, middle };
}

/** Numbers below n in steps, with the last. */
function stepped(n, step) {
  const out = [];
  for (let i = 0; i < n - 1; i += step) out.push(i);
  if (n) out.push(n - 1);
  return out;
}

/** Triangles between the rows of the part, from every `step`th row and every `step`th point of a row. */
function triangles(step) {
  const { place, rows } = part, indices = [], gap2 = (data.part.gap * step) ** 2;
  const far = (a, b) => (place[3 * a] - place[3 * b]) ** 2 + (place[3 * a + 1] - place[3 * b + 1]) ** 2
    + (place[3 * a + 2] - place[3 * b + 2]) ** 2 > gap2;
  const triangle = (a, b, c) => { if (!far(a, b) && !far(b, c) && !far(c, a)) indices.push(a, b, c); };
  for (const surface of rows) {
    let before = null;
    for (const r of stepped(surface.length, step)) {
      const { start, n, from, to } = surface[r], list = stepped(n, step);
      const row = { points: list.map(i => start + i), at: list.map(i => n > 1 ? from + (to - from) * i / (n - 1) : from) };
      if (before) {
        // Advance on the row whose next point comes first.
        const [a, b] = [before.points, row.points];
        let i = 0, j = 0;
        while (i < a.length - 1 || j < b.length - 1) {
          if (j === b.length - 1 || (i < a.length - 1 && before.at[i + 1] <= row.at[j + 1])) { triangle(a[i], a[i + 1], b[j]); i++; }
          else { triangle(a[i], b[j + 1], b[j]); j++; }
        }
      }
      before = row;
    }
  }
  return Uint32Array.from(indices);
}

const machine = data.machine;

/** A vector turned about a unit vector by an angle. */
function turnedAbout(k, v, angle) {
  const c = Math.cos(angle), s = Math.sin(angle), along = k[0] * v[0] + k[1] * v[1] + k[2] * v[2];
  const cross = [k[1] * v[2] - k[2] * v[1], k[2] * v[0] - k[0] * v[2], k[0] * v[1] - k[1] * v[0]];
  return [0, 1, 2].map(i => k[i] * along * (1 - c) + v[i] * c + cross[i] * s);
}

/** A vector along the axes of the machine at zero, along those of the part. */
const toPart = v =>
  machine.part_axes ? machine.part_axes.map(axis => axis[0] * v[0] + axis[1] * v[1] + axis[2] * v[2]) : v;

/** Tool tip in the part frame at joints X Y Z (mm) and rotary axes (rad), next to the tool first. */
function tipAt(x, y, z, ...angles) {
  const tip = machine.rotary.reduce((p, [direction, point, table], k) => {
    // A table turns the part against its word: seen from the part the tip turns with it.
    return table ? turnedAbout(direction, p.map((q, i) => q - point[i]), angles[k]).map((q, i) => q + point[i]) : p;
  }, [x, y, z]);
  return toPart(tip.map((q, i) => q - machine.part_origin[i]));
}

/** Axis of the tool from its tip to the holder. */
const axisAt = (...angles) =>
  toPart(machine.rotary.reduce((v, [direction], k) => turnedAbout(direction, v, angles[k]), [0, 0, 1]));

/** With a head, X Y Z of an operation become those of the gauge line with the head upright: what the axes do. */
function placeGauge(joints, o) {
  const { length } = data.tools.find(t => t.name === o.tool);
  for (let i = o.first; i < o.first + o.count; i++) {
    const hanging = machine.rotary.reduce((p, [direction, point, table], k) => {
      return table ? p : turnedAbout(direction, p.map((q, j) => q - point[j]), joints[3 + k][i]).map((q, j) => q + point[j]);
    }, [0, 0, -length]);
    for (let k = 0; k < 3; k++) joints[k][i] -= hanging[k];
  }
}

/** All moves: joints, tips, times, operation of each. */
async function loadMoves() {
  const raw = new Float32Array(await inflated('joints'));
  const kinds = new Uint8Array(await inflated('kinds'));
  const indices = new Uint32Array(await inflated('indices'));
  const removal = new Float32Array(await inflated('removal'));
  const arcs = new Float32Array(await inflated('arcs'));
  const limiting = new Uint8Array(await inflated('limiting'));
  const count = kinds.length;
  const joints = [0, 1, 2, 3, 4].map(() => new Float32Array(count));
  const tips = new Float32Array(3 * count);
  const end = new Float64Array(count);
  const operation = new Uint16Array(count);
  let time = 0;
  for (let i = 0; i < count; i++) {
    for (let k = 0; k < 5; k++) joints[k][i] = raw[6 * i + k];
    const tip = tipAt(raw[6 * i], raw[6 * i + 1], raw[6 * i + 2], raw[6 * i + 3], raw[6 * i + 4]);
    for (let k = 0; k < 3; k++) tips[3 * i + k] = tip[k];
    time += raw[6 * i + 5];
    end[i] = time;
  }
  data.paths.operations.forEach((o, k) => operation.fill(k, o.first, o.first + o.count));
  if (machine.rotary.some(([, , table]) => !table)) data.paths.operations.forEach(o => placeGauge(joints, o));
  return { count, kinds, indices, removal, arcs, limiting, joints, tips, end, operation, total: time };
}

const NO_MOVES = {
  count: 0, kinds: [], indices: [], removal: [], arcs: [], limiting: [], joints: [[], [], [], [], []], tips: [], end: [],
  operation: [], total: 0,
};
/** The moves; none until the page has read them, which is after the first picture of the part. */
let moves = NO_MOVES;

/** Index of a move within its operation in the program. */
const moveIndex = i => moves.indices.length ? moves.indices[i] : i - data.paths.operations[moves.operation[i]].first;

/** Move of the page that reaches or passes a move of an operation. */
function pageMove(operation, index) {
  const o = data.paths.operations[operation];
  if (!o || !o.count) return 0;
  let low = o.first, high = o.first + o.count - 1;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (moveIndex(middle) < index) low = middle + 1; else high = middle;
  }
  return low;
}

/** Last entry of pairs whose first number is not beyond a value. */
function entry(pairs, value) {
  let low = 0, high = pairs.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (pairs[middle][0] <= value) low = middle + 1; else high = middle;
  }
  return pairs[low - 1];
}

/** Index in its operation of the move of the program at a share of a move of the page, which may stand for several. */
function programIndex(i, share) {
  const to = moveIndex(i);
  if (!moves.indices.length) return to;
  const from = follows(i) ? moveIndex(i - 1) : -1;
  return from + Math.max(1, Math.ceil((to - from) * share - 1e-6));
}

/** Line of the NC text of a move of the program, from 1; zero where there is none. */
function lineOf(operation, index) {
  const run = entry(data.paths.operations[operation].lines, index);
  return run ? run[1] + index - run[0] : 0;
}

/** True when a move has one before it in its operation: the way to the first is the tool change. */
const follows = i => i > 0 && moves.operation[i] === moves.operation[i - 1];

/** Operation, pass, move and NC line of a move in words. */
function describeMove(i, share) {
  const o = data.paths.operations[moves.operation[i]];
  if (!o) return '';
  const pass = entry(o.passes, i), index = programIndex(i, share), line = lineOf(moves.operation[i], index);
  const kind = ['cut', 'link', 'rapid'][moves.kinds[i]];
  return [o.name, pass && o.labels[pass[1]], `${kind}, move ${index}`, line && `NC line ${line}`]
    .filter(Boolean).join(' · ');
}

/** First move that ends after a time. */
function moveAt(time) {
  let low = 0, high = Math.max(moves.count - 1, 0);
  while (low < high) {
    const middle = (low + high) >> 1;
    if (moves.end[middle] < time) low = middle + 1; else high = middle;
  }
  return low;
}

/** Joints at a share of a move; its end when it is the first of its operation. */
function jointsOn(i, share) {
  const first = !follows(i);
  return moves.joints.map(j => first ? j[i] : j[i - 1] + (j[i] - j[i - 1]) * share);
}

/** Tip and axis at a share of a move: the tip straight, the rotary axes even. */
function poseOn(i, share) {
  const q = jointsOn(i, share);
  const first = !follows(i);
  const tip = [0, 1, 2].map(k => {
    const to = moves.tips[3 * i + k];
    return first ? to : moves.tips[3 * i - 3 + k] + (to - moves.tips[3 * i - 3 + k]) * share;
  });
  return { tip, axis: axisAt(q[3], q[4]) };
}

const clock = s => {
  s = Math.max(0, s);
  const two = n => String(Math.floor(n)).padStart(2, '0');
  return `${Math.floor(s / 3600)}:${two(s / 60 % 60)}:${two(s % 60)}`;
};

// Neither orange nor blue, which the scale has for gouge and excess.
const COLOURS = ['#0ca678', '#9c36b5', '#d6336c', '#66860f', '#5f3dc4', '#0b7285', '#a9793b', '#e64980', '#087f5b', '#862e9c'];
const colourOf = k => COLOURS[k % COLOURS.length];
const rgb = hex => [1, 3, 5].map(k => parseInt(hex.slice(k, k + 2), 16) / 255);
