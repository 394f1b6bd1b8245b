/** Makes the renderer, and tells whether the processor draws. */
import * as THREE from "three";

/** null when the browser has no WebGL 2. */
export function makeRenderer(canvas: HTMLCanvasElement, antialias: boolean): THREE.WebGLRenderer | null {
  try {
    const renderer = new THREE.WebGLRenderer({ canvas, antialias, powerPreference: "high-performance" });
    renderer.outputColorSpace = THREE.LinearSRGBColorSpace;
    return renderer;
  } catch (error) {
    console.warn(error);
    return null;
  }
}

/** Whether WebGL is computed by the processor here: no antialiasing and fewer pixels then. */
export function isSoftware(canvas: HTMLCanvasElement): boolean {
  const probe = canvas.ownerDocument.createElement("canvas").getContext("webgl2");
  if (!probe) return true;
  const info = probe.getExtension("WEBGL_debug_renderer_info");
  const name = String(probe.getParameter(info ? info.UNMASKED_RENDERER_WEBGL : probe.RENDERER));
  probe.getExtension("WEBGL_lose_context")?.loseContext();
  return /swiftshader|llvmpipe|softpipe|software/i.test(name);
}

/** Waits until the drawing is done, so that drawings do not queue up where the processor draws. */
export function waitForPixels(renderer: THREE.WebGLRenderer | null): void {
  const gl = renderer?.getContext();
  gl?.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
}
