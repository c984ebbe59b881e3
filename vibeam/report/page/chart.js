// Charts: uPlot has axes, zoom and legend; what is in them is drawn by one function, on the page and in a saved SVG.
import { element, ink } from "./state.js";
import { short } from "./numbers.js";
/** @import { Chart, ChartParts, Draw, Frame, Look, Pen, Plot, PlotAxis } from "./types.d.ts" */

/** @type {{host: HTMLElement, plot: Plot}[]} */
const charts = [];
/** @type {(host: HTMLElement) => number} */
const widthOf = (host) => Math.max(280, host.clientWidth || 280);
addEventListener("resize", () => charts.forEach((each) => each.plot.setSize({ width: widthOf(each.host), height: each.plot.height })));

/** @type {(label: string | null) => PlotAxis} */
export const axis = (label) => ({ label, values: (plot, splits) => splits.map((value) => (value === null ? "" : short(value, 6))), stroke: () => ink(), grid: { stroke: () => ink("line"), width: 1 }, ticks: { stroke: () => ink("line") }, size: 66 });
/** @type {(plot: Plot, ratio: number) => Frame} */
function frameOf(plot, ratio) {
  const scale = ratio / devicePixelRatio, { left, top, width, height } = plot.bbox;
  /** @type {(name: string) => (value: number) => number} */
  const at = (name) => {  // scales are linear: two calls a frame, not one a point
    const { min, max } = plot.scales[name], low = plot.valToPos(min, name, true) * scale, high = plot.valToPos(max, name, true) * scale;
    return (value) => low + ((high - low) / (max - min)) * (value - min);
  };
  return { ratio, left: left * scale, top: top * scale, width: width * scale, height: height * scale, x: at("x"), y: at("y"), scales: plot.scales };
}

// The frame for values in other units: factors to those of the axes.
/** @type {(at: Frame, across: number, up: number) => Frame} */
export const framed = (at, across, up) => ({ ...at, x: (value) => at.x(value * across), y: (value) => at.y(value * up) });

/** @type {(pen: Pen, at: Frame, draw: Draw) => void} */
function inside(pen, at, draw) {
  pen.save();
  pen.beginPath();
  pen.rect(at.left, at.top, at.width, at.height);
  pen.clip();
  draw(pen, at);
  pen.restore();
}

/** @type {(host: HTMLElement, parts: ChartParts) => Chart} */
export function chart(host, { words, height = 320, series, columns, axes, scales = {}, draw, mark = () => {}, hooks = {}, legend = true, cursor = {} }) {
  host.replaceChildren();
  /** @type {Draw} */
  const drawAll = (pen, at) => { inside(pen, at, draw); mark(pen, at); };
  const own = series.map((each, index) => (index ? { paths: () => null, points: { show: false }, ...each } : each));
  const plot = new uPlot({
    width: widthOf(host), height, scales: { x: { time: false }, ...scales }, axes, series: own, legend: { show: legend },
    cursor: { focus: { prox: 24 }, ...cursor }, hooks: { ...hooks, draw: [(/** @type {Plot} */ made) => drawAll(made.ctx, frameOf(made, devicePixelRatio))] },
  }, columns, host);
  const canvas = plot.root.querySelector("canvas");
  canvas?.setAttribute("role", "img");
  canvas?.setAttribute("aria-label", words);
  plot.root.querySelector(".u-legend tr:first-child th:empty")?.remove();
  for (const each of charts.splice(0)) if (each.host !== host && each.host.isConnected) charts.push(each); else each.plot.destroy();
  charts.push({ host, plot });
  return { plot, words, series: legend ? own.slice(1).filter((each) => each.show !== false) : [], drawAll };
}

/** @type {(pen: Pen, at: Frame, xs: ArrayLike<number>, ys: ArrayLike<number | null>, look: Look) => void} */
export function lines(pen, at, xs, ys, look) {
  pen.strokeStyle = look.colour;
  pen.lineWidth = (look.width || 1.5) * at.ratio;
  pen.setLineDash((look.dash || []).map((each) => each * at.ratio));
  pen.beginPath();
  let joined = false;
  for (let index = 0; index < xs.length; index += 1) {
    const up = ys[index];
    if (up === null) joined = false;
    else if (joined) pen.lineTo(at.x(xs[index]), at.y(up));
    else { pen.moveTo(at.x(xs[index]), at.y(up)); joined = true; }
  }
  pen.stroke();
}

/** @type {(pen: Pen, marker: string, x: number, y: number, size: number) => void} */
export function drawMark(pen, marker, x, y, size) {
  pen.beginPath();
  if (marker === "_") { pen.moveTo(x - size, y); pen.lineTo(x + size, y); }
  else if (marker === "x") { pen.moveTo(x - size, y - size); pen.lineTo(x + size, y + size); pen.moveTo(x - size, y + size); pen.lineTo(x + size, y - size); }
  else if (marker === "D") { pen.moveTo(x, y - 1.4 * size); pen.lineTo(x + 1.4 * size, y); pen.lineTo(x, y + 1.4 * size); pen.lineTo(x - 1.4 * size, y); pen.closePath(); }
  else { pen.moveTo(x + size, y); pen.arc(x, y, size, 0, 7); }
  if (marker === "full") pen.fill(); else pen.stroke();
}

/** Dashed line over the whole height. @type {(pen: Pen, at: Frame, value: number) => void} */
export function upright(pen, at, value) {
  const look = { colour: ink("pale"), width: 1, dash: [3, 3] };
  lines(pen, { ...at, y: (up) => up }, [value, value], [at.top, at.top + at.height], look);
}

// Text of a case within SVG, without what XML may not hold.
/** @type {(text: string) => string} */
const escaped = (text) => element("i", {}, text.replace(/[\x00-\x08\x0b\x0c\x0e-\x1f\ufffe\uffff]/g, "")).innerHTML;

// Pen with the strokes of a canvas that writes SVG.
/** @implements {Pen} */
class SvgPen {
  static cuts = 0;
  /** @type {string[]} */
  parts = [];
  /** @type {number[]} */
  dash = [];
  d = "";
  open = false;
  lineWidth = 1;
  lineDashOffset = 0;
  strokeStyle = "#000";
  fillStyle = "#000";
  font = "12px sans-serif";
  /** @type {"left" | "right" | "center"} */
  textAlign = "left";
  beginPath() { this.d = ""; }
  /** @type {Pen["moveTo"]} */
  moveTo(x, y) { this.d += `M${x.toFixed(2)} ${y.toFixed(2)}`; }
  /** @type {Pen["lineTo"]} */
  lineTo(x, y) { this.d += `L${x.toFixed(2)} ${y.toFixed(2)}`; }
  closePath() { this.d += "Z"; }
  /** @type {Pen["arc"]} */
  arc(x, y, r) { this.d += `M${(x - r).toFixed(2)} ${y.toFixed(2)}a${r} ${r} 0 1 0 ${2 * r} 0a${r} ${r} 0 1 0 ${-2 * r} 0`; }
  /** @type {Pen["rect"]} */
  rect(x, y, width, height) { this.d += `M${x} ${y}h${width}v${height}h${-width}Z`; }
  /** @type {Pen["setLineDash"]} */
  setLineDash(dash) { this.dash = dash; }
  save() {}
  clip() { const id = `cut${SvgPen.cuts += 1}`; this.parts.push(`<clipPath id="${id}"><path d="${this.d}"/></clipPath><g clip-path="url(#${id})">`); this.open = true; }
  restore() { if (this.open) this.parts.push("</g>"); this.open = false; this.setLineDash([]); this.lineDashOffset = 0; }
  stroke() { this.parts.push(`<path d="${this.d}" fill="none" stroke="${this.strokeStyle}" stroke-width="${this.lineWidth}" stroke-dasharray="${this.dash.join(" ")}" stroke-dashoffset="${this.lineDashOffset}"/>`); }
  fill() { this.parts.push(`<path d="${this.d}" fill="${this.fillStyle}"/>`); }
  /** @type {(text: string, x: number, y: number, turn?: string) => void} */
  fillText(text, x, y, turn = "") {
    const anchor = { left: "start", right: "end", center: "middle" }[this.textAlign];
    this.parts.push(`<text x="${x.toFixed(1)}" y="${y.toFixed(1)}" font-size="12" font-family="sans-serif" fill="${this.fillStyle}" text-anchor="${anchor}"${turn}>${escaped(text)}</text>`);
  }
}

/** @type {(pen: Pen, plot: Plot, at: Frame) => void} */
function drawAxes(pen, plot, at) {
  const [across, up] = plot.axes, low = at.top + at.height, [{ _splits: xs = [] }, { _splits: ys = [] }] = plot.axes;
  /** @type {(text: string, x: number, y: number, align: string, turn?: string) => void} */
  const write = (text, x, y, align, turn) => { [pen.fillStyle, pen.textAlign] = [ink(), align]; pen.fillText(text, x, y, turn); };
  [pen.strokeStyle, pen.lineWidth] = [ink("line"), 1];
  pen.beginPath();
  for (const value of xs) { pen.moveTo(at.x(value), at.top); pen.lineTo(at.x(value), low); }
  for (const value of ys) { pen.moveTo(at.left, at.y(value)); pen.lineTo(at.left + at.width, at.y(value)); }
  pen.rect(at.left, at.top, at.width, at.height);
  pen.stroke();
  xs.forEach((value, index) => write(String(across._values?.[index] ?? ""), at.x(value), low + 16, "center"));
  ys.forEach((value, index) => write(String(up._values?.[index] ?? ""), at.left - 6, at.y(value) + 4, "right"));
  if (across.label) write(across.label, at.left + at.width / 2, low + 34, "center");
  const middle = at.top + at.height / 2;
  if (up.label) write(up.label, 14, middle, "center", ` transform="rotate(-90 14 ${middle.toFixed(1)})"`);
}

// Charts one below the other as an SVG, each with its axes and legend.
/** @type {(made: Chart[], title?: string) => string} */
export function svgOf(made, title = "") {
  const width = Math.max(...made.map((each) => each.plot.width));
  let top = title ? 24 : 4, parts = title ? [`<text x="8" y="16" font-size="13" font-family="sans-serif" fill="${ink()}">${escaped(title)}</text>`] : [];
  for (const each of made) {
    const pen = new SvgPen(), at = frameOf(each.plot, 1), below = at.top + at.height + 50;
    drawAxes(pen, each.plot, at);
    each.drawAll(pen, at);
    each.series.forEach((own, index) => {
      pen.strokeStyle = own.stroke?.() ?? ink();
      [pen.lineWidth, pen.fillStyle, pen.textAlign] = [3, ink(), "left"];
      pen.beginPath(); pen.moveTo(at.left, below + 18 * index - 4); pen.lineTo(at.left + 20, below + 18 * index - 4); pen.stroke();
      pen.fillText(own.label ?? "", at.left + 28, below + 18 * index);
    });
    parts.push(`<g transform="translate(0 ${top})">`, ...pen.parts, "</g>");
    top += at.top + at.height + (each.plot.axes[0].label ? 40 : 10) + 18 * each.series.length;
  }
  return `<svg xmlns="http://www.w3.org/2000/svg" width="${width}" height="${top + 8}" viewBox="0 0 ${width} ${top + 8}"><rect width="100%" height="100%" fill="#fff"/>${parts.join("")}</svg>`;
}
