// Drawing of part, stock, paths and tool by WebGL2.
// Neutral inside of the tolerance; outside orange for a cut too deep and blue for material left, which also readers who do
// not see red or green tell apart. The shades are for the inside where no contract gives a tolerance, or on request.
const COLOUR = {
  neutral: '#dcdad4', unreached: '#5b5b5b', unmilled: '#8e959f',
  gouge: ['#f5a54a', '#dd6410', '#7f2a04'], excess: ['#7fb4e2', '#2a6fbb', '#08285c'], shades: ['#f6dcb9', '#c4dbf0'],
};
/** Multiple of the tolerance at which the colour is full. */
const BEYOND = 4;

const canvas = $('scene');
const gl = canvas.getContext('webgl2', { antialias: false, alpha: true, preserveDrawingBuffer: true });
const RADIUS = Math.max(...data.blank.map(([r, z]) => Math.hypot(r, z)), 1) || 1;
// Lower than half way: from above and near, the front of the part looks larger than its back.
const HOME = { target: middle(0.15), azimuth: -1.15, elevation: 0.80, distance: 3.9 * outline() };
const camera = { ...HOME, target: [...HOME.target] };
const show = {
  body: 'part', bands: false, shades: false, scale: data.scale.map(v => v * 1e3), required: [...data.required],
  tool: false, follow: false, move: 0, share: 1, mark: null, section: '', offset: 0, other: false, measured: [],
  operations: data.paths.operations.map(() => false), kinds: [true, false, false],
};

/** 1 for the sides of the scale that have shades inside of the tolerance. */
const shaded = () => show.required.map(r => show.shades || !r ? 1 : 0);

/** The section plane: what lies beyond `offset` along its normal is left out. */
function sectionPlane() {
  const side = show.other ? -1 : 1;
  if (show.section === 'tool') {
    const { tip, axis } = moves.count ? poseOn(show.move, show.share) : { tip: [0, 0, 0], axis: [0, 0, 1] };
    const normal = unit(Math.abs(axis[2]) < 0.999 ? cross(axis, [0, 0, 1]) : [1, 0, 0]).map(v => side * v);
    return [...normal, dot(normal, tip) + side * show.offset];
  }
  const k = 'xyz'.indexOf(show.section);
  if (!show.section || k < 0) return [0, 0, 0, 1];
  return [...[0, 1, 2].map(i => i === k ? side : 0), side * show.offset];
}

/** Mesh of the stock at the time of the tool: that after the last operation that has ended. */
function bodyNow() {
  if (show.body !== 'follow') return show.body;
  const running = moves.count ? moves.operation[show.move] : 0, o = data.paths.operations[running];
  const ended = o && show.share >= 1 && show.move === o.first + o.count - 1 ? running : running - 1;
  let best = -1;
  data.stock.forEach((s, i) => { if ((s.after === null ? -1 : s.after) <= ended) best = i; });
  return best < 0 ? 'blank' : best;
}

/** The place on the axis at a share of the height of the blank. */
function middle(share) {
  const zs = data.blank.map(p => p[1]);
  return [0, 0, (1 - share) * Math.min(...zs) + share * Math.max(...zs)];
}
function outline() { return Math.max(...data.blank.map(p => p[0]), 1); }

const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const unit = a => { const l = Math.hypot(...a) || 1; return a.map(x => x / l); };

/** Direction from the target to the eye, right and up. */
function frameOf({ azimuth, elevation }) {
  const back = [Math.cos(elevation) * Math.cos(azimuth), Math.cos(elevation) * Math.sin(azimuth), Math.sin(elevation)];
  const right = [-Math.sin(azimuth), Math.cos(azimuth), 0];
  return { back, right, up: cross(back, right) };
}

const FIELD = Math.tan(15 * Math.PI / 180);

/** Camera to clip space, column by column. */
function projection() {
  const { back, right, up } = frameOf(camera);
  const eye = camera.target.map((t, k) => t + back[k] * camera.distance);
  const aspect = frames.size[0] / frames.size[1];
  const near = Math.max(camera.distance - 5 * RADIUS, camera.distance * 0.02), farEnd = camera.distance + 6 * RADIUS;
  const wide = aspect < 1 ? FIELD / aspect : FIELD;
  const sx = 1 / (wide * aspect), sy = 1 / wide;
  const depth = -(farEnd + near) / (farEnd - near), shift = -2 * farEnd * near / (farEnd - near);
  const m = new Float32Array(16);
  const e = [right, up, back].map(v => -dot(v, eye));
  for (let k = 0; k < 3; k++) {
    m[4 * k] = sx * right[k];
    m[4 * k + 1] = sy * up[k];
    m[4 * k + 2] = depth * back[k];
    m[4 * k + 3] = -back[k];
  }
  m[12] = sx * e[0];
  m[13] = sy * e[1];
  m[14] = depth * e[2] + shift;
  m[15] = -e[2];
  return { m, eye, near, farEnd, plane: sectionPlane() };
}

const PROGRAMS = {
  part: [PART_VERTEX, PART_COLOUR], plain: [PLAIN_VERTEX, PLAIN_COLOUR],
  line: [LINE_VERTEX, LINE_COLOUR], mark: [MARK_VERTEX, MARK_COLOUR],
};
/** Programs of the picture that are used, by name; those with a section have a longer one. The graphics card compiles them while the page reads the part. */
const started = {};
function start(name, opened) {
  const program = gl.createProgram(), shaders = [];
  PROGRAMS[name].forEach((text, k) => {
    const shader = gl.createShader(k ? gl.FRAGMENT_SHADER : gl.VERTEX_SHADER);
    gl.shaderSource(shader, opened ? text.replace('\n', '\n#define OPENED\n') : text);
    gl.compileShader(shader);
    gl.attachShader(program, shader);
    shaders.push(shader);
  });
  gl.linkProgram(program);
  return { program, shaders };
}

/** A program with its uniforms by name. */
function finish({ program, shaders }) {
  if (!gl.getProgramParameter(program, gl.LINK_STATUS)) {
    throw new Error([...shaders.map(s => gl.getShaderInfoLog(s)), gl.getProgramInfoLog(program)].join('\n'));
  }
  const uniforms = {};
  const n = gl.getProgramParameter(program, gl.ACTIVE_UNIFORMS);
  for (let i = 0; i < n; i++) {
    const { name } = gl.getActiveUniform(program, i);
    uniforms[name.replace('[0]', '')] = gl.getUniformLocation(program, name);
  }
  return { program, uniforms };
}

/** A program, ready for use, with a section or without one. */
function programOf(name, opened) {
  const key = opened ? `${name} opened` : name;
  return scene.programs[key] ??= finish(started[key] ??= start(name, opened));
}
if (gl) for (const name of ['part', 'plain']) started[name] = start(name, false);
const part = loadPart();

function buffer(array, target) {
  const b = gl.createBuffer();
  gl.bindBuffer(target, b);
  gl.bufferData(target, array, gl.STATIC_DRAW);
  return b;
}

/** A vertex array of attributes [buffer, location, size, type, normalised, stride, offset]. */
function vertexArray(attributes, indices) {
  const array = gl.createVertexArray();
  gl.bindVertexArray(array);
  for (const [b, location, size, type, normalised, offset] of attributes) {
    gl.bindBuffer(gl.ARRAY_BUFFER, b);
    gl.enableVertexAttribArray(location);
    gl.vertexAttribPointer(location, size, type, normalised, 0, offset || 0);
  }
  if (indices) gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, indices);
  gl.bindVertexArray(null);
  return array;
}

const IDENTITY = new Float32Array([1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]);

/** Triangles of a half section turned about Z, `around` to the turn. */
function lathe(lines, around) {
  const out = [];
  for (const line of lines) {
    for (let i = 0; i + 1 < line.length; i++) {
      const [[r0, z0], [r1, z1]] = [line[i], line[i + 1]];
      for (let k = 0; k < around; k++) {
        const [a, b] = [k, k + 1].map(x => 2 * Math.PI * x / around);
        const at = (r, z, t) => [r * Math.cos(t), r * Math.sin(t), z];
        if (r0 > 0 || z0 !== z1) out.push(...at(r0, z0, a), ...at(r0, z0, b), ...at(r1, z1, b));
        if (r1 > 0 || z0 !== z1) out.push(...at(r0, z0, a), ...at(r1, z1, b), ...at(r1, z1, a));
      }
    }
  }
  return new Float32Array(out);
}

/** A line (r, z) around material in the order in which the front of the triangles of `lathe` is outside. */
function outward(line) {
  const area = line.reduce((sum, [r, z], i) => {
    const [next, height] = line[(i + 1) % line.length];
    return sum + r * height - next * z;
  }, 0);
  return area < 0 ? [...line].reverse() : line;
}

let scene = null;

function plainMesh(floats) {
  return { array: vertexArray([[buffer(floats, gl.ARRAY_BUFFER), 0, 3, gl.FLOAT, false]]), count: floats.length / 3, place: floats };
}

/** Every which row and point the first picture of the part has, and a coarse one. */
const FIRST_STEP = 4;

/** Makes what the first picture needs on the graphics card. */
function build() {
  const place = buffer(part.positions, gl.ARRAY_BUFFER), normal = buffer(part.normals, gl.ARRAY_BUFFER);
  const code = buffer(part.deviations, gl.ARRAY_BUFFER), surface = buffer(part.surface, gl.ARRAY_BUFFER);
  const first = triangles(FIRST_STEP), coarse = { indices: buffer(first, gl.ELEMENT_ARRAY_BUFFER), count: first.length };
  const sectors = [];
  for (let s = 0; s < data.part.sectors; s++) {
    const angle = 2 * Math.PI * s / data.part.sectors;
    sectors.push({
      turn: [Math.cos(angle), Math.sin(angle)],
      array: vertexArray([
        [place, 0, 3, gl.UNSIGNED_SHORT, true], [normal, 1, 2, gl.SHORT, true],
        [code, 2, 1, gl.SHORT, false, 2 * s * part.count], [surface, 3, 1, gl.UNSIGNED_BYTE, false],
      ]),
    });
  }
  return {
    programs: {}, sectors, coarse, whole: coarse, lines: [], tools: [], stock: [], ruler: gl.createBuffer(), blank: null,
    turned: plainMesh(lathe(data.part.turned.map(outward), 180)),
  };
}

/** Adds all triangles of the part. */
function refine() {
  part.indices = triangles(1);
  gl.bindVertexArray(null);
  scene.whole = { indices: buffer(part.indices, gl.ELEMENT_ARRAY_BUFFER), count: part.indices.length };
}

/** Ends of the moves of a kind in an operation, two by two: of all, or of every `step`th move of each run of moves. */
function pairsOf(o, kind, step) {
  const list = [], end = o.first + o.count;
  for (let from = o.first, i = from + 1; i < end; i++) {
    if (moves.kinds[i] !== kind) { from = i; continue; }
    const last = i + 1 === end || moves.kinds[i + 1] !== kind;
    if (i - from >= step || last) { list.push(from, i); from = i; }
  }
  return Uint32Array.from(list);
}

/** Every which move the paths have in a coarse picture. */
const PATH_STEP = 4;

/** Adds paths and tools, when the moves are read. */
function buildMoves() {
  const way = new Float32Array(moves.count);
  for (let i = 1; i < moves.count; i++) {
    const d = [0, 1, 2].map(k => moves.tips[3 * i + k] - moves.tips[3 * i - 3 + k]);
    // A whole number of dashes of 12 mm, so that the length stays small.
    way[i] = (moves.kinds[i] === moves.kinds[i - 1] ? way[i - 1] : 0) + Math.hypot(...d);
  }
  const tips = buffer(moves.tips, gl.ARRAY_BUFFER), ways = buffer(way, gl.ARRAY_BUFFER);
  const line = pairs => {
    const b = buffer(pairs, gl.ELEMENT_ARRAY_BUFFER);
    return { array: vertexArray([[tips, 0, 3, gl.FLOAT, false], [ways, 1, 1, gl.FLOAT, false]], b), pairs };
  };
  scene.lines = data.paths.operations.map(o => [0, 1, 2].map(kind => {
    return { whole: line(pairsOf(o, kind, 1)), coarse: line(pairsOf(o, kind, PATH_STEP)) };
  }));
  scene.tools = data.tools.map(t => ({
    name: t.name, cutter: plainMesh(lathe([t.cutter], 48)), shank: plainMesh(lathe([t.shank], 48)),
    holder: plainMesh(lathe([t.holder], 64)),
  }));
}

/** Adds the meshes of the stock. */
async function buildStock() {
  for (let i = 0; i < data.stock.length; i++) {
    const positions = new Uint16Array(await inflated(`stock-positions-${i}`));
    const indices = new Uint16Array(await inflated(`stock-indices-${i}`));
    if (!scene) return;
    const array = vertexArray([[buffer(positions, gl.ARRAY_BUFFER), 0, 3, gl.UNSIGNED_SHORT, true]],
      buffer(indices, gl.ELEMENT_ARRAY_BUFFER));
    scene.stock[i] = { array, count: 3 * data.stock[i].triangles, frame: data.stock[i].frame, positions, indices };
  }
}

/** Sets what all programs that shade share; returns the uniforms. `whole` leaves out the section. */
function use(name, view, whole) {
  const { program, uniforms } = programOf(name, !!show.section && !whole);
  gl.useProgram(program);
  const { up, right } = frameOf(camera);
  if (uniforms.camera) gl.uniformMatrix4fv(uniforms.camera, false, view.m);
  if (uniforms.eye) gl.uniform3fv(uniforms.eye, view.eye);
  if (uniforms.upward) gl.uniform3fv(uniforms.upward, up);
  if (uniforms.rightward) gl.uniform3fv(uniforms.rightward, right);
  if (uniforms.plane) gl.uniform4fv(uniforms.plane, view.plane);
  if (uniforms.grain) gl.uniform1f(uniforms.grain, view.grain);
  return uniforms;
}

/** Draws the part, a sector a piece. Near sectors come first: what they hide is not shaded. */
function* drawPart(view) {
  const u = use('part', view), { indices, count } = view.coarse ? scene.coarse : scene.whole;
  gl.uniform3fv(u.low, data.part.frame.low);
  gl.uniform3fv(u.size, data.part.frame.size);
  gl.uniform2f(u.law, data.part.law[0] * 1e3, data.part.law[1]);
  gl.uniform2fv(u.scale, show.scale);
  gl.uniform2fv(u.shaded, shaded());
  gl.uniform3fv(u.outside, [...COLOUR.gouge, ...COLOUR.excess].flatMap(rgb));
  gl.uniform3fv(u.shades, COLOUR.shades.flatMap(rgb));
  gl.uniform3fv(u.special, [COLOUR.neutral, COLOUR.unreached, COLOUR.unmilled].flatMap(rgb));
  gl.uniform1f(u.bands, show.bands ? 1 : 0);
  gl.uniform1f(u.beyond, BEYOND);
  const [x, y] = part.middle;
  const near = ({ turn: [c, s] }) => (c * x - s * y) * view.eye[0] + (s * x + c * y) * view.eye[1];
  for (const sector of [...scene.sectors].sort((a, b) => near(b) - near(a))) {
    gl.uniform2fv(u.turn, sector.turn);
    gl.bindVertexArray(sector.array);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, indices);
    gl.drawElements(gl.TRIANGLES, count, gl.UNSIGNED_INT, 0);
    yield;
  }
}

function drawPlain(u, mesh, tint, model, frame, indexed) {
  gl.uniform4fv(u.tint, tint);
  gl.uniformMatrix4fv(u.model, false, model || IDENTITY);
  gl.uniform3fv(u.low, frame ? frame.low : [0, 0, 0]);
  gl.uniform3fv(u.size, frame ? frame.size : [1, 1, 1]);
  gl.bindVertexArray(mesh.array);
  if (indexed) gl.drawElements(gl.TRIANGLES, mesh.count, gl.UNSIGNED_SHORT, 0);
  else gl.drawArrays(gl.TRIANGLES, 0, mesh.count);
}

/** Model matrix of a tool at a tip along an axis. */
function toolModel({ tip, axis }) {
  const side = unit(cross(Math.abs(axis[2]) < 0.9 ? [0, 0, 1] : [1, 0, 0], axis)), other = cross(axis, side);
  return new Float32Array([...side, 0, ...other, 0, ...axis, 0, ...tip, 1]);
}

/** Colours of part, blank and stock in the picture of the bodies. */
const MATERIAL = [0.80, 0.66, 0.50, 1];

/** Draws the body that is chosen. */
function* drawBody(view) {
  gl.enable(gl.DEPTH_TEST);
  gl.disable(gl.BLEND);
  const body = bodyNow();
  if (body === 'part') yield* drawPart(view);
  const mesh = meshOf(body === 'part' ? 'turned' : body);
  if (mesh) drawPlain(use('plain', view), mesh, body === 'part' ? [...rgb(COLOUR.unmilled), 1] : MATERIAL, null, mesh.frame, mesh.indices);
}

/** Mesh of the turned surfaces, of the blank or of a stock. */
function meshOf(body) {
  if (body === 'turned') return scene.turned;
  if (body === 'blank') return scene.blank ??= plainMesh(lathe([outward([...data.blank, data.blank[0]])], 180));
  return scene.stock[body];
}

/** Draws the paths that are chosen; of the operation that the stock follows only what is cut so far. */
function drawPaths(view) {
  if (!scene.lines.length) return;
  const u = use('line', view);
  gl.uniform1f(u.lift, 0.0004 * 3 * outline() / camera.distance);
  scene.lines.forEach((kinds, k) => {
    const running = show.body === 'follow' && show.tool && moves.operation[show.move] === k;
    if (!show.operations[k] && !running) return;
    kinds.forEach(({ whole, coarse }, kind) => {
      const line = view.coarse ? coarse : whole;
      const count = running ? 2 * before(line.pairs, show.move) : line.pairs.length;
      if (!show.kinds[kind] || !count) return;
      gl.uniform4fv(u.tint, [...rgb(colourOf(k)), kind === 1 ? 0.5 : 1]);
      gl.uniform1f(u.dash, kind === 2 ? 4 : 0);
      gl.bindVertexArray(line.array);
      gl.drawElements(gl.LINES, count, gl.UNSIGNED_INT, 0);
    });
  });
}

/** Number of pairs that end before a move. */
function before(pairs, move) {
  let low = 0, high = pairs.length / 2;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (pairs[2 * middle + 1] < move) low = middle + 1; else high = middle;
  }
  return low;
}

/** Draws the mark of a place, and the points of a measurement with the line between them. */
function drawMarks(view) {
  gl.disable(gl.DEPTH_TEST);
  if (show.measured.length === 2) {
    const u = use('line', view, true);
    gl.uniform1f(u.lift, 0);
    gl.uniform1f(u.dash, 0);
    gl.uniform4fv(u.tint, [0, 0, 0, 1]);
    gl.bindVertexArray(null);
    gl.bindBuffer(gl.ARRAY_BUFFER, scene.ruler);
    gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(show.measured.flat()), gl.DYNAMIC_DRAW);
    gl.enableVertexAttribArray(0);
    gl.vertexAttribPointer(0, 3, gl.FLOAT, false, 0, 0);
    gl.disableVertexAttribArray(1);
    gl.drawArrays(gl.LINES, 0, 2);
    gl.disableVertexAttribArray(0);
  }
  const marks = [...(show.mark ? [[show.mark, 34, [0.85, 0.05, 0.35, 1]]] : []), ...show.measured.map(p => [p, 20, [0, 0, 0, 1]])];
  for (const [place, size, tint] of marks) {
    const u = use('mark', view, true);
    gl.uniform3fv(u.place, place);
    gl.uniform1f(u.points, size * ratio() / view.grain);
    gl.uniform4fv(u.tint, tint);
    gl.bindVertexArray(null);
    gl.drawArrays(gl.POINTS, 0, 1);
  }
}

/** Begins a picture. */
function begin() {
  gl.clearColor(0, 0, 0, 0);
  gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
}

/** Draws what is over the body: paths, tool, marks. */
function drawMoving(view) {
  gl.enable(gl.DEPTH_TEST);
  gl.enable(gl.BLEND);
  gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
  drawPaths(view);
  if (show.tool && moves.count) drawTool(view);
  drawMarks(view);
}

/** Draws everything that is to be shown, piece by piece. */
function* pieces(view) {
  begin();
  yield* drawBody(view);
  yield;
  drawMoving(view);
}

function drawTool(view) {
  const o = data.paths.operations[moves.operation[show.move]];
  const tool = scene.tools.find(t => t.name === o.tool);
  if (!tool) return;
  // The section leaves the tool whole.
  const u = use('plain', view, true);
  const model = toolModel(poseOn(show.move, show.share));
  // Through a tool near a marked place the place stays in sight.
  const alpha = show.mark ? 0.42 : 0.9;
  for (const [mesh, tint] of [[tool.cutter, [0.93, 0.75, 0.25]], [tool.shank, [0.62, 0.66, 0.72]], [tool.holder, [0.30, 0.36, 0.46]]]) {
    // Depth first, so that only the front of a translucent tool is seen.
    gl.colorMask(false, false, false, false);
    drawPlain(u, mesh, [...tint, alpha], model);
    gl.colorMask(true, true, true, true);
    gl.depthFunc(gl.LEQUAL);
    drawPlain(u, mesh, [...tint, alpha], model);
    gl.depthFunc(gl.LESS);
  }
}

/** True when something of the part stands between a point and an eye in a direction from it. */
function hidden(point, direction) {
  const STEP = 5, NEAR = 2.5, WIDE2 = (2 * data.part.gap) ** 2 * 0.25;
  for (const { turn } of scene.sectors) {
    const into = p => [p[0] * turn[0] + p[1] * turn[1], p[1] * turn[0] - p[0] * turn[1], p[2]];
    const from = into(point), way = into(direction);
    for (let i = 0; i < part.place.length; i += 3 * STEP) {
      const x = part.place[i] - from[0], y = part.place[i + 1] - from[1], z = part.place[i + 2] - from[2];
      const along = x * way[0] + y * way[1] + z * way[2];
      if (along > NEAR && x * x + y * y + z * z - along * along < WIDE2) return true;
    }
  }
  return false;
}

/** Direction to look from that sees a point, as near to its normal as nothing hides it. */
function sight(point, normal) {
  let best = null;
  for (let e = -1; e <= 6; e++) {
    for (let a = 0; a < 16; a++) {
      const elevation = e * 0.24, azimuth = a * Math.PI / 8;
      const { back } = frameOf({ azimuth, elevation });
      const facing = dot(back, normal);
      if (facing > 0.12 && (!best || facing > best.facing) && !hidden(point, back)) best = { azimuth, elevation, facing };
    }
  }
  return best || { azimuth: Math.atan2(normal[1], normal[0]), elevation: Math.max(0.2, Math.asin(normal[2])) };
}

let flight = 0;
/** Moves the camera evenly to another place. */
function fly(to) {
  const from = { ...camera, target: [...camera.target] };
  let turn = to.azimuth - from.azimuth;
  turn -= 2 * Math.PI * Math.round(turn / (2 * Math.PI));
  const still = matchMedia('(prefers-reduced-motion: reduce)').matches || document.visibilityState === 'hidden';
  const start = performance.now(), mine = ++flight;
  const step = now => {
    if (mine !== flight) return;
    const raw = still ? 1 : Math.min((now - start) / 450, 1), t = raw * raw * (3 - 2 * raw);
    camera.azimuth = from.azimuth + turn * t;
    camera.elevation = from.elevation + (to.elevation - from.elevation) * t;
    camera.distance = from.distance * (to.distance / from.distance) ** t;
    camera.target = from.target.map((v, k) => v + (to.target[k] - v) * t);
    redraw();
    if (raw < 1) requestAnimationFrame(step);
  };
  step(start);
}
