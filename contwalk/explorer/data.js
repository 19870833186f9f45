// What stands in the page: a block is a header of JSON and the bytes of small whole numbers.
const blocks = new Map();

function block(name) {
  if (blocks.has(name)) return blocks.get(name);
  let found = null;
  for (const element of document.querySelectorAll("script[data-block]"))
    if (element.dataset.block === name) {
      const bytes = inflated(bytesOf(element.textContent));
      const length = new DataView(bytes.buffer, bytes.byteOffset).getUint32(0, true);
      found = { header: JSON.parse(new TextDecoder().decode(bytes.subarray(4, 4 + length))),
        body: bytes.subarray(4 + length) };
    }
  blocks.set(name, found);
  return found;
}

// Reads tables of whole numbers: each entry is told by what it differs from the ones before it.
class Numbers {
  constructor(bytes) { this.bytes = bytes; this.at = 0; }
  next() {
    let value = 0, scale = 1, byte;
    do {
      byte = this.bytes[this.at++];
      value += (byte & 127) * scale;
      scale *= 128;
    } while (byte > 127);
    return value % 2 ? -(value + 1) / 2 : value / 2;
  }
  table(rows, columns, before) {
    const found = new Int32Array(rows * columns), earlier = before ? before.length : 0;
    for (let k = 0; k < found.length; k++) {
      let value = this.next() + (k < columns ? 0 : found[k - columns]);
      if (k < earlier) value += before[k] - (k < columns ? 0 : before[k - columns]);
      found[k] = value;
    }
    return found;
  }
}

const motionsOf = new Map();

// The motions of a branch by row: times, states, events, and pictures of the machine.
function motions(branch) {
  if (motionsOf.has(branch)) return motionsOf.get(branch);
  const data = block(`motions ${branch}`), found = new Map();
  motionsOf.set(branch, found);
  if (!data) return found;
  const { header } = data, numbers = new Numbers(data.body), count = header.states.length;
  let before = null;
  header.rows.forEach((row, k) => {
    const size = header.counts[k], table = numbers.table(size, count + 1, before);
    before = table;
    const period = header.periods[k], times = new Float64Array(size);
    const states = header.states.map(() => new Float64Array(size));
    for (let i = 0; i < size; i++) {
      times[i] = period * table[i * (count + 1)] / header.levels.time;
      for (let s = 0; s < count; s++) {
        const low = header.low[k][s], high = header.high[k][s];
        states[s][i] = low + (high - low) * table[i * (count + 1) + 1 + s] / header.levels.state;
      }
    }
    found.set(row, { period, times, states, names: header.states, events: header.events[k] });
  });
  if (header.machine) pictures(header, numbers, found);
  return found;
}

function pictures(header, numbers, found) {
  const { machine } = header;
  let before = new Map();
  machine.tracks.forEach((tracks, row) => {
    const own = new Map(), shown = [];
    for (const [key, first, width, count] of tracks) {
      const earlier = before.get(key);
      const alike = earlier && earlier.first === first && earlier.width === width;
      const track = { key, first, width, count, values: numbers.table(count, width, alike ? earlier.values : null) };
      if (!own.has(key)) own.set(key, track);
      shown.push(track);
    }
    before = own;
    if (!shown.length) return;
    const motion = found.get(row) || { period: 0, times: [], states: [], names: header.states, events: [] };
    motion.pictures = { tracks: shown, height: machine.heights[row], machine,
      times: header.frames[row].map(time => motion.period * time / header.levels.time) };
    found.set(row, motion);
  });
}
