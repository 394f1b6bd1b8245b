/** The surface in a report of vismap-map: bytes and header as libs/pictures/web_mesh.h describes them. */
import { colourOfId, kStructure, kUnknown, paleColourOfId, ramp, type Rgb } from "./colours";
import { asList, asNumber, asObject, asText, asVector } from "./json";

export interface ReportObject {
  id: string;
  name: string;
  instance: number; // 0 = none
  classId: number;
  structure: boolean;
}

export interface ReportMesh {
  positions: Float32Array; // x, y, z [m] in W
  colours: Uint8Array; // r, g, b
  owners: Uint16Array; // index into objects; kNoOwner = none
  corners: Uint32Array;
  up: [number, number, number];
  coloured: boolean;
  objects: ReportObject[];
}

export const kNoOwner = 65535;
export type ReportColouring = "instance" | "class" | "rgb" | "height";

/** Decodes the two texts of the page; throws an Error with a sentence when they do not fit. */
export function decodeReport(aboutText: string, surface: string): ReportMesh {
  const about = asObject(JSON.parse(aboutText));
  const [n, m] = [asNumber(about.vertices), asNumber(about.triangles)];
  const low = asVector(about.low, 3) ?? [0, 0, 0];
  const high = asVector(about.high, 3) ?? [1, 1, 1];
  const bytes = Uint8Array.from(atob(surface), (letter) => letter.charCodeAt(0));
  const ownersAt = 6 * n + 3 * n + ((3 * n) % 2);
  const cornersAt = Math.ceil((ownersAt + 2 * n) / 4) * 4;
  if (bytes.length !== cornersAt + 12 * m) throw new Error(`The surface has ${bytes.length} bytes instead of ${cornersAt + 12 * m}.`);
  const steps = new Uint16Array(bytes.buffer, 0, 3 * n);
  const positions = Float32Array.from(steps, (step, i) => low[i % 3]! + (step / 65535) * (high[i % 3]! - low[i % 3]!));
  const up = asVector(about.up, 3) ?? [0, 0, 1];
  return {
    positions,
    colours: new Uint8Array(bytes.buffer, 6 * n, 3 * n),
    owners: new Uint16Array(bytes.buffer, ownersAt, n),
    corners: new Uint32Array(bytes.buffer, cornersAt, 3 * m),
    up: [up[0]!, up[1]!, up[2]!],
    coloured: about.colored === true,
    objects: asList(about.objects).map((entry) => {
      const object = asObject(entry);
      return {
        id: asText(object.id),
        name: asText(object.name),
        instance: asNumber(object.instance),
        classId: asNumber(object.class),
        structure: object.structure === true,
      };
    }),
  };
}

function colourOfOwner(object: ReportObject | undefined, colouring: ReportColouring): Rgb {
  if (!object) return kUnknown;
  if (object.structure) return kStructure;
  if (colouring === "class") return object.classId > 0 ? colourOfId(object.classId) : kUnknown;
  return object.instance > 0 ? colourOfId(object.instance) : paleColourOfId(Number(object.id.slice(1)));
}

/** r, g, b of each vertex, 0 to 1; the chosen object (index, or -1) stands out. */
export function paintReport(mesh: ReportMesh, colouring: ReportColouring, chosen: number): Float32Array {
  const n = mesh.owners.length;
  const painted = new Float32Array(3 * n);
  const heights = colouring === "height" ? heightsOf(mesh) : null;
  const ofOwner = mesh.objects.map((object) => colourOfOwner(object, colouring));
  for (let v = 0; v < n; ++v) {
    const owner = mesh.owners[v]!;
    let colour: Rgb;
    if (colouring === "rgb") colour = [mesh.colours[3 * v]!, mesh.colours[3 * v + 1]!, mesh.colours[3 * v + 2]!];
    else if (heights) colour = ramp(heights[v]!);
    else colour = ofOwner[owner] ?? kUnknown;
    const shade = chosen < 0 || owner === chosen ? 1 : 0.6;
    for (let c = 0; c < 3; ++c) painted[3 * v + c] = (colour[c]! / 255) * shade;
  }
  return painted;
}

/** Of each vertex, from 0 for the lowest to 1 for the highest, but 1 % of them at each end. */
function heightsOf(mesh: ReportMesh): Float32Array {
  const [x, y, z] = mesh.up;
  const p = mesh.positions;
  const heights = Float32Array.from({ length: p.length / 3 }, (_, v) => x * p[3 * v]! + y * p[3 * v + 1]! + z * p[3 * v + 2]!);
  const sorted = Float32Array.from(heights).sort();
  const cut = Math.floor(sorted.length / 100);
  const low = sorted[cut] ?? 0;
  const span = Math.max((sorted[sorted.length - 1 - cut] ?? 1) - low, 0.01);
  return heights.map((height) => (height - low) / span);
}
