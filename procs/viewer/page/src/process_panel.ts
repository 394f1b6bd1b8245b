/** The panel of processes: a table, all that the chosen one says, and its stage times over time. */
import { bytesText, count, el, setText } from "./dom";
import { memoryTable } from "./memory_table";
import { isStale, lostCount, mainRate, slowestStage, stagesOf, stateText, waitingCount, type Stage } from "./process_summary";
import type { Process } from "./protocol";
import { TimingHistory, TimingsChart } from "./timings_chart";

const kColumns = ["Process", "State", "Rate/s", "p50/p95 ms", "Queue", "Lost", "Age"];
const kStageColumns = ["Stage", "p50", "p95", "Median", "Longest"];
const kTitles = ["", "of the last minute", "of the last minute", "of the last second", "of the last second"];

function cells(process: Process): string[] {
  const rate = mainRate(process);
  const stage = slowestStage(process);
  return [
    stateText(process),
    rate ? rate.rate.toFixed(1) : "",
    stage ? shareText(stage) : "",
    count(waitingCount(process)),
    count(lostCount(process)),
    `${process.age.toFixed(0)} s`,
  ];
}

/** p50 and p95 of a stage; of a process of an earlier version, which tells neither, median and longest. */
function shareText(stage: Stage): string {
  if (stage.p50 !== null && stage.p95 !== null) return `${stage.p50.toFixed(0)}/${stage.p95.toFixed(0)}`;
  return stage.median === null || stage.max === null ? "" : `${stage.median.toFixed(0)}/max ${stage.max.toFixed(0)}`;
}

/** How long each stage of a process takes [ms]. */
function stageTable(process: Process): HTMLElement[] {
  const stages = stagesOf(process);
  if (stages.length === 0) return [];
  const text = (ms: number | null): string => (ms === null ? "" : ms.toFixed(1));
  const head = el("tr", {}, ...kStageColumns.map((title, i) => el("th", { scope: "col", title: kTitles[i] }, title)));
  const rows = stages.map(({ name, p50, p95, median, max }) =>
    el("tr", {}, el("th", { scope: "row" }, name), ...[p50, p95, median, max].map((ms) => el("td", {}, text(ms)))),
  );
  return [el("h2", {}, `Stages of ${process.source} [ms]`), el("table", { class: "stages", "aria-label": "Stages" }, el("thead", {}, head), el("tbody", {}, ...rows))];
}

/** The latest problem, or what the process waits for. */
function words(process: Process): string {
  return [process.message, ...process.findings].filter((text) => text !== "").join("\n");
}

class ProcessRow {
  readonly row = el("tr");
  readonly notes = el("tr", { class: "words" });
  private readonly button = el("button", { type: "button", class: "name" });
  private readonly text = el("td", { colspan: kColumns.length });

  constructor(onSelect: () => void) {
    this.button.addEventListener("click", onSelect);
    this.row.append(el("th", { scope: "row" }, this.button), ...kColumns.slice(1).map(() => el("td")));
    this.notes.append(this.text);
  }

  show(process: Process, chosen: boolean): void {
    setText(this.button, process.source);
    this.button.title = `${process.process} ${process.version} on ${process.host}`;
    this.button.setAttribute("aria-pressed", String(chosen));
    cells(process).forEach((text, i) => setText(this.row.cells[i + 1]!, text));
    this.row.classList.toggle("stale", isStale(process));
    this.row.toggleAttribute("data-chosen", chosen);
    setText(this.text, words(process));
    this.notes.hidden = words(process) === "";
  }
}

export class ProcessPanel {
  private readonly rows = new Map<string, ProcessRow>();
  private readonly histories = new Map<string, TimingHistory>();
  private readonly body = el("tbody");
  private readonly details = el("div");
  private readonly chart = new TimingsChart();
  private readonly memory = el("div");
  private processes: Process[] = [];
  private chosen = "";
  private start = 0;
  private shownMemory = "";

  constructor(private readonly parent: HTMLElement) {
    const head = el("thead", {}, el("tr", {}, ...kColumns.map((title) => el("th", { scope: "col" }, title))));
    const table = el("table", { "aria-label": "Processes" }, head, this.body);
    parent.append(el("div", { class: "scroll" }, table), this.chart.element, this.details, this.memory);
  }

  take(processes: Process[], utime: number): void {
    this.processes = processes;
    this.start ||= utime;
    for (const process of processes) this.historyOf(process.source).add(Math.round((utime - this.start) / 1e6), process);
    if (!processes.some((process) => process.source === this.chosen)) {
      this.chosen = processes.find((process) => Object.keys(process.timings).length > 0)?.source ?? "";
    }
    this.refresh();
  }

  /** Memory of the map, by layer [bytes]. */
  setMemory(bytes: Record<string, number>): void {
    const told = JSON.stringify(bytes);
    if (told === this.shownMemory) return;
    this.shownMemory = told;
    this.memory.replaceChildren(...memoryTable(bytes));
  }

  /** Draws again; does nothing while the panel is hidden. */
  refresh(): void {
    if (this.parent.hidden) return;
    const sorted = [...this.processes].sort((a, b) => a.source.localeCompare(b.source));
    sorted.forEach((process, i) => {
      const row = this.rowOf(process.source);
      row.show(process, process.source === this.chosen);
      if (this.body.children[2 * i] !== row.row) this.body.insertBefore(row.row, this.body.children[2 * i] ?? null);
      if (row.row.nextSibling !== row.notes) row.row.after(row.notes);
    });
    this.dropRows(new Set(sorted.map((process) => process.source)));
    this.showChosen();
  }

  private showChosen(): void {
    const process = this.processes.find((candidate) => candidate.source === this.chosen);
    const history = this.histories.get(this.chosen);
    this.chart.element.hidden = !history || history.stages.size === 0;
    if (!process || !history) return;
    if (history.stages.size > 0) this.chart.show(process.source, history);
    const told = Object.entries(process.counters).filter(([name]) => !name.startsWith("memory.")); // the table has those
    const counters = told.flatMap(([name, value]) => {
      const rate = process.rates[name];
      const text = name.endsWith("bytes") ? bytesText(value) : count(value);
      return [el("dt", {}, name.replaceAll("_", " ")), el("dd", {}, rate ? `${text} (${rate.toFixed(1)} per second)` : text)];
    });
    this.details.replaceChildren(...stageTable(process), el("h2", {}, `Counters of ${process.source}`), el("dl", {}, ...counters));
  }

  private rowOf(source: string): ProcessRow {
    let row = this.rows.get(source);
    if (!row) {
      row = new ProcessRow(() => {
        this.chosen = source;
        this.refresh();
      });
      this.rows.set(source, row);
    }
    return row;
  }

  private historyOf(source: string): TimingHistory {
    const history = this.histories.get(source) ?? new TimingHistory();
    this.histories.set(source, history);
    return history;
  }

  private dropRows(kept: Set<string>): void {
    for (const [source, row] of this.rows) {
      if (kept.has(source)) continue;
      row.row.remove();
      row.notes.remove();
      this.rows.delete(source);
    }
  }
}
