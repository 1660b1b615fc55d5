// When the picture is drawn, and how finely. A picture that takes long, as without a graphics processor, is coarser while something
// changes, and whole when all rests.

/** Longest time in ms of a whole picture that is drawn at every change; of one that is drawn in one go; without a change until all
 * rests. */
const BUDGET = 30, AT_ONCE = 120, REST = 150;
/** Share that a coarse picture has of the width and height of the whole one; the browser enlarges it. */
const COARSE = 0.5;

/** `cost`: time of a whole picture in ms; `last`: that of the last one; `busy`: the graphics card has not ended what it was given;
 * `rest`: what is still to be drawn of the picture at rest; `size`: width and height of the whole picture. */
const frames = {
  cost: 0, last: 0, busy: false, asked: false, dirty: false, whole: false, visible: true, rest: null, timer: 0, size: [1, 1], targets: {},
};

const ratio = () => Math.min(window.devicePixelRatio || 1, 2);

/** Tells those who look at the page whether the picture is the whole one. */
function tell() {
  document.documentElement.dataset.picture = !frames.visible ? 'unseen' : frames.whole ? 'whole' : 'unfinished';
}

/** Asks for a picture of what now is to be shown, in the next frame. */
function redraw() {
  if (!scene) return;
  Object.assign(frames, { dirty: true, whole: false, rest: null });
  clearTimeout(frames.timer);
  tell();
  ask();
}

function ask() {
  if (frames.asked || frames.busy || !frames.visible || !scene) return;
  frames.asked = true;
  requestAnimationFrame(() => {
    frames.asked = false;
    drawNow();
  });
}

/** Draws what has changed, unless the graphics card is at work or nobody sees it. */
function drawNow() {
  if (frames.dirty && !frames.busy && frames.visible) draw();
}

/** Buffers by name: of the whole picture, which has smooth edges, of a coarse one, and of the body alone in a coarse one. */
function target(name) {
  const whole = name === 'whole', share = whole ? 1 : COARSE;
  const [width, height] = frames.size.map(v => Math.max(1, Math.round(share * v)));
  const t = frames.targets[name] ??= { frame: gl.createFramebuffer(), buffers: [gl.createRenderbuffer(), gl.createRenderbuffer()] };
  gl.bindFramebuffer(gl.FRAMEBUFFER, t.frame);
  if (t.width !== width || t.height !== height) {
    Object.assign(t, { width, height, grain: 1 / share, holds: '' });
    const samples = whole ? Math.min(4, gl.getParameter(gl.MAX_SAMPLES)) : 0;
    [[gl.RGBA8, gl.COLOR_ATTACHMENT0], [gl.DEPTH_COMPONENT24, gl.DEPTH_ATTACHMENT]].forEach(([format, place], k) => {
      gl.bindRenderbuffer(gl.RENDERBUFFER, t.buffers[k]);
      gl.renderbufferStorageMultisample(gl.RENDERBUFFER, samples, format, width, height);
      gl.framebufferRenderbuffer(gl.FRAMEBUFFER, place, gl.RENDERBUFFER, t.buffers[k]);
    });
  }
  gl.viewport(0, 0, width, height);
  return t;
}

/** Copies buffers of one picture to another one, or to the canvas. */
function copy({ frame, width, height }, to, which) {
  gl.bindFramebuffer(gl.READ_FRAMEBUFFER, frame);
  gl.bindFramebuffer(gl.DRAW_FRAMEBUFFER, to);
  gl.blitFramebuffer(0, 0, width, height, 0, 0, width, height, which, gl.NEAREST);
}

/** Draws the body of a coarse picture; while only the tool moves it is the one that was drawn before. */
function drawCoarseBody(view, t) {
  const body = target('body');
  const holds = JSON.stringify([camera, bodyNow(), show.section, view.plane, show.scale, shaded(), show.bands, scene.stock.length]);
  if (body.holds !== holds) {
    body.holds = holds;
    begin();
    for (const _ of drawBody(view));
  }
  copy(body, t.frame, gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
  gl.bindFramebuffer(gl.FRAMEBUFFER, t.frame);
}

/** Brings a picture onto the canvas. */
function present(t) {
  if (canvas.width !== t.width || canvas.height !== t.height) Object.assign(canvas, { width: t.width, height: t.height });
  copy(t, null, gl.COLOR_BUFFER_BIT);
}

/** Calls with the time that it took, when the graphics card has ended what it was given. */
function whenDone(start, then) {
  const fence = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
  gl.flush();
  frames.busy = true;
  const look = () => {
    if (scene && gl.getSyncParameter(fence, gl.SYNC_STATUS) !== gl.SIGNALED) { setTimeout(look, 1); return; }
    gl.deleteSync(fence);
    frames.busy = false;
    then(performance.now() - start);
    if (frames.dirty) ask();
  };
  setTimeout(look);
}

/** Takes the time of a whole picture. One picture may have waited for something else, such as its programs; two are slow. */
function measured(time) {
  frames.cost = time > AT_ONCE ? time : Math.min(time, frames.last);
  frames.last = time;
}

/** Draws at once what now is to be shown. */
function draw() {
  if (!scene) return;
  clearTimeout(frames.timer);
  Object.assign(frames, { dirty: false, rest: null });
  const start = performance.now(), coarse = frames.cost > BUDGET, t = target(coarse ? 'coarse' : 'whole');
  const view = { ...projection(), coarse, grain: t.grain };
  if (coarse) { drawCoarseBody(view, t); drawMoving(view); } else for (const _ of pieces(view));
  present(t);
  whenDone(start, time => {
    if (!coarse) measured(time);
    if (frames.dirty) return;
    if (coarse) { frames.timer = setTimeout(rest, REST); return; }
    frames.whole = true;
    tell();
  });
}

/** Begins the whole picture of what is at rest. */
function rest() {
  requestAnimationFrame(() => {
    if (!scene || frames.dirty || frames.busy || frames.rest || !frames.visible) return;
    const t = target('whole');
    frames.rest = pieces({ ...projection(), coarse: false, grain: t.grain });
    goOn(t, frames.rest, frames.cost < AT_ONCE ? Infinity : 1, 0);
  });
}

/** Draws some more pieces of the picture at rest, as long as nothing has changed. */
function goOn(t, work, count, spent) {
  const start = performance.now();
  let done = false;
  for (let i = 0; i < count && !done; i++) done = work.next().done;
  if (done) present(t);
  whenDone(start, time => {
    if (!scene || work !== frames.rest) return;
    if (!done) { goOn(t, work, time < BUDGET ? 2 * count : count, spent + time); return; }
    measured(spent + time);
    Object.assign(frames, { rest: null, whole: true });
    tell();
  });
}

/** Fits the picture to its place in the page. */
function resize() {
  frames.size = [canvas.clientWidth, canvas.clientHeight].map(v => Math.max(1, Math.round(v * ratio())));
  redraw();
  draw();
}

// What is not in the window is drawn when it comes into it.
new IntersectionObserver(entries => {
  frames.visible = entries[entries.length - 1].isIntersecting;
  if (scene && frames.visible && frames.dirty) ask(); else if (scene && frames.visible && !frames.whole) rest();
  tell();
}).observe(canvas);
