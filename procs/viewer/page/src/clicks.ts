/** Tells clicks and taps from the beginnings of drags. */

const kClickMove = 6; // [px]

/** Calls the handler with the place of each click [CSS px of the window]. */
export function listenForClicks(canvas: HTMLCanvasElement, onClick: (x: number, y: number) => void): void {
  let down: PointerEvent | null = null;
  canvas.addEventListener("pointerdown", (event) => (down = event.isPrimary && event.button === 0 ? event : null));
  canvas.addEventListener("pointerup", (event) => {
    const moved = down ? Math.hypot(event.clientX - down.clientX, event.clientY - down.clientY) : Infinity;
    down = null;
    if (moved <= kClickMove) onClick(event.clientX, event.clientY);
  });
}
