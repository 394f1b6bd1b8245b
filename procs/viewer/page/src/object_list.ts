/** The list of objects: one table for each group, sorted by any column, filtered by a text. */
import { colourOfId, css, kStructure, paleColourOfId, type Rgb } from "./colours";
import { count, el, setText } from "./dom";
import { ageText, matches, sizeText, type Group, type MapObject } from "./objects";

const kGroups: { group: Group; title: string; open: boolean }[] = [
  { group: "named", title: "Objects", open: true },
  { group: "discovered", title: "Discovered things", open: true },
  { group: "structure", title: "Structure", open: false },
  { group: "removed", title: "Removed", open: false },
];

interface Column {
  title: string;
  cell(object: MapObject, now: number): string;
  order(object: MapObject): number | string;
}

const kName: Column = { title: "Name", cell: (o) => o.name, order: (o) => `${o.name} ${o.id.padStart(12, "0")}` };
const kColumns: Column[] = [
  { title: "Prob.", cell: (o) => (o.instance > 0 ? `${Math.round(100 * o.score)} %` : ""), order: (o) => -o.score },
  { title: "Size [m]", cell: (o) => sizeText(o.box), order: (o) => -(o.box ? Math.max(...o.box.size) : 0) },
  { title: "Frames", cell: (o) => count(o.frames), order: (o) => -o.frames },
  { title: "Seen", cell: (o, now) => ageText(o.lastUtime, now), order: (o) => -o.lastUtime },
];

const kMostRows = 400;

export function colourOfObject(object: MapObject): Rgb {
  if (object.instance > 0) return colourOfId(object.instance);
  return object.group === "structure" ? kStructure : paleColourOfId(object.segments[0] ?? 0);
}

class GroupTable {
  readonly element: HTMLDetailsElement;
  private readonly title = el("summary");
  private readonly body = el("tbody");
  private readonly rest = el("p", { class: "faint" });
  private readonly heads: HTMLElement[];
  private readonly rows = new Map<string, HTMLTableRowElement>();

  constructor(
    private readonly name: string,
    open: boolean,
    private readonly onSelect: (id: string) => void,
    onSort: (column: Column) => void,
  ) {
    this.heads = [kName, ...kColumns].map((column) => {
      const button = el("button", { type: "button" }, column.title);
      button.addEventListener("click", () => onSort(column));
      return el("th", { scope: "col" }, button);
    });
    const table = el("table", { "aria-label": `${name}; seen: how long before the newest frame` }, el("thead", {}, el("tr", {}, ...this.heads)), this.body);
    this.element = el("details", { class: "group", open }, this.title, el("div", { class: "scroll" }, table), this.rest);
  }

  show(objects: MapObject[], sorted: Column, now: number, selected: string | null): void {
    this.element.hidden = objects.length === 0;
    setText(this.title, `${this.name} (${objects.length})`);
    [kName, ...kColumns].forEach((column, i) => {
      if (column === sorted) this.heads[i]!.setAttribute("aria-sort", "ascending");
      else this.heads[i]!.removeAttribute("aria-sort");
    });
    const shown = objects.slice(0, kMostRows);
    setText(this.rest, shown.length < objects.length ? `${objects.length - shown.length} more; filter to see them.` : "");
    const wanted = shown.map((object) => this.rowOf(object, now, selected));
    this.dropRows(new Set(shown.map((object) => object.id)));
    wanted.forEach((row, i) => {
      if (this.body.children[i] !== row) this.body.insertBefore(row, this.body.children[i] ?? null);
    });
  }

  private rowOf(object: MapObject, now: number, selected: string | null): HTMLTableRowElement {
    let row = this.rows.get(object.id);
    if (!row) {
      row = this.makeRow(object);
      this.rows.set(object.id, row);
    }
    const button = row.querySelector("button")!;
    setText(button.lastElementChild!, `${object.name} ${object.id}`);
    kColumns.forEach((column, i) => setText(row.cells[i + 1]!, column.cell(object, now)));
    const chosen = object.id === selected;
    row.toggleAttribute("data-chosen", chosen);
    button.setAttribute("aria-pressed", String(chosen));
    return row;
  }

  private makeRow(object: MapObject): HTMLTableRowElement {
    const swatch = el("span", { class: "swatch", "aria-hidden": "true" });
    swatch.style.background = css(colourOfObject(object));
    const button = el("button", { type: "button", class: "name", "data-id": object.id }, swatch, el("span"));
    button.addEventListener("click", () => this.onSelect(object.id));
    const head = el("th", { scope: "row" }, button);
    return el("tr", {}, head, ...kColumns.map(() => el("td")));
  }

  private dropRows(kept: Set<string>): void {
    for (const [id, row] of this.rows) {
      if (kept.has(id)) continue;
      row.remove();
      this.rows.delete(id);
    }
  }
}

export class ObjectList {
  private readonly tables: Map<Group, GroupTable>;
  private objects: MapObject[] = [];
  private now = 0;
  private sorted: Column = kName;
  private selected: string | null = null;

  constructor(
    parent: HTMLElement,
    private readonly filter: HTMLInputElement,
    private readonly found: HTMLElement,
    onSelect: (id: string) => void,
  ) {
    const sort = (column: Column): void => {
      this.sorted = column;
      this.refresh();
    };
    this.tables = new Map(kGroups.map(({ group, title, open }) => [group, new GroupTable(title, open, onSelect, sort)]));
    parent.append(...[...this.tables.values()].map((table) => table.element));
    filter.addEventListener("input", () => this.refresh());
    this.refresh();
  }

  set(objects: MapObject[], now: number): void {
    this.objects = objects;
    this.now = now;
    this.refresh();
  }

  select(id: string | null): void {
    this.selected = id;
    this.refresh();
    const object = this.objects.find((candidate) => candidate.id === id);
    const table = object && this.tables.get(object.group);
    if (!table) return;
    table.element.open = true;
    table.element.querySelector("tr[data-chosen]")?.scrollIntoView({ block: "nearest" });
  }

  /** The ids in the order in which the list shows them. */
  shownIds(): string[] {
    return kGroups.flatMap(({ group }) => this.shown(group).map((object) => object.id));
  }

  private shown(group: Group): MapObject[] {
    const text = this.filter.value.trim();
    const chosen = this.objects.filter((object) => object.group === group && (text === "" || matches(object, text)));
    const key = this.sorted.order;
    return chosen.sort((a, b) => {
      const [x, y] = [key(a), key(b)];
      return x < y ? -1 : x > y ? 1 : 0;
    });
  }

  private refresh(): void {
    let total = 0;
    for (const { group } of kGroups) {
      const objects = this.shown(group);
      total += objects.length;
      this.tables.get(group)!.show(objects, this.sorted, this.now, this.selected);
    }
    const all = this.objects.length;
    if (all === 0) setText(this.found, "no objects yet");
    else setText(this.found, this.filter.value.trim() === "" ? "" : `${total} of ${all}`);
  }
}
