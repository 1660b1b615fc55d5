// When the picture is drawn, and how finely. A picture that takes long, as without a graphics processor, is coarser while something
// changes, and whole when all rests.

/** Longest time in ms of a whole picture that is drawn at every change; of one that is drawn in one go; without a change until all
 * rests. */
const BUDGET = 30, AT_ONCE = 120, REST = 150;
/** Share that a coarse picture has of the width and height of the whole one. */
const COARSE = 0.5;

/** `cost`: time of the last whole picture in ms; `busy`: the graphics card has not ended what it was given; `rest`: what is still
 * to be drawn of the picture at rest. */
const frames = { cost: null, busy: false, asked: false, dirty: false, whole: false, visible: true, rest: null, timer: 0, targets: {} };

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

/** Buffers for a whole or coarse picture, of the size of the canvas. The edges of the whole one are smooth. */
function target(coarse) {
  const share = coarse ? COARSE : 1;
  const [width, height] = [canvas.width, canvas.height].map(v => Math.max(1, Math.round(share * v)));
  const t = frames.targets[coarse] ??= { frame: gl.createFramebuffer(), buffers: [gl.createRenderbuffer(), gl.createRenderbuffer()] };
  gl.bindFramebuffer(gl.FRAMEBUFFER, t.frame);
  if (t.width !== width || t.height !== height) {
    Object.assign(t, { width, height, grain: 1 / share });
    const samples = coarse ? 0 : Math.min(4, gl.getParameter(gl.MAX_SAMPLES));
    [[gl.RGBA8, gl.COLOR_ATTACHMENT0], [gl.DEPTH_COMPONENT24, gl.DEPTH_ATTACHMENT]].forEach(([format, place], k) => {
      gl.bindRenderbuffer(gl.RENDERBUFFER, t.buffers[k]);
      gl.renderbufferStorageMultisample(gl.RENDERBUFFER, samples, format, width, height);
      gl.framebufferRenderbuffer(gl.FRAMEBUFFER, place, gl.RENDERBUFFER, t.buffers[k]);
    });
  }
  gl.viewport(0, 0, width, height);
  return t;
}

/** Brings a picture onto the canvas. */
function present(t) {
  gl.bindFramebuffer(gl.READ_FRAMEBUFFER, t.frame);
  gl.bindFramebuffer(gl.DRAW_FRAMEBUFFER, null);
  const { width, height } = canvas;
  gl.blitFramebuffer(0, 0, t.width, t.height, 0, 0, width, height, gl.COLOR_BUFFER_BIT, t.width === width ? gl.NEAREST : gl.LINEAR);
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

/** Draws at once what now is to be shown. */
function draw() {
  if (!scene) return;
  clearTimeout(frames.timer);
  Object.assign(frames, { dirty: false, rest: null });
  const start = performance.now(), coarse = frames.cost > BUDGET, t = target(coarse);
  const work = pieces({ ...projection(), coarse, grain: t.grain });
  while (!work.next().done);
  present(t);
  whenDone(start, time => {
    // In the time of the first picture is that of its programs.
    if (!coarse) frames.cost = frames.cost === null && time < AT_ONCE ? 0 : time;
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
    const t = target(false);
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
    Object.assign(frames, { cost: spent + time, rest: null, whole: true });
    tell();
  });
}

/** Fits the picture to its place in the page. */
function resize() {
  const w = Math.max(1, Math.round(canvas.clientWidth * ratio())), h = Math.max(1, Math.round(canvas.clientHeight * ratio()));
  frames.whole = false;
  if (canvas.width !== w || canvas.height !== h) { canvas.width = w; canvas.height = h; }
  draw();
}

// What is not in the window is drawn when it comes into it.
new IntersectionObserver(entries => {
  frames.visible = entries[entries.length - 1].isIntersecting;
  if (scene && frames.visible && frames.dirty) ask(); else if (scene && frames.visible && !frames.whole) rest();
  tell();
}).observe(canvas);
