/** Types of fields: the conversion between raw integers and values, with scales and ranges that can depend on parameters. */

import { ceil, compare, floatBits, floatOf, floor, nearest, quotient, ratio, rational, rounded, toOdd } from "./canwright-numbers.js";

/**
 * Why a frame or a value is rejected: `refusal` is the reason, `field` the name of the field that caused it, and `values`
 * are those in the message, for texts in other languages.
 */
export class CodecError extends Error {
  constructor(refusal, message, field, values = []) {
    super(message);
    this.name = "CodecError";
    this.refusal = refusal;
    this.field = field;
    this.values = values;
  }
}

/**
 * The error of a frame that is rejected. It has no stack: a frame of another protocol on the bus is no mistake in a program,
 * and to collect a stack takes longer than to decode a frame. `describe` returns the message, and the `values` in it, for texts
 * in other languages; both are made when a program reads them.
 */
export const rejection = /* @__PURE__ */ (() => {
  class Rejection {
    #describe;

    constructor(refusal, describe, field) {
      this.refusal = refusal;
      this.field = field;
      this.#describe = describe;
    }

    get name() {
      return "CodecError";
    }

    get message() {
      return this.#describe()[0];
    }

    get values() {
      return this.#describe().slice(1);
    }

    toJSON() {
      const { name, message, refusal, values, field } = this;
      return { name, message, refusal, values, field };
    }
  }
  Object.setPrototypeOf(Rejection.prototype, CodecError.prototype);
  Rejection.prototype.constructor = CodecError;
  return (refusal, describe, field) => new Rejection(refusal, describe, field);
})();

const WIDEST_NUMBER = 53;
const COARSE = 2 ** 51; // from here on, a quotient of doubles is too coarse for the nearest integer

/** A type of the tables, with the functions that convert its raw integers. */
export class FieldType {
  constructor(table) {
    Object.assign(this, table);
    this.isFloat = table.encoding === "float";
    this.isWide = table.width > WIDEST_NUMBER;
    this.joined = table.text ? new JoinedText(table.text) : table.digits ? new JoinedDigits() : null;
    const size = 1n << BigInt(table.width);
    const least = table.encoding === "signed" ? -size / 2n : 0n;
    this.low = this.integer(least);
    this.high = this.integer(least + size - 1n);
    this.half = this.integer(size / 2n);
    const { enum: members = [], flags = [], noValues = [], names = [], linear } = table;
    this.nameOf = new Map(members);
    this.named = new Map([
      ...noValues.map(([, last, name]) => [name, last]),
      ...[...members, ...names].map(([raw, name]) => [name, raw]),
      ...flags.map(([bit, name]) => [name, this.integer(1n << BigInt(bit))]),
    ]);
    this.isConstant = !linear?.by && !linear?.times;
    this.lastParameters = null; // those of the last conversion: an edition hands over the same object for equal ones
    this.lastLine = null;
  }

  /** What the type is, for tools. */
  get description() {
    const { width, encoding, unit = null, enum: members = null, flags = null, linear, range, noValues = null, names = null } = this;
    return { width, encoding, unit, enum: members, flags, linear, range, noValues, names };
  }

  /** An integer as the raw integers of this type are: a BigInt if the type has more than 53 bits. */
  integer(raw) {
    return this.isWide ? BigInt(raw) : Number(raw);
  }

  /** The name for which a raw integer of a number has no value; null for a number. */
  noValue(raw) {
    if (!this.noValues) {
      return null;
    }
    const bits = this.isFloat && raw >= this.half ? this.integer(raw) - this.half : raw; // NaN of either sign
    return this.noValues.find(([first, last]) => bits >= first && bits <= last)?.[2] ?? null;
  }

  /** The name that a raw integer of a number has beside its value; null without one. */
  valueName(raw) {
    return this.names?.find(([named]) => named === raw)?.[1] ?? null;
  }

  /** The value of a raw integer; null without one. */
  value(raw, parameters) {
    if (this.noValue(raw) !== null) {
      return null;
    }
    if (this.enum) {
      return this.nameOf.get(raw) ?? null;
    }
    if (this.flags) {
      return this.flagsOf(raw);
    }
    const line = this.line(parameters);
    if (typeof line === "string") {
      return null;
    }
    const number = this.isFloat ? floatOf(this.width, raw) : raw;
    if (this.isFloat && !Number.isFinite(number)) {
      return null;
    }
    if (line.isIdentity) {
      return this.isFloat || this.linear === undefined ? number : Number(number);
    }
    const value = scaled(number, line);
    return Number.isFinite(value) ? value : null;
  }

  /** The value of an array of raw integers: those of all elements, or what they are together. */
  valueOfAll(raws, parameters) {
    return this.joined ? this.joined.value(raws) : Object.freeze(raws.map((raw) => this.value(raw, parameters)));
  }

  /** Why a raw integer has no value. */
  reason(raw, parameters) {
    if (this.noValue(raw) !== null) {
      return "no_value";
    }
    const line = this.enum ? null : this.line(parameters);
    if (typeof line === "string") {
      return line;
    }
    return this.isFloat && !Number.isFinite(floatOf(this.width, raw)) ? "not_finite" : "out_of_range";
  }

  /** The names of set bits; bits without a name follow as one integer. */
  flagsOf(raw) {
    const set = [];
    let rest = raw;
    for (const [name, weight] of this.named) {
      if (raw % (weight + weight) >= weight) {
        set.push(name);
        rest -= weight;
      }
    }
    return Object.freeze(rest ? [...set, rest] : set);
  }

  /** The raw integer nearest to a value, ties away from zero. Throws CodecError if the value is rejected. */
  raw(value, parameters, field) {
    if (this.enum || this.flags) {
      const items = this.flags ? [value].flat() : [value];
      return this.integer(items.reduce((raw, item) => raw | BigInt(this.ofMember(item, parameters, field)), 0n));
    }
    if (this.named.size && (typeof value === "string" || (this.noValues && value === null))) {
      return this.check(this.ofName(value, field), parameters, field, JSON.stringify(value));
    }
    const line = this.line(parameters);
    if (typeof line === "string") {
      const name = this.missing(parameters);
      const text = line === "missing_parameter" ? `depends on ${name}, which is not given; pass parameters: { ${name}: ... }` : TEXTS[line];
      throw new CodecError(line, `${field} ${text}`, field);
    }
    if (typeof value !== "number" && typeof value !== "bigint") {
      throw new TypeError(`${field} is no number`);
    }
    if (typeof value === "number" && !Number.isFinite(value)) {
      throw new CodecError("not_finite", `${field}=${value} is not a finite number`, field);
    }
    const given = `${value}${this.suffix}`;
    if (this.isFloat) {
      const nearestDouble = this.width === 32 ? toOdd : quotient;
      const bits = floatBits(this.width, typeof value === "bigint" ? nearestDouble(...exactSteps(value, line)) : steps(value, line));
      if (bits === null) {
        throw new CodecError("out_of_range", `${field}=${given} is too large for its float`, field);
      }
      return this.check(bits, parameters, field, given);
    }
    const count = typeof value === "number" ? steps(value, line) : Infinity;
    const raw = Math.abs(count) < COARSE ? rounded(count) : nearest(...exactSteps(value, line));
    if (this.noValue(raw) !== null) {
      throw new CodecError("out_of_range", `the raw integer ${raw} of ${field} means ${this.noValue(raw)}`, field);
    }
    return this.check(raw, parameters, field, given);
  }

  /** The raw integer that is written for a name of a number; null stands for the first one without a value. */
  ofName(value, field) {
    const name = value ?? this.noValues[0][2];
    if (!this.named.has(name)) {
      throw new CodecError("out_of_range", `${field}=${JSON.stringify(name)} is no number and none of the names ${[...this.named.keys()].join(", ")}`, field);
    }
    return this.named.get(name);
  }

  /** The raw integer of the name of a member, or of an integer. */
  ofMember(given, parameters, field) {
    const raw = this.named.get(given) ?? given;
    if (typeof raw === "string") {
      throw this.outOfRange(JSON.stringify(raw), parameters, field);
    }
    if (typeof raw === "number" && !Number.isInteger(raw)) {
      throw new CodecError(Number.isFinite(raw) ? "out_of_range" : "not_finite", `${field} has only whole numbers`, field);
    }
    return this.check(raw, parameters, field, `${raw}`);
  }

  /** A raw integer itself. Throws CodecError if it is out of range, TypeError if it is no exact integer. */
  check(raw, parameters, field, given = `raw ${raw}`) {
    if (typeof raw !== "bigint" && !(Number.isInteger(raw) && (!this.isWide || Number.isSafeInteger(raw)))) {
      throw new TypeError(`${field} is no exact integer; integers from 2^53 on are BigInt`);
    }
    if (this.isFloat && this.noValue(raw) === null && !(raw >= 0n && raw <= this.high && Number.isFinite(floatOf(this.width, this.integer(raw))))) {
      throw new CodecError("not_finite", `${field}=${given} is not a finite number`, field);
    }
    if (!this.allows(raw, parameters)) {
      throw this.outOfRange(given, parameters, field);
    }
    return this.integer(raw);
  }

  /** The error of a value that is not allowed, with what is. */
  outOfRange(given, parameters, field) {
    const [values, raws] = this.limits(parameters);
    const range = [values, raws && (values ? `(raw ${raws})` : `raw ${raws}`)].filter(Boolean).join(" ");
    return new CodecError("out_of_range", `${field}=${given} is ${this.enum || this.flags ? "none of" : "out of range"} ${range}`, field, [values, raws]);
  }

  /** The names of values, or the range with its unit, and the range of raw integers; empty texts for what there is not. */
  limits(parameters) {
    if (this.enum || this.flags) {
      return [[...this.named.keys()].join(", "), ""];
    }
    const [low, high] = this.bounds(parameters);
    if (this.isFloat) {
      const ends = [low ? quotient(...low) : -Infinity, high ? quotient(...high) : Infinity];
      return [`${ends.join("..")}${this.suffix}`, ""];
    }
    const least = low ? ceil(low) : this.low;
    const most = high ? floor(high) : this.high;
    const raws = [least < this.low ? this.low : least, most > this.high ? this.high : most];
    const values = raws.map((raw) => this.value(this.integer(raw), parameters));
    const ends = values[0] > values[1] ? values.reverse() : values;
    return [ends.includes(null) ? "" : `${ends.join("..")}${this.suffix}`, raws.join("..")];
  }

  /** The unit behind a number. */
  get suffix() {
    return this.unit ? ` ${this.unit}` : "";
  }

  /** Low and high bound of the specification as quotients; null for none. */
  bounds(parameters) {
    const range = this.range?.by ? own(this.range.cases, parameters[this.range.by]) : this.range;
    return range ? range.map((bound) => boundAt(bound, parameters)) : [null, null];
  }

  allows(raw, parameters) {
    if (raw < this.low || raw > this.high) {
      return false;
    }
    if (this.enum) {
      return this.nameOf.has(this.integer(raw));
    }
    if (this.flags) {
      return this.flagsOf(this.integer(raw)).every((item) => typeof item === "string");
    }
    const [low, high] = this.bounds(parameters);
    if ((low === null && high === null) || this.noValue(raw) !== null) {
      return true;
    }
    const line = this.line(parameters);
    if (this.isFloat && typeof line === "string") {
      return false;
    }
    const value = this.isFloat ? exactValue(floatOf(this.width, this.integer(raw)), line) : [BigInt(raw), 1n];
    return (low === null || compare(value, low) >= 0) && (high === null || compare(value, high) <= 0);
  }

  /** Scale and offset under some parameters, or the reason for which there is none. */
  line(parameters) {
    if (this.lastLine === null || !(this.isConstant || this.lastParameters === parameters)) {
      this.lastLine = this.lineAt(parameters);
      this.lastParameters = parameters;
    }
    return this.lastLine;
  }

  /** The parameter without which there is no scale. */
  missing(parameters) {
    const { by } = this.linear;
    return by && parameters[by] === undefined ? by : (by ? own(this.linear.cases, parameters[by]) : this.linear)?.times;
  }

  lineAt(parameters) {
    const { by, cases } = this.linear ?? {};
    const choice = by && parameters[by];
    if (by && choice === undefined) {
      return "missing_parameter";
    }
    const linear = by ? (own(cases, choice) ?? null) : this.linear;
    if (linear === null) {
      return "no_scale";
    }
    const { factor = 1, addend = 0, divisor = 1, steps: floats = [0, Number(divisor), Number(factor)], times = "" } = linear ?? {};
    const factors = [...times.matchAll(/(\/?)([^*/]+)/g)].map(([, operator, name]) => [operator, rational(parameters[name])]);
    if (factors.some(([, number]) => number === null)) {
      return "missing_parameter";
    }
    if (factors.some(([, [numerator]]) => numerator <= 0n)) {
      return "out_of_range";
    }
    const product = ([above, below], [operator, [n, d]]) => (operator ? [above * d, below * n] : [above * n, below * d]);
    const [above, below] = factors.reduce(product, [1n, 1n]);
    const [offset, denominator, numerator] = floats;
    const isExact = !times && [factor, addend, divisor].every(Number.isSafeInteger);
    return {
      ...{ factor: BigInt(factor) * above, addend: BigInt(addend) * above, divisor: BigInt(divisor) * below },
      ...{ offset, denominator, numerator, above: quotient(above, 1n), below: quotient(below, 1n) },
      exact: isExact ? { factor, addend, divisor } : null,
      isIdentity: isExact && factor === 1 && addend === 0 && divisor === 1,
    };
  }
}

const TEXTS = {
  no_scale: "has no scale here; use its raw integer",
  out_of_range: "needs a parameter above 0",
};

/** An item of an object by a name that can be that of a property of every object. */
export function own(object, name) {
  return Object.hasOwn(object, name) ? object[name] : undefined;
}

function boundAt(bound, parameters) {
  if (!Array.isArray(bound)) {
    return rational(bound);
  }
  const [constant, coefficient, parameter] = bound;
  if (parameters[parameter] === undefined) {
    return null;
  }
  const [above, below] = rational(constant);
  const [factor, divisor] = rational(coefficient);
  const [numerator, denominator] = rational(parameters[parameter]);
  return [above * divisor * denominator + factor * numerator * below, below * divisor * denominator];
}

/** (raw * factor + addend) / divisor, rounded once. */
function scaled(number, line) {
  const integer = Number(number);
  if (line.exact !== null && Number.isSafeInteger(integer)) {
    const product = integer * line.exact.factor;
    const sum = product + line.exact.addend;
    if (Number.isSafeInteger(product) && Number.isSafeInteger(sum)) {
      return sum / line.exact.divisor;
    }
  }
  return quotient(...exactValue(number, line));
}

/** The value of a raw number as a quotient. */
function exactValue(number, line) {
  const [numerator, denominator] = ratio(number);
  return [numerator * line.factor + line.addend * denominator, denominator * line.divisor];
}

/** The raw number of a value as a quotient with a positive denominator. */
function exactSteps(value, line) {
  const [numerator, denominator] = ratio(value);
  const sign = line.factor < 0n ? -1n : 1n;
  return [(numerator * line.divisor - line.addend * denominator) * sign, denominator * line.factor * sign];
}

/** The raw number of a value in doubles, each operation rounded: 0.15 at a scale of 0.1 is 1.5. */
function steps(value, { above, below, offset, denominator, numerator }) {
  return (((value * below) / above - offset) * denominator) / numerator;
}

/** A text in some bytes: it ends before the first 0, and before the padding at its end. An invalid byte is U+FFFD. */
class JoinedText {
  constructor([encoding, padding]) {
    this.isAscii = encoding === "ascii";
    this.padding = padding;
  }

  value(raw) {
    const terminator = raw.indexOf(0);
    let end = terminator < 0 ? raw.length : terminator;
    while (end > 0 && raw[end - 1] === this.padding) {
      end -= 1;
    }
    const bytes = Uint8Array.from(raw.slice(0, end));
    if (this.isAscii) {
      return Array.from(bytes, (byte) => (byte < 0x80 ? String.fromCharCode(byte) : "\uFFFD")).join("");
    }
    return new TextDecoder("utf-8", { ignoreBOM: true }).decode(bytes);
  }

  raw(value, field, count) {
    if (typeof value !== "string") {
      throw new TypeError(`${field} is no text`);
    }
    const raw = [...new TextEncoder().encode(value)];
    while (raw.length < count) {
      raw.push(this.padding);
    }
    if (raw.length > count || this.value(raw) !== value) {
      throw new CodecError("out_of_range", `${field} is no text of at most ${count} bytes`, field);
    }
    return raw;
  }
}

/** A number in decimal digits, from the most significant one on; null if a digit exceeds 9. */
class JoinedDigits {
  value(raw) {
    return raw.some((digit) => digit > 9) ? null : Number(raw.join(""));
  }

  raw(value, field, count) {
    if (typeof value !== "number" && typeof value !== "bigint") {
      throw new TypeError(`${field} is no number`);
    }
    if (typeof value === "number" && !Number.isFinite(value)) {
      throw new CodecError("not_finite", `${field} is not a finite number`, field);
    }
    const whole = typeof value === "bigint" ? value : BigInt(rounded(value));
    if (whole < 0n || whole >= 10n ** BigInt(count)) {
      throw new CodecError("out_of_range", `${field} has more than ${count} digits, or is negative`, field);
    }
    return [...String(whole).padStart(count, "0")].map(Number);
  }
}
