/**
 * Fills triangles of the plane into a picture, each pixel with the colour of its interpolated value.
 * @param xy      x and y in pixels of every vertex
 * @param corners three vertices a triangle
 * @param shares  place of every vertex in the colour range; NaN takes the last colour
 * @param colours RGBA of shares 0 to 1, then the colour of NaN
 */
export function fillTriangles(pixels: Uint32Array, width: number, xy: Float32Array, corners: ArrayLike<number>, shares: Float32Array, colours: Uint32Array): void {
  const height = pixels.length / width;
  const levels = colours.length - 2;
  const none = colours[levels + 1] as number;
  for (let t = 0; t + 2 < corners.length; t += 3) {
    const a = corners[t] as number;
    const b = corners[t + 1] as number;
    const c = corners[t + 2] as number;
    const ax = xy[2 * a] as number;
    const ay = xy[2 * a + 1] as number;
    const bx = xy[2 * b] as number;
    const by = xy[2 * b + 1] as number;
    const cx = xy[2 * c] as number;
    const cy = xy[2 * c + 1] as number;
    const area = (bx - ax) * (cy - ay) - (cx - ax) * (by - ay);
    if (area === 0) continue;
    const sa = shares[a] as number;
    const sb = shares[b] as number;
    const sc = shares[c] as number;
    const right = Math.min(width - 1, Math.floor(Math.max(ax, bx, cx)));
    const bottom = Math.min(height - 1, Math.floor(Math.max(ay, by, cy)));
    for (let y = Math.max(0, Math.ceil(Math.min(ay, by, cy))); y <= bottom; ++y) {
      for (let x = Math.max(0, Math.ceil(Math.min(ax, bx, cx))); x <= right; ++x) {
        const wb = ((x - ax) * (cy - ay) - (cx - ax) * (y - ay)) / area;
        const wc = ((bx - ax) * (y - ay) - (x - ax) * (by - ay)) / area;
        if (wb < -1e-6 || wc < -1e-6 || wb + wc > 1 + 1e-6) continue;
        const at = (1 - wb - wc) * sa + wb * sb + wc * sc;
        pixels[y * width + x] = at === at ? (colours[Math.round(Math.min(1, Math.max(0, at)) * levels)] as number) : none;
      }
    }
  }
}
