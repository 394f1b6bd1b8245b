/** Stage times over time: the median of each stage of a process, once a second, over the last minutes. */
import uPlot from "uplot";
import { colourOfId, css } from "./colours";
import { el } from "./dom";
import type { Process } from "./protocol";

const kKept = 300; // seconds
const kHeight = 180; // [px]

/** The history of one process: a row for each second, a column for each stage. */
export class TimingHistory {
  readonly seconds: number[] = [];
  readonly stages = new Map<string, (number | null)[]>();

  add(second: number, process: Process): void {
    if (second <= (this.seconds.at(-1) ?? -Infinity)) return;
    this.seconds.push(second);
    for (const name of Object.keys(process.timings)) {
      if (!this.stages.has(name)) this.stages.set(name, new Array<null>(this.seconds.length - 1).fill(null));
    }
    for (const [name, values] of this.stages) values.push(process.timings[name]?.median ?? null);
    if (this.seconds.length > kKept) {
      this.seconds.shift();
      for (const values of this.stages.values()) values.shift();
    }
  }
}

export class TimingsChart {
  readonly element = el("div", { class: "chart" });
  private plot: uPlot | null = null;
  private drawn = "";

  show(source: string, history: TimingHistory): void {
    const names = [...history.stages.keys()];
    const data: uPlot.AlignedData = [history.seconds, ...history.stages.values()];
    const width = Math.max(200, this.element.clientWidth);
    const kind = `${source} ${width} ${names.join()} ${document.documentElement.dataset.theme ?? ""}`;
    if (this.plot && kind === this.drawn) {
      this.plot.setData(data);
      return;
    }
    this.drawn = kind;
    this.plot?.destroy();
    this.plot = new uPlot(this.options(source, names, width), data, this.element);
  }

  private options(source: string, names: string[], width: number): uPlot.Options {
    const style = getComputedStyle(document.documentElement);
    const stroke = style.getPropertyValue("--faint").trim();
    const grid = { stroke: style.getPropertyValue("--line").trim(), width: 1 };
    return {
      title: `${source}: median of each stage [ms]`,
      width,
      height: kHeight,
      scales: { x: { time: false }, y: { range: (_plot, _low, high) => [0, Math.max(1, high * 1.1)] } },
      axes: [
        { stroke, grid, values: (_plot, ticks) => ticks.map((tick) => `${tick} s`) },
        { stroke, grid, size: 55 },
      ],
      series: [
        { label: "time", value: (_plot, value) => (value == null ? "" : `${value} s`) },
        ...names.map((label, i) => ({ label, stroke: css(colourOfId(i + 1)), width: 1.5, points: { show: false } })),
      ],
    };
  }
}
