/** Exact numbers: quotients of integers, doubles as quotients, rounding, and IEEE 754 bit patterns. */

const VIEW = /* @__PURE__ */ new DataView(/* @__PURE__ */ new ArrayBuffer(8));
const NUMBER = /^\s*([+-]?)(\d+)(?:\.(\d*))?(?:[eE]([+-]?\d{1,3}))?(?:\/(\d+))?\s*$/;

/** The quotient `[numerator, denominator]` in lowest terms of an integer, or of a text such as `3.5`, `1e-7` or `1/3`; null for another text. */
export function rational(value) {
  if (typeof value === "bigint" || Number.isSafeInteger(value)) {
    return [BigInt(value), 1n];
  }
  const match = NUMBER.exec(String(value));
  if (!match) {
    return null;
  }
  const [, sign, whole, decimals = "", exponent = "0", divisor = "1"] = match;
  const shift = BigInt(Number(exponent) - decimals.length);
  const digits = BigInt(whole + decimals) * (sign === "-" ? -1n : 1n);
  const denominator = BigInt(divisor) * (shift < 0n ? 10n ** -shift : 1n);
  return denominator === 0n ? null : reduced(digits * (shift > 0n ? 10n ** shift : 1n), denominator);
}

function reduced(numerator, denominator) {
  let [divisor, rest] = [denominator, numerator % denominator];
  while (rest !== 0n) {
    [divisor, rest] = [rest, divisor % rest];
  }
  const size = divisor < 0n ? -divisor : divisor;
  return [numerator / size, denominator / size];
}

/** An integer or a finite double as an exact quotient. */
export function ratio(number) {
  if (typeof number === "bigint" || Number.isInteger(number)) {
    return [BigInt(number), 1n];
  }
  VIEW.setFloat64(0, number);
  const high = VIEW.getUint32(0);
  const biased = (high >>> 20) & 0x7ff;
  const fraction = (BigInt(high & 0xfffff) << 32n) | BigInt(VIEW.getUint32(4));
  const digits = biased ? fraction | (1n << 52n) : fraction;
  return [high >>> 31 ? -digits : digits, 1n << BigInt(1075 - Math.max(biased, 1))];
}

/** The double nearest to a quotient, ties to even; infinite if it exceeds the largest double. */
export function quotient(numerator, denominator) {
  if (numerator === 0n) {
    return 0;
  }
  const isNegative = numerator < 0n !== denominator < 0n;
  const above = numerator < 0n ? -numerator : numerator;
  const below = denominator < 0n ? -denominator : denominator;
  // 64 significant bits, or all bits down to the least significant one of a double
  const shift = Math.min(64 - (bitLength(above) - bitLength(below)), 1074);
  const scaled = shift < 0 ? above : above << BigInt(shift);
  const divisor = shift < 0 ? below << BigInt(-shift) : below;
  let digits = scaled / divisor;
  const rest = scaled % divisor;
  if (digits >> 54n) {
    digits |= rest ? 1n : 0n; // the conversion to a double rounds these digits
  } else if (2n * rest > divisor || (2n * rest === divisor && digits & 1n)) {
    digits += 1n;
  }
  const size = Number(digits) * 2 ** -shift;
  return isNegative ? -size : size;
}

function bitLength(positive) {
  return positive.toString(16).length * 4;
}

/** The integer nearest to a quotient, ties away from zero. */
export function nearest(numerator, denominator) {
  const above = numerator < 0n ? -numerator : numerator;
  const below = denominator < 0n ? -denominator : denominator;
  const size = (2n * above + below) / (2n * below);
  return numerator < 0n === denominator < 0n ? size : -size;
}

/** The integer nearest to a double below 2^52, ties away from zero. */
export function rounded(number) {
  const whole = Math.trunc(number);
  return (Math.abs(number - whole) >= 0.5 ? whole + Math.sign(number) : whole) + 0;
}

/** -1, 0 or 1, as the first quotient is less than, equal to or greater than the second. */
export function compare([numerator, denominator], [factor, divisor]) {
  const difference = numerator * divisor - factor * denominator;
  return difference < 0n ? -1 : difference > 0n ? 1 : 0;
}

/** The largest integer that is not greater than a quotient with a positive denominator. */
export function floor([numerator, denominator]) {
  const whole = numerator / denominator;
  return numerator % denominator < 0n ? whole - 1n : whole;
}

/** The smallest integer that is not less than a quotient with a positive denominator. */
export function ceil([numerator, denominator]) {
  return -floor([-numerator, denominator]);
}

/** The number of an IEEE 754 bit pattern: 32 bits as a number, 64 bits as a BigInt. */
export function floatOf(width, bits) {
  if (width === 32) {
    VIEW.setUint32(0, bits);
    return VIEW.getFloat32(0);
  }
  VIEW.setBigUint64(0, bits);
  return VIEW.getFloat64(0);
}

/** The double next to a quotient whose last bit is odd, unless a double is exact: rounded to 32 bits, it is rounded once. */
export function toOdd(numerator, denominator) {
  const number = quotient(numerator, denominator);
  if (!Number.isFinite(number) || number === 0) {
    return number;
  }
  const order = compare([numerator, denominator], ratio(number)) * Math.sign(number);
  VIEW.setFloat64(0, number);
  const bits = VIEW.getBigUint64(0);
  VIEW.setBigUint64(0, order !== 0 && bits % 2n === 0n ? bits + BigInt(order) : bits);
  return VIEW.getFloat64(0);
}

/** The bit pattern of the float nearest to a number; null if it is infinite. */
export function floatBits(width, number) {
  if (!Number.isFinite(width === 32 ? Math.fround(number) : number)) {
    return null;
  }
  if (width === 32) {
    VIEW.setFloat32(0, number);
    return VIEW.getUint32(0);
  }
  VIEW.setFloat64(0, number);
  return VIEW.getBigUint64(0);
}
