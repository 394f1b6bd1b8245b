/** The selected object: shown in the list, in the card, and in the scene. */
import type { ObjectCard } from "./object_card";
import type { ObjectList } from "./object_list";
import { ObjectIndex, type MapObject } from "./objects";
import { boundsOfBox, type SelectionBox } from "./selection_box";
import type { Surface } from "./surface";
import type { View } from "./view";

export class Selection {
  private index = new ObjectIndex([]);
  private now = 0;
  private chosen: string | null = null;
  private mark = ""; // of what the scene shows as selected

  constructor(
    private readonly view: View,
    private readonly surface: Surface,
    private readonly box: SelectionBox,
    private readonly list: ObjectList,
    private readonly card: ObjectCard,
  ) {}

  get id(): string | null {
    return this.chosen;
  }

  get objects(): MapObject[] {
    return this.index.all;
  }

  /** Takes the objects of a newer map. An object that is gone is no longer selected. */
  setObjects(objects: MapObject[], now: number): void {
    this.index = new ObjectIndex(objects);
    this.now = now;
    const painted = this.surface.setObjects(this.index);
    this.list.set(objects, now);
    const marked = this.chosen !== null && this.show(this.index.get(this.chosen));
    if (painted || marked) this.view.invalidateSoon();
  }

  /** Selects an object, or nothing, and flies to it if wanted. */
  select(id: string | null, fly: boolean): void {
    const object = id === null ? null : this.index.get(id);
    this.show(object);
    this.list.select(this.chosen);
    if (object && fly) this.flyTo(object);
    this.view.invalidate();
  }

  /** Selects what a ray met. */
  selectAt(instance: number, segment: number): void {
    this.select(this.index.at(instance, segment)?.id ?? null, false);
  }

  /** Selects the next (1) or previous (-1) object of the list. */
  step(by: number): void {
    const ids = this.list.shownIds();
    if (ids.length === 0) return;
    const at = this.chosen === null ? (by > 0 ? -1 : 0) : ids.indexOf(this.chosen);
    this.select(ids[(at + by + ids.length) % ids.length]!, true);
  }

  flyToChosen(): void {
    const object = this.chosen === null ? null : this.index.get(this.chosen);
    if (object) this.flyTo(object);
  }

  private flyTo(object: MapObject): void {
    if (object.group === "removed") return;
    const bounds = object.box ? boundsOfBox(object.box) : this.surface.boundsOf(object);
    if (!bounds.isEmpty()) this.view.flyTo(bounds);
  }

  /** Shows an object as the selected one; answers whether the scene looks different then. */
  private show(object: MapObject | null): boolean {
    this.chosen = object?.id ?? null;
    this.card.show(object, this.now);
    const mark = object ? JSON.stringify([object.id, object.group, object.segments, object.box]) : "";
    if (mark === this.mark) return false;
    this.mark = mark;
    this.surface.select(object);
    this.box.show(object?.box ?? null);
    return true;
  }
}
