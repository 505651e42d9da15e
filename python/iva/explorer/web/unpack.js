// What the page unpacks before all else: bytes in base 85, as Python writes them, of a file in the format .lzma.

/** The bytes that a text holds: five of its signs are four bytes. Of Python's signs `/` stands for `<`, which ends elements. */
function bytesOf(text) {
  const signs = "0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz!#$%&()*+-;/=>?@^_`{|}~";
  const value = new Uint8Array(128);
  for (let index = 0; index < signs.length; index += 1) value[signs.charCodeAt(index)] = index;
  const padding = (5 - (text.length % 5)) % 5;
  const whole = new DataView(new ArrayBuffer((4 * (text.length + padding)) / 5));
  for (let from = 0, to = 0; from < text.length; from += 5, to += 4) {
    let word = 0;
    for (let index = from; index < from + 5; index += 1) word = 85 * word + (index < text.length ? value[text.charCodeAt(index)] : 84);
    whole.setUint32(to, word);
  }
  return new Uint8Array(whole.buffer, 0, whole.byteLength - padding);
}

/**
 * The content of a file in the format .lzma with an end marker (I. Pavlov, LZMA specification): literals and copies of what came
 * before, coded bit by bit in a range that each bit's probability so far divides.
 */
function unpacked(input) {
  let output = new Uint8Array(1 << 22);
  let [length, at, code, range] = [0, 14, 0, -1 >>> 0];
  const [lc, lp, pb] = [input[0] % 9, Math.floor(input[0] / 9) % 5, Math.floor(input[0] / 45)];
  for (let index = 0; index < 4; index += 1) code = ((code << 8) | input[at++]) >>> 0;
  const even = (count) => new Uint16Array(count).fill(1024);
  const renew = () => {
    if (range >= 1 << 24) return;
    range = (range << 8) >>> 0;
    code = ((code << 8) | input[at++]) >>> 0;
  };
  const bit = (odds, index) => {
    const bound = (range >>> 11) * odds[index];
    const one = code >= bound;
    if (one) {
      range -= bound;
      code -= bound;
      odds[index] -= odds[index] >> 5;
    } else {
      range = bound;
      odds[index] += (2048 - odds[index]) >> 5;
    }
    renew();
    return Number(one);
  };
  /** Bits of a number, the highest first. */
  const tree = (odds, bits, from = 0) => {
    let node = 1;
    for (let index = 0; index < bits; index += 1) node = 2 * node + bit(odds, from + node);
    return node - (1 << bits);
  };
  /** The same, the lowest first. */
  const reversed = (odds, bits, from = 0) => {
    let [node, value] = [1, 0];
    for (let index = 0; index < bits; index += 1) {
      const one = bit(odds, from + node);
      node = 2 * node + one;
      value += one << index;
    }
    return value;
  };
  const lengths = () => ({ choice: even(2), low: even(8 << pb), middle: even(8 << pb), high: even(256) });
  const lengthBy = ({ choice, low, middle, high }, place) => {
    if (!bit(choice, 0)) return 2 + tree(low, 3, 8 * place);
    return bit(choice, 1) ? 18 + tree(high, 8) : 10 + tree(middle, 3, 8 * place);
  };
  const literals = even(0x300 << (lc + lp));
  const [isCopy, isRepeat, notFirst, notSecond, notThird, isLong] = [even(192), even(12), even(12), even(12), even(12), even(192)];
  const [slots, special, aligned, ofCopy, ofRepeat] = [even(256), even(128), even(16), lengths(), lengths()];
  let [state, ...back] = [0, 0, 0, 0, 0];
  const put = (byte) => {
    if (length === output.length) {
      const larger = new Uint8Array(2 * length);
      larger.set(output);
      output = larger;
    }
    output[length++] = byte;
  };
  for (;;) {
    const place = length & ((1 << pb) - 1);
    if (!bit(isCopy, 16 * state + place)) {
      const before = length ? output[length - 1] : 0;
      const from = 0x300 * (((length & ((1 << lp) - 1)) << lc) + (before >> (8 - lc)));
      let node = 1;
      if (state >= 7) {
        // After a copy the byte that would have gone on with it helps to tell the next, as far as they are the same.
        for (let match = output[length - back[0] - 1], same = true; same && node < 256; match <<= 1) {
          const expected = (match >> 7) & 1;
          const one = bit(literals, from + 256 * (1 + expected) + node);
          node = 2 * node + one;
          same = one === expected;
        }
      }
      while (node < 256) node = 2 * node + bit(literals, from + node);
      put(node & 255);
      state = state < 4 ? 0 : state < 10 ? state - 3 : state - 6;
      continue;
    }
    let count = 0;
    if (bit(isRepeat, state)) {
      let which = 0;
      if (bit(notFirst, state)) which = bit(notSecond, state) ? 2 + bit(notThird, state) : 1;
      else if (!bit(isLong, 16 * state + place)) count = 1;
      back.unshift(...back.splice(which, 1));
      if (count) state = state < 7 ? 9 : 11;
      else {
        count = lengthBy(ofRepeat, place);
        state = state < 7 ? 8 : 11;
      }
    } else {
      count = lengthBy(ofCopy, place);
      state = state < 7 ? 7 : 10;
      const slot = tree(slots, 6, 64 * Math.min(count - 2, 3));
      let distance = slot;
      if (slot >= 4) {
        const bits = (slot >> 1) - 1;
        distance = ((2 | (slot & 1)) << bits) >>> 0;
        if (slot < 14) distance += reversed(special, bits, distance - slot);
        else {
          for (let index = bits - 1; index >= 4; index -= 1) {
            range >>>= 1;
            const one = code >= range;
            if (one) {
              code -= range;
              distance += 2 ** index;
            }
            renew();
          }
          distance += reversed(aligned, 4);
          if (distance === 2 ** 32 - 1) return output.slice(0, length);
        }
      }
      back = [distance, ...back.slice(0, 3)];
    }
    for (; count > 0; count -= 1) put(output[length - back[0] - 1]);
  }
}
