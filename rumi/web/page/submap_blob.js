// SPDX-License-Identifier: BSD-3-Clause
// Reads what rumi/web/submap_blob.h writes. Nothing is copied: the arrays lie in the buffer.

const MARK = 0x314d5352; // "RSM1"

export function readSubmap(buffer) {
  const head = new Uint32Array(buffer, 0, 8);
  if (head[0] !== MARK) throw new Error('this is no submap');
  const [, path, keyframes, landmarks, pairs] = head;
  let at = 32;
  const take = (Type, n) => {
    const array = new Type(buffer, at, n);
    at += array.byteLength;
    return array;
  };
  return {
    times: take(Float64Array, path), // seconds since the epoch
    path: take(Float32Array, 3 * path),
    keyframes: take(Float32Array, 7 * keyframes), // x, y, z, then the rotation w, x, y, z
    landmarks: take(Float32Array, 3 * landmarks),
    pairs: take(Uint32Array, 2 * pairs),
  };
}
