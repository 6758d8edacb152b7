import uPlot from "uplot";
import "uplot/dist/uPlot.min.css";
import { make } from "../core/dom";
import { aligned, nearestIndex, type Band } from "./bands";

export interface Curve {
  label: string;
  values: number[];
  band?: Band; // shaded behind it
}
export interface CurvePlot {
  title: string; // with the unit
  curves: Curve[];
}

// colours after Okabe and Ito, and dashes, so that curves differ without colour too
const strokes = ["#0072b2", "#d55e00", "#009e73"];
const darkStrokes = ["#56b4e9", "#e69f00", "#2fd0a5"];
const dashes = [[], [8, 4], [2, 3]];

/** Some room about the values, and never next to none: a curve that stays is a line, not a scale of noise. */
export function shownRange(low: number | null, high: number | null): [number, number] {
  if (low === null || high === null) return [0, 1];
  const middle = (low + high) / 2;
  const half = Math.max(0.55 * (high - low), 0.02 * Math.abs(middle), 1e-9);
  return half > 1e-8 ? [low >= 0 && middle < 2 * half ? 0 : middle - half, middle + half] : [-1, 1];
}

/** Plots over the frames of a movement, one below the other; clicking one chooses the frame. */
export class Curves {
  readonly element = make("section", { class: "curves", "aria-label": "Curves over the movement" });
  private plots: uPlot[] = [];
  private data: { x: number[]; plots: CurvePlot[]; lacking: boolean[]; note: string } | null = null;
  private current = 0;
  private width = 0; // that the plots were built for

  constructor(private readonly onChoose: (frame: number) => void) {
    new ResizeObserver(() => this.element.clientWidth !== this.width && this.build()).observe(this.element);
  }

  /** @param lacking frames without a result, shaded */
  show(x: number[], plots: CurvePlot[], lacking: boolean[], note = "Over time [s]; shaded: frames without a result."): void {
    this.data = { x, plots, lacking, note };
    this.build();
  }

  setFrame(frame: number): void {
    this.current = frame;
    for (const plot of this.plots) plot.redraw(false);
  }

  /** Again, with the colours of the theme now in use. */
  build(): void {
    const width = this.element.clientWidth;
    if (!this.data || width < 50) return;
    this.width = width;
    for (const plot of this.plots) plot.destroy();
    this.element.replaceChildren(make("p", { class: "note" }, this.data.note));
    this.plots = this.data.plots.map((plot) => this.plot(plot, width));
  }

  private plot({ title, curves }: CurvePlot, width: number): uPlot {
    const style = getComputedStyle(this.element);
    const ink = style.getPropertyValue("--ink");
    const line = style.getPropertyValue("--line");
    const palette = style.getPropertyValue("--dark").trim() === "1" ? darkStrokes : strokes;
    const box = make("figure", { role: "img", "aria-label": `${title} over the movement: ${curves.map((c) => c.label).join(", ")}` });
    const keys = curves.map((curve, i) => {
      const key = make("span", { class: `key key-${i % 3}` });
      key.style.borderColor = palette[i % 3] ?? ink;
      return make("span", {}, key, curve.label);
    });
    box.append(make("figcaption", {}, make("strong", {}, title), ...keys));
    this.element.append(box);
    const x = this.data?.x ?? [];
    const rem = parseFloat(getComputedStyle(document.documentElement).fontSize);
    const axis = { stroke: ink, grid: { stroke: line, width: 1 }, ticks: { stroke: line }, font: `${0.8 * rem}px system-ui` };
    const banded = curves.map((curve, i) => ({ curve, colour: palette[i % 3] ?? ink })).filter(({ curve }) => curve.band);
    const data = aligned(x, curves.map((curve) => curve.values), banded.flatMap(({ curve }) => curve.band ?? []));
    return new uPlot(
      {
        width,
        height: 6.4 * rem,
        cursor: { points: { show: false }, drag: { x: false, y: false } },
        scales: { x: { time: false }, y: { range: (_, low, high) => shownRange(low, high) } },
        axes: [{ ...axis, size: 1.9 * rem }, { ...axis, size: 2.9 * rem, space: 1.3 * rem }],
        legend: { show: false },
        series: [
          { label: "frame" },
          ...curves.map((curve, i) => ({
            label: curve.label,
            stroke: palette[i % 3] ?? ink,
            dash: dashes[i % 3] ?? [],
            width: 2,
            points: { show: true, size: 5 },
          })),
          ...banded.flatMap(({ colour }) => [0, 1].map(() => ({ stroke: `${colour}88`, width: 1, points: { show: false } }))),
        ],
        bands: banded.map(({ colour }, i): uPlot.Band => ({ series: [curves.length + 2 * i + 2, curves.length + 2 * i + 1], fill: `${colour}30` })),
        hooks: {
          drawClear: [(u) => this.shade(u, line)],
          draw: [(u) => this.mark(u, ink)],
          ready: [(u) => u.over.addEventListener("click", () => u.cursor.left !== undefined && this.onChoose(nearestIndex(x, u.posToVal(u.cursor.left, "x"))))],
        },
      },
      data,
      box,
    );
  }

  private shade(u: uPlot, colour: string): void {
    const { x = [], lacking = [] } = this.data ?? {};
    u.ctx.save();
    u.ctx.fillStyle = colour;
    lacking.forEach((isLacking, i) => {
      if (!isLacking) return;
      const from = u.valToPos(((x[i - 1] ?? x[i] ?? 0) + (x[i] ?? 0)) / 2, "x", true);
      const to = u.valToPos(((x[i + 1] ?? x[i] ?? 0) + (x[i] ?? 0)) / 2, "x", true);
      u.ctx.globalAlpha = 0.5;
      u.ctx.fillRect(from, u.bbox.top, to - from, u.bbox.height);
    });
    u.ctx.restore();
  }

  private mark(u: uPlot, colour: string): void {
    const at = u.valToPos(this.data?.x[this.current] ?? 0, "x", true);
    u.ctx.save();
    u.ctx.strokeStyle = colour;
    u.ctx.lineWidth = 1.5 * devicePixelRatio;
    u.ctx.beginPath();
    u.ctx.moveTo(at, u.bbox.top);
    u.ctx.lineTo(at, u.bbox.top + u.bbox.height);
    u.ctx.stroke();
    u.ctx.restore();
  }
}
