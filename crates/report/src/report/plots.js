// Plots over time: operations, engagement, removal rate, limits of the feed, speeds and positions of all moves.
const plots = $('plots');
const pen = plots.getContext('2d');
const span = { from: 0, to: 1 };
const AXES = ['#d9480f', '#2b8a3e', '#1971c2', '#c2255c', '#7048e8'].map((colour, k) => [machine.names[k], colour]);
const DEGREES = 180 / Math.PI;

/** Value of each move: of joint k at its end in mm or degrees. */
const positions = k => k < 3 ? moves.joints[k] : moves.joints[k].map(v => v * DEGREES);

/** Value of each move from its change and its time in s. */
function rates(change) {
  const out = new Float32Array(moves.count);
  for (let i = 0; i < moves.count; i++) {
    const time = follows(i) ? moves.end[i] - moves.end[i - 1] : 0;
    if (time > 0) out[i] = change(i) / time;
  }
  return out;
}

/** Speed of the tip in mm/min, and speeds of the axes in % of their limits, of each move. */
let tipSpeed = [], shares = [];

/** Plots from above: what they show, their unit, lines of [name, colour, values], and whether a value holds for the whole move. */
let rows = [];
function prepareRows() {
  const simulated = data.paths.simulated, without = 'the stock was not simulated';
  tipSpeed = rates(i => 60 * Math.hypot(...[0, 1, 2].map(k => moves.tips[3 * i + k] - moves.tips[3 * i - 3 + k])));
  shares = AXES.map((_, k) => rates(i => 100 * Math.abs(moves.joints[k][i] - moves.joints[k][i - 1]) / machine.speeds[k]));
  rows = [
    {
      title: 'engagement: arc of the cutter in the stock', unit: 'deg', steps: true, without,
      lines: simulated ? [['arc', '#5f3dc4', moves.arcs]] : [],
    },
    {
      title: 'material removed', unit: 'mm³/min', steps: true, without,
      lines: simulated ? [['removal rate', '#a61e4d', moves.removal]] : [],
    },
    { title: 'what limits the feed', unit: '% of the time', lines: [], limits: true, without: 'not known' },
    { title: 'speed of the tip', unit: 'mm/min', lines: [['tip', '#087f5b', tipSpeed]], steps: true },
    { title: 'speed of the axes', unit: '% of limit', lines: AXES.map((a, k) => [...a, shares[k]]), steps: true },
    { title: 'linear axes', unit: 'mm', lines: [0, 1, 2].map(k => [...AXES[k], positions(k)]) },
    { title: 'rotary axes', unit: 'deg', lines: [3, 4].map(k => [...AXES[k], positions(k)]) },
  ];
  rows.forEach(setRange);
  Object.assign(span, { from: 0, to: Math.max(moves.total, 1e-6) });
}
const LEFT = 76, RIGHT = 14, TOP = 26, BOTTOM = 26, HEAD = 24;

/** Least and largest value of lines, with some room; from zero where values are steps. */
function setRange(row) {
  if (row.limits) { Object.assign(row, { low: 0, high: 100 }); return; }
  let low = row.steps ? 0 : Infinity, high = row.steps ? 0 : -Infinity;
  for (const [, , values] of row.lines) {
    for (const v of values) { if (v < low) low = v; if (v > high) high = v; }
  }
  if (!(high > low)) { low = Number.isFinite(low) ? low : 0; high = low + 1; }
  const room = 0.06 * (high - low);
  Object.assign(row, { low: row.steps ? low : low - room, high: high + room });
}

/** 1, 2 or 5 times a power of ten, not below a value. */
function roundStep(x) {
  const power = 10 ** Math.floor(Math.log10(x));
  return [1, 2, 5, 10].map(m => m * power).find(v => v >= x * (1 - 1e-9)) || x;
}

/** Steps of a clock in s. */
const CLOCK_STEPS = [0.1, 0.2, 0.5, 1, 2, 5, 10, 30, 60, 120, 300, 600, 1800, 3600, 7200, 18000, 36000, 86400];

const figure = (v, step) => v.toFixed(Math.max(0, Math.min(6, -Math.floor(Math.log10(step) + 1e-9))));
const clockFine = (t, step) => step < 1 ? `${clock(t)}${(t % 1).toFixed(1).slice(1)}` : clock(t);

/** Draws a line: as it is where moves are fewer than pixels, else the range of each column. */
function drawLine(values, steps, [first, last], x, y, width) {
  const few = last - first < 2 * width;
  pen.beginPath();
  if (few) {
    let pending = true;
    for (let i = first; i <= last; i++) {
      const px = x(moves.end[i]), py = y(values[i]);
      if (!follows(i)) { pending = true; }
      if (pending) pen.moveTo(px, py);
      else if (steps) { pen.lineTo(x(moves.end[i - 1]), py); pen.lineTo(px, py); }
      else pen.lineTo(px, py);
      pending = false;
    }
  } else {
    let column = -1, low = 0, high = 0, before = null;
    const flush = () => {
      if (column < 0) return;
      const a = y(low), b = y(high);
      // A range of no height still is one pixel.
      pen.moveTo(column + 0.5, Math.max(a, b + 1));
      pen.lineTo(column + 0.5, b);
    };
    for (let i = first; i <= last; i++) {
      const c = Math.floor(x(moves.end[i])), v = values[i];
      if (c !== column) {
        flush();
        // A move over several columns: bars between its ends, or its value held.
        if (before !== null && follows(i) && c - column > 1) {
          for (let k = column + 1; k < c; k++) {
            const at = share => steps ? v : before + (v - before) * share;
            const [a, b] = [at((k - column) / (c - column)), at((k + 1 - column) / (c - column))].map(y);
            pen.moveTo(k + 0.5, Math.max(a, b, Math.min(a, b) + 1));
            pen.lineTo(k + 0.5, Math.min(a, b));
          }
        }
        column = c;
        low = high = v;
        if (before !== null && follows(i) && !steps) { low = Math.min(low, before); high = Math.max(high, before); }
      } else {
        if (v < low) low = v;
        if (v > high) high = v;
      }
      before = v;
    }
    flush();
    // Ranges of several lines lie over one another.
    pen.globalAlpha = 0.6;
  }
  pen.stroke();
  pen.globalAlpha = 1;
}

/** Widths and heights of the plots in pixels of the page. */
function layout() {
  const width = plots.clientWidth - LEFT - RIGHT;
  const height = (plots.clientHeight - TOP - BOTTOM) / Math.max(rows.length, 1);
  return { width: Math.max(width, 1), height, x: t => LEFT + (t - span.from) / (span.to - span.from) * Math.max(width, 1) };
}

/** Draws for each column of pixels the shares of the limits in its time, one above the other. */
function drawLimits([first, last], x, y, width) {
  const count = data.paths.limits.length, columns = Math.ceil(width);
  if (!count) return;
  const times = new Float64Array(columns * count);
  for (let i = Math.max(first, 0); i <= last; i++) {
    const limit = moves.limiting[i];
    if (!(limit < count)) continue;
    const a = x(i ? moves.end[i - 1] : 0) - LEFT, b = x(moves.end[i]) - LEFT;
    for (let c = Math.max(Math.floor(a), 0); c <= Math.min(Math.floor(b), columns - 1); c++) {
      times[c * count + limit] += Math.max(Math.min(b, c + 1) - Math.max(a, c), 0);
    }
  }
  for (let c = 0; c < columns; c++) {
    let below = 0;
    for (let k = 0; k < count; k++) {
      // A column is one pixel wide, so that its time is its share.
      const share = 100 * times[c * count + k];
      if (share <= 0) continue;
      pen.fillStyle = data.limit_colours[k];
      pen.fillRect(LEFT + c, y(below + share), 1, y(below) - y(below + share));
      below += share;
    }
  }
}

/** Draws the strip of the operations above the plots. */
function drawOperations(x, width) {
  data.paths.operations.forEach((o, k) => {
    if (!o.count) return;
    const from = o.first ? moves.end[o.first - 1] : 0, to = moves.end[o.first + o.count - 1];
    const a = Math.max(x(from), LEFT), b = Math.min(x(to), LEFT + width);
    if (b <= a) return;
    pen.fillStyle = colourOf(k);
    pen.fillRect(a, 4, Math.max(b - a - 1, 1), 16);
    if (pen.measureText(o.name).width + 8 < b - a) {
      pen.fillStyle = '#fff';
      pen.textAlign = 'left';
      pen.fillText(o.name, a + 4, 12.5);
    }
  });
}

/** Names that a row has above it, with their colours. */
const namesOf = row => row.limits ? data.paths.limits.map((l, k) => [l, data.limit_colours[k]]) : row.lines;

/** Draws the title of a row and the names of its lines above it, so that nothing covers a line. */
function drawTitle(row, top, ink, width) {
  pen.textAlign = 'left';
  pen.fillStyle = ink;
  const title = `${row.title}, ${row.unit}`;
  pen.fillText(title, LEFT, top - 9);
  let at = LEFT + pen.measureText(title).width + 18;
  for (const [name, tint] of namesOf(row)) {
    const size = 18 + pen.measureText(name).width;
    if (at + size > LEFT + width) break;
    pen.fillStyle = tint;
    if (row.limits) pen.fillRect(at, top - 14, 12, 10); else pen.fillRect(at, top - 11, 14, 3);
    pen.fillStyle = ink;
    pen.fillText(name, at + 18, top - 9);
    at += size + 14;
  }
}

/** Draws the lines of a row with its grid. */
function drawRow(row, k, { x, width, height, times, range, tones: [ink, soft, grid, line] }) {
  const top = TOP + k * height + HEAD, bottom = TOP + (k + 1) * height - 2;
  const y = v => bottom - (v - row.low) / (row.high - row.low) * (bottom - top);
  const filled = row.lines.length || (row.limits && data.paths.limits.length);
  pen.strokeStyle = grid;
  pen.fillStyle = soft;
  pen.lineWidth = 1;
  pen.textAlign = 'right';
  pen.beginPath();
  for (const t of times) { pen.moveTo(x(t), top); pen.lineTo(x(t), bottom); }
  if (filled) {
    const rise = roundStep((row.high - row.low) * 20 / Math.max(bottom - top, 20));
    for (let v = Math.ceil(row.low / rise) * rise; v <= row.high + 1e-9 * rise; v += rise) {
      pen.moveTo(LEFT, y(v));
      pen.lineTo(LEFT + width, y(v));
      pen.fillText(figure(Math.abs(v) < rise * 1e-6 ? 0 : v, rise), LEFT - 6, y(v));
    }
  }
  pen.stroke();
  pen.strokeStyle = line;
  pen.strokeRect(LEFT + 0.5, top + 0.5, width - 1, bottom - top - 1);
  drawTitle(row, top, ink, width);
  if (!filled) {
    pen.textAlign = 'center';
    pen.fillStyle = soft;
    pen.fillText(row.without, LEFT + width / 2, (top + bottom) / 2);
  }
  pen.save();
  pen.beginPath();
  pen.rect(LEFT, top, width, bottom - top);
  pen.clip();
  pen.lineWidth = 1.2;
  if (row.limits && moves.count) drawLimits(range, x, y, width);
  for (const [, tint, values] of row.lines) {
    pen.strokeStyle = tint;
    if (moves.count) drawLine(values, row.steps, range, x, y, width);
  }
  pen.restore();
}

function drawPlots() {
  const scale = ratio();
  const w = Math.round(plots.clientWidth * scale), h = Math.round(plots.clientHeight * scale);
  if (plots.width !== w || plots.height !== h) { plots.width = w; plots.height = h; }
  const style = getComputedStyle(document.documentElement);
  const tones = ['--ink', '--soft', '--grid', '--line'].map(name => style.getPropertyValue(name).trim());
  pen.setTransform(scale, 0, 0, scale, 0, 0);
  pen.clearRect(0, 0, plots.clientWidth, plots.clientHeight);
  pen.font = '12px system-ui, "Segoe UI", "DejaVu Sans", sans-serif';
  pen.textBaseline = 'middle';
  const { width, height, x } = layout();
  const range = [moveAt(span.from), moveAt(span.to)];
  if (range[0] > 0) range[0]--;
  drawOperations(x, width);
  const step = CLOCK_STEPS.find(s => s * width / (span.to - span.from) >= 90) || 172800;
  const times = [];
  for (let t = Math.ceil(span.from / step - 1e-9) * step; t <= span.to; t += step) times.push(t);
  rows.forEach((row, k) => drawRow(row, k, { x, width, height, times, range, tones }));
  pen.fillStyle = tones[1];
  pen.textAlign = 'center';
  for (const t of times) pen.fillText(clockFine(t, step), Math.min(Math.max(x(t), LEFT), LEFT + width - 24), plots.clientHeight - BOTTOM / 2);
  plotsStale = false;
  showNow();
}

/** Puts the mark of the time where the tool is. It is an element of its own, since the lines take long to draw. */
function showNow() {
  if (!plotsSeen) return;
  const { width, x } = layout(), at = moves.count ? x(timeOf(show.move, show.share)) : -1;
  $('plots-now').hidden = at < LEFT || at > LEFT + width;
  $('plots-now').style.transform = `translateX(${at - 0.5}px)`;
}

/** Time at a share of a move. */
function timeOf(i, share) {
  const before = i ? moves.end[i - 1] : 0;
  return before + (moves.end[i] - before) * share;
}

/** Shows another range of times, kept within the program. */
function setSpan(from, to) {
  const least = Math.min(0.5, moves.total || 1), size = Math.min(Math.max(to - from, least), Math.max(moves.total, 1e-6));
  span.from = Math.min(Math.max(from, 0), Math.max(moves.total - size, 0));
  span.to = span.from + size;
  redrawPlots();
}

function zoomSpan(factor, share) {
  const size = span.to - span.from, at = span.from + size * share;
  setSpan(at - size * factor * share, at + size * factor * (1 - share));
}

let plotsWaiting = false, plotsStale = false, plotsSeen = false;
/** Draws the plots in the next frame, or when they come into the window. */
function redrawPlots() {
  plotsStale = true;
  if (plotsWaiting || !plotsSeen) return;
  plotsWaiting = true;
  requestAnimationFrame(() => { plotsWaiting = false; if (plotsStale) drawPlots(); });
}
new IntersectionObserver(entries => {
  plotsSeen = entries[entries.length - 1].isIntersecting;
  if (plotsStale) redrawPlots(); else showNow();
}).observe(plots);
addEventListener('beforeprint', () => { if (plotsStale) drawPlots(); });

/** Joints, speed and removal rate of a move in words. */
function figuresOf(i, share) {
  const q = jointsOn(i, share);
  const axes = AXES.map(([name], k) => `${name} ${(k < 3 ? q[k] : q[k] * DEGREES).toFixed(3)}`).join('  ');
  const most = shares.reduce((best, s, k) => s[i] > best[0] ? [s[i], AXES[k][0]] : best, [0, '']);
  const parts = [clockFine(timeOf(i, share), 0.1), axes, `tip ${tipSpeed[i].toFixed(0)} mm/min`];
  if (most[1]) parts.push(`${most[1]} at ${most[0].toFixed(1)} % of its speed`);
  const limit = data.paths.limits[moves.limiting[i]];
  if (limit) parts.push(`limited by ${limit}`);
  if (data.paths.simulated) parts.push(`removal ${moves.removal[i].toFixed(0)} mm³/min`, `arc ${moves.arcs[i].toFixed(0)} deg`);
  return parts.join('   ');
}
