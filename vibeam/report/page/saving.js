// Files of what is shown: CSV of numbers, SVG and PNG of pictures, on white paper.
import { element, onPaper } from "./state.js";
/** @import { Cell, Files } from "./types.d.ts" */

const INLINE = ["fill", "stroke", "stroke-width", "stroke-dasharray", "font-size", "font-family", "text-anchor"];
/** @type {(text: string) => string} */
const slug = (text) => text.normalize("NFKD").replace(/\p{M}/gu, "").replace(/[^\p{L}\p{N}]+/gu, "-").replace(/^-|-$/g, "").toLowerCase().slice(0, 60);

/** @type {(content: BlobPart, type: string, name: string, ending: string) => void} */
export function save(content, type, name, ending) {
  const link = element("a", { href: URL.createObjectURL(new Blob([content], { type })), download: `${slug(document.title) || "vibeam"}-${slug(name)}.${ending}` });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}

/** @type {(cell: Cell) => string} */
const quoted = (cell) => { const text = String(cell ?? ""); return /[",\r\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text; };
/** @type {(rows: Cell[][]) => string} */
export const csv = (rows) => rows.map((row) => row.map(quoted).join(",")).join("\r\n") + "\r\n";

/** @type {(source: string) => Promise<Blob>} */
async function png(source) {
  const picture = new Image();
  picture.src = source;
  await picture.decode();
  const canvas = element("canvas"), scale = Math.max(1, 1600 / picture.naturalWidth), pen = canvas.getContext("2d");
  [canvas.width, canvas.height] = [scale * picture.naturalWidth, scale * picture.naturalHeight];
  pen.fillStyle = "#fff";
  pen.fillRect(0, 0, canvas.width, canvas.height);
  pen.drawImage(picture, 0, 0, canvas.width, canvas.height);
  return new Promise((done) => canvas.toBlob(done));
}
/** @type {(svg: string) => string} */
const asData = (svg) => `data:image/svg+xml;charset=utf-8,${encodeURIComponent(svg)}`;

// Buttons of a view, placed behind ``after``; ``csv`` and ``svg`` make texts, ``image`` is a data URL in place of the SVG.
/** @type {(after: Element, name: string, files: Files) => void} */
export function offer(after, name, { csv: numbers, svg, image }) {
  const group = element("div", { class: "saves", role: "group", "aria-label": `Save ${name}` });
  /** @type {(kind: string, act: () => void) => void} */
  const button = (kind, act) => {
    const made = element("button", { type: "button", "aria-label": `${kind} of ${name}` }, kind);
    made.addEventListener("click", act);
    group.append(made);
  };
  const source = () => image ?? asData(svg ? onPaper(svg) : "");
  if (numbers) button("CSV", () => save("\ufeff" + numbers(), "text/csv", name, "csv"));
  if (svg || image) button("PNG", async () => save(await png(source()), "image/png", name, "png"));
  if (svg) button("SVG", () => save(onPaper(svg), "image/svg+xml", name, "svg"));
  after.after(group);
}

// A drawing of the page by itself: what the style sheet gives it is written into its elements.
/** @type {(svg: SVGSVGElement) => string} */
export function alone(svg) {
  const copy = /** @type {SVGSVGElement} */ (svg.cloneNode(true)), { width, height } = svg.viewBox.baseVal, theirs = [...copy.querySelectorAll("*")];
  [...svg.querySelectorAll("*")].forEach((each, at) => {
    const style = getComputedStyle(each);
    for (const name of INLINE) theirs[at].setAttribute(name, style.getPropertyValue(name));
  });
  for (const [name, value] of Object.entries({ xmlns: "http://www.w3.org/2000/svg", width, height })) copy.setAttribute(name, String(value));
  return new XMLSerializer().serializeToString(copy);
}

/** @type {(row: HTMLTableRowElement) => string[]} */
const cells = (row) => [...row.cells].map((cell) => cell.textContent);

// Buttons of all tables, pictures and drawings that stand on the page from the start.
export function offerStanding() {
  /** @type {NodeListOf<HTMLTableElement>} */
  const tables = document.querySelectorAll(".scroll > table");
  /** @type {NodeListOf<HTMLElement>} */
  const figures = document.querySelectorAll("figure[data-name]");
  for (const table of tables) {
    offer(table.parentElement ?? table, table.caption?.textContent || "table", { csv: () => csv([...table.rows].map(cells)) });
  }
  for (const figure of figures) {
    const image = figure.querySelector("img")?.src, own = figure.querySelector("svg"), numbers = figure.dataset.csv;
    const lines = image?.startsWith("data:image/svg") ? () => new TextDecoder().decode(Uint8Array.from(atob(image.split(",")[1]), (each) => each.charCodeAt(0))) : own && (() => alone(own));
    offer(figure, figure.dataset.name ?? "", { csv: numbers && (() => numbers), svg: lines, image: lines ? undefined : image });
  }
}
