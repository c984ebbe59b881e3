// Motions at one frequency.

const kept = [...new Set(data.motions.map((each) => each.frequency))].sort((a, b) => a - b);
let frame = 0, playing = null, current = [];

function cached(motion) {
  if (!motion.x.map) {
    for (const name of ["time", "x", "v", "spectrum"]) motion[name] = unpacked(motion[name]);
    motion.section = motion.section.map(unpacked);
    motion.beam = motion.beam ? unpacked(motion.beam) : null;
  }
  return motion;
}

function drawMotion() {
  const frequency = kept[+byId("pick").value], way = byId("way").value;
  byId("picked").textContent = `${short(frequency * FACTOR, 6)} ${data.frequency.unit}`;
  const here = data.motions.filter((each) => each.frequency === frequency && each.way === way && !hiddenCurves.has(title(each)));
  byId("faults").replaceChildren(...here.filter((each) => each.fault).map((each) => element("p", { class: "note" }, `${title(each)}: ${each.fault}`)));
  current = here.filter((each) => !each.fault).map(cached);
  drawHistory(); drawSpectrum(); drawPortrait(); drawBeam(); listNumbers();
}

const own = (motion) => ({ label: fidelity[motion.fidelity].label, stroke: fidelity[motion.fidelity].colour, dash: fidelity[motion.fidelity].dash, width: 1.5, spanGaps: true, points: { show: false }, value: (plot, value) => short(value) });

function joined(motions, xs, ys) {
  return uPlot.join(motions.map((each, index) => [increasing(xs(each)), ys(each)]));
}
function increasing(values) {
  let last = -Infinity;
  return values.map((value) => (last = value > last ? value : last + 1e-9));
}

function drawHistory() {
  const host = byId("history");
  if (!current.length) return host.replaceChildren();
  const columns = joined(current, (each) => each.time, (each) => each.x.map((value) => value * data.output.factor));
  chart(host, [{ label: "Time in drive periods", value: (plot, value) => short(value) }, ...current.map(own)], columns, [{ ...axis("Time in drive periods"), size: 44 }, axis(withUnit(data.output.name, data.output.unit))], { height: 250, words: "Displacement of the output over time" });
}

function drawSpectrum() {
  const host = byId("spectrum");
  if (!current.length) return host.replaceChildren();
  const count = current[0].spectrum.length, floor = -6;
  const columns = [Array.from({ length: count }, (_, index) => (index * data.lines) / (count - 1))];
  const top = Math.max(...current.flatMap((each) => each.spectrum));
  current.forEach((each) => columns.push(each.spectrum.map((value) => Math.max(value, top + floor) + Math.log10(data.output.factor))));
  const powers = (plot, splits) => splits.map((value) => (Number.isInteger(value) ? `1e${value}` : ""));
  chart(host, [{ label: "Multiple of the drive frequency", value: (plot, value) => short(value) }, ...current.map((each) => ({ ...own(each), value: (plot, value) => short(value === null ? null : 10 ** value, 3) }))], columns, [{ ...axis("Multiple of the drive frequency"), size: 44 }, { ...axis(withUnit("Amplitude", data.output.unit)), values: powers }], { height: 250, words: "Spectrum of the output" });
}

function spanOf(values) {
  let low = Infinity, high = -Infinity;
  for (const value of values) { if (value < low) low = value; if (value > high) high = value; }
  const room = (high - low || Math.abs(high) || 1) * 0.06;
  return [low - room, high + room];
}

function ticks(low, high) {
  const rough = (high - low) / 5, size = 10 ** Math.floor(Math.log10(rough));
  const step = size * [1, 2, 5, 10].find((each) => each * size >= rough);
  const found = [];
  for (let at = Math.ceil(low / step); at * step <= high; at += 1) found.push(at * step);
  return found;
}

function drawPortrait() {
  const svg = byId("portrait"), [width, height, left, bottom] = [480, 300, 62, 40];
  svg.replaceChildren();
  if (!current.length) return;
  const [low, high] = spanOf(current.flatMap((each) => each.x)), [slow, fast] = spanOf(current.flatMap((each) => each.v));
  const x = (value) => left + ((value - low) / (high - low)) * (width - left - 10);
  const y = (value) => height - bottom - ((value - slow) / (fast - slow)) * (height - bottom - 10);
  svg.append(drawn("rect", { x: left, y: 10, width: width - left - 10, height: height - bottom - 10, fill: "none", stroke: "#9aa5b1" }));
  for (const at of ticks(low * data.output.factor, high * data.output.factor)) svg.append(drawn("text", { x: x(at / data.output.factor), y: height - bottom + 15 }, short(at, 6)));
  for (const at of ticks(slow * data.speed.factor, fast * data.speed.factor)) {
    const mark = drawn("text", { x: left - 6, y: y(at / data.speed.factor) + 4 }, short(at, 6));
    mark.style.textAnchor = "end";
    svg.append(mark);
  }
  svg.append(drawn("text", { x: (left + width) / 2, y: height - 6 }, withUnit("displacement", data.output.unit) + " — velocity" + (data.speed.unit ? ` (${data.speed.unit})` : "") + " upward"));
  for (const each of current) {
    const colour = fidelity[each.fidelity].colour;
    svg.append(drawn("path", { d: each.x.map((value, at) => `${at ? "L" : "M"}${x(value).toFixed(1)} ${y(each.v[at]).toFixed(1)}`).join(""), fill: "none", stroke: colour, "stroke-width": 1.4, "stroke-dasharray": fidelity[each.fidelity].dash.join(" ") }));
    each.section[0].forEach((value, at) => svg.append(drawn("circle", { cx: x(value), cy: y(each.section[1][at]), r: 3, fill: colour })));
  }
}

function drawBeam() {
  const svg = byId("beam"), with_beam = current.filter((each) => each.beam);
  svg.replaceChildren();
  if (!with_beam.length) return svg.append(drawn("text", { x: 240, y: 130 }, "no places along a beam are known here"));
  const [low, high] = spanOf(with_beam.flatMap((each) => each.beam).concat(0));
  const y = (value) => 240 - ((value - low) / (high - low)) * 220;
  svg.append(drawn("path", { d: `M20 ${y(0)}H460`, stroke: "#9aa5b1", "stroke-dasharray": "4 3" }));
  for (const each of with_beam) {
    const places = fidelity[each.fidelity].places, count = places.length - 1, end = places[count];
    const shown = each.beam.slice(frame * count, (frame + 1) * count);
    const points = places.slice(1).map((place, at) => `${(20 + (440 * place) / end).toFixed(1)},${y(shown[at]).toFixed(1)}`);
    svg.append(drawn("polyline", { points: points.join(" "), fill: "none", stroke: fidelity[each.fidelity].colour, "stroke-width": 2.2, "stroke-dasharray": fidelity[each.fidelity].dash.join(" ") }));
  }
  svg.append(drawn("text", { x: 240, y: 16 }, `${frame + 1} of ${data.frames}, deflections ${short(low * 1e3, 2)} … ${short(high * 1e3, 2)} mm, beam not to this scale`));
}

function listNumbers() {
  const table = byId("numbers");
  table.replaceChildren(element("caption", {}, "Numbers of these motions"));
  const head = element("tr");
  for (const name of ["fidelity", "repeats after (drive periods)", "impacts shown", "velocities before impact (mm/s)", "modes from 2 on, share of energy"]) head.append(element("th", { scope: "col" }, name));
  const body = element("tbody");
  for (const each of current) {
    const row = element("tr"), curve = data.curves.find((one) => one.fidelity === each.fidelity && one.way === each.way);
    const period = curve.values.period[curve.frequency.indexOf(each.frequency)];
    const cells = [period === 0 ? "does not" : period === -1 ? "1, no contact" : short(period), String(each.impacts.length), each.impacts.slice(0, 6).map((hit) => short(hit[1] * 1e3, 3)).join(", ") || "–", each.shares.length > 1 ? `${short(100 * each.shares.slice(1).reduce((a, b) => a + b, 0), 3)} %` : "–"];
    row.append(element("th", { scope: "row" }, fidelity[each.fidelity].label), ...cells.map((text) => element("td", {}, text)));
    body.append(row);
  }
  const top = element("thead");
  top.append(head);
  table.append(top, body);
}

function play() {
  const button = byId("play");
  if (playing) { clearInterval(playing); playing = null; } else playing = setInterval(() => { frame = (frame + 1) % data.frames; drawBeam(); }, 90);
  button.setAttribute("aria-pressed", String(Boolean(playing)));
  button.textContent = playing ? "Pause" : "Play";
}
