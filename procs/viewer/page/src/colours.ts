/** Colours for ids and for values. All are r, g, b from 0 to 255 as the screen shows them. */

export type Rgb = [number, number, number];

export const kUnknown: Rgb = [150, 150, 150];
export const kStructure: Rgb = [186, 182, 172];

/** Free, occupied and unknown space: colours of Okabe and Ito, which the colour-blind tell apart. */
export const kFree: Rgb = [86, 180, 233];
export const kOccupied: Rgb = [213, 94, 0];
export const kNotSeen: Rgb = [120, 120, 120];

/** Hue in turns, saturation and lightness from 0 to 1. */
export function fromHsl(hue: number, saturation: number, lightness: number): Rgb {
  const chroma = saturation * Math.min(lightness, 1 - lightness);
  const channel = (n: number): number => {
    const k = (n + hue * 12) % 12;
    return Math.round(255 * (lightness - chroma * Math.max(-1, Math.min(k - 3, 9 - k, 1))));
  };
  return [channel(0), channel(8), channel(4)];
}

/** Neighbouring ids get hues far apart: steps of the golden ratio. */
export function colourOfId(id: number): Rgb {
  const lightness = [0.55, 0.42, 0.66][id % 3]!;
  return fromHsl((id * 0.618033988749895 + 0.08) % 1, 0.72, lightness);
}

/** Paler than colourOfId: for things without a class. */
export function paleColourOfId(id: number): Rgb {
  return fromHsl((id * 0.618033988749895 + 0.31) % 1, 0.34, 0.66);
}

// Points of the colour map "cividis", which reads the same for the colour-blind.
const kRamp: Rgb[] = [
  [0, 34, 78],
  [53, 69, 108],
  [102, 105, 112],
  [148, 142, 119],
  [200, 184, 102],
  [254, 232, 56],
];

/** The colour of a value from 0 to 1. */
export function ramp(value: number): Rgb {
  const at = Math.min(1, Math.max(0, value)) * (kRamp.length - 1);
  const left = Math.min(kRamp.length - 2, Math.floor(at));
  const share = at - left;
  const mix = (c: 0 | 1 | 2): number => Math.round(kRamp[left]![c] * (1 - share) + kRamp[left + 1]![c] * share);
  return [mix(0), mix(1), mix(2)];
}

/** How much of the ramp a count of 0 to 255 sightings takes: logarithmic. */
export function shareOfSightings(count: number): number {
  return Math.log2(1 + count) / 8;
}

export function css(colour: Rgb): string {
  return `rgb(${colour.join(" ")})`;
}
