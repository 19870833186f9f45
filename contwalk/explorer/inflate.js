// Data stand in the page as base64 of zlib's format (RFC 1950, 1951); this takes it apart at once, so that
// nothing has to be waited for.
"use strict";

function bytesOf(text) {
  const raw = atob(text.trim());
  const bytes = new Uint8Array(raw.length);
  for (let k = 0; k < raw.length; k++) bytes[k] = raw.charCodeAt(k);
  return bytes;
}

function huffman(lengths) {
  const counts = new Uint16Array(16), offsets = new Uint16Array(16);
  for (const length of lengths) counts[length]++;
  counts[0] = 0;
  for (let k = 1; k < 16; k++) offsets[k] = offsets[k - 1] + counts[k - 1];
  const symbols = new Uint16Array(lengths.length);
  for (let k = 0; k < lengths.length; k++) if (lengths[k]) symbols[offsets[lengths[k]]++] = k;
  return { counts, symbols };
}

const LENGTH_BASE = [3, 4, 5, 6, 7, 8, 9, 10, 11, 13, 15, 17, 19, 23, 27, 31, 35, 43, 51, 59, 67, 83, 99, 115,
  131, 163, 195, 227, 258];
const LENGTH_BITS = [0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3, 4, 4, 4, 4, 5, 5, 5, 5, 0];
const WAY_BASE = [1, 2, 3, 4, 5, 7, 9, 13, 17, 25, 33, 49, 65, 97, 129, 193, 257, 385, 513, 769, 1025, 1537,
  2049, 3073, 4097, 6145, 8193, 12289, 16385, 24577];
const WAY_BITS = [0, 0, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 5, 5, 6, 6, 7, 7, 8, 8, 9, 9, 10, 10, 11, 11, 12, 12, 13,
  13];
const ORDER = [16, 17, 18, 0, 8, 7, 9, 6, 10, 5, 11, 4, 12, 3, 13, 2, 14, 1, 15];

function inflated(source) {
  let at = 2, hold = 0, held = 0, out = new Uint8Array(source.length * 6), size = 0;
  function bits(count) {
    while (held < count) { hold |= source[at++] << held; held += 8; }
    const value = hold & ((1 << count) - 1);
    hold >>>= count;
    held -= count;
    return value;
  }
  function symbol(code) {
    let value = 0, first = 0, index = 0;
    for (let length = 1; length < 16; length++) {
      value |= bits(1);
      const count = code.counts[length];
      if (value - count < first) return code.symbols[index + value - first];
      index += count;
      first = (first + count) << 1;
      value <<= 1;
    }
    throw new Error("The data of this page are damaged.");
  }
  function room(more) {
    if (size + more <= out.length) return;
    const larger = new Uint8Array(Math.max(2 * out.length, size + more));
    larger.set(out);
    out = larger;
  }
  let last = 0;
  while (!last) {
    last = bits(1);
    const kind = bits(2);
    if (kind === 0) {
      hold = held = 0;
      const length = source[at] | source[at + 1] << 8;
      at += 4;
      room(length);
      out.set(source.subarray(at, at + length), size);
      at += length;
      size += length;
      continue;
    }
    let letters, ways;
    if (kind === 1) {
      letters = huffman(Array.from({ length: 288 }, (_, k) => k < 144 ? 8 : k < 256 ? 9 : k < 280 ? 7 : 8));
      ways = huffman(new Array(30).fill(5));
    } else {
      const numbers = [bits(5) + 257, bits(5) + 1, bits(4) + 4], lengths = new Array(19).fill(0);
      for (let k = 0; k < numbers[2]; k++) lengths[ORDER[k]] = bits(3);
      const code = huffman(lengths), all = [];
      while (all.length < numbers[0] + numbers[1]) {
        const value = symbol(code);
        if (value < 16) all.push(value);
        else {
          const again = value === 16 ? all[all.length - 1] : 0;
          let times = value === 16 ? bits(2) + 3 : value === 17 ? bits(3) + 3 : bits(7) + 11;
          while (times--) all.push(again);
        }
      }
      letters = huffman(all.slice(0, numbers[0]));
      ways = huffman(all.slice(numbers[0]));
    }
    for (;;) {
      const value = symbol(letters);
      if (value === 256) break;
      if (value < 256) { room(1); out[size++] = value; continue; }
      const length = LENGTH_BASE[value - 257] + bits(LENGTH_BITS[value - 257]);
      const far = symbol(ways), way = WAY_BASE[far] + bits(WAY_BITS[far]);
      room(length);
      for (let k = 0; k < length; k++, size++) out[size] = out[size - way];
    }
  }
  return out.subarray(0, size);
}
