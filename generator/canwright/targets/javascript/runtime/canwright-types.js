/** Types of fields: the conversion between raw integers and values, with scales and ranges that can depend on parameters. */

import { ceil, compare, floatBits, floatOf, floor, nearest, quotient, ratio, rational, rounded, toOdd } from "./canwright-numbers.js";

/** Why a frame or a value is rejected: `refusal` is the reason, `field` the name of the field that caused it. */
export class CodecError extends Error {
  constructor(refusal, message, field) {
    super(message);
    this.name = "CodecError";
    this.refusal = refusal;
    this.field = field;
  }
}

const WIDEST_NUMBER = 53;
const COARSE = 2 ** 51; // from here on, a quotient of doubles is too coarse for the nearest integer

/** A type of the tables, with the functions that convert its raw integers. */
export class FieldType {
  constructor(table) {
    Object.assign(this, table);
    this.isFloat = table.encoding === "float";
    this.isSigned = table.encoding === "signed";
    this.isWide = table.width > WIDEST_NUMBER;
    this.names = table.enum && new Map(table.enum);
    this.values = table.enum && new Map(table.enum.map(([value, name]) => [name, value]));
    this.bits = table.flags && new Map(table.flags.map(([bit, name]) => [name, 1n << BigInt(bit)]));
    const size = 1n << BigInt(table.width);
    this.low = this.isSigned ? -size / 2n : 0n;
    this.high = this.isSigned ? size / 2n - 1n : size - 1n;
    const isConstant = !table.linear?.by && !table.linear?.times;
    this.constantLine = isConstant ? this.lineAt(Object.create(null)) : null;
    this.mask = table.flags && [...this.bits.values()].reduce((mask, bit) => mask | bit, 0n);
  }

  /** An integer as the raw integers of this type are: a BigInt if the type has more than 53 bits. */
  integer(raw) {
    return this.isWide ? BigInt(raw) : Number(raw);
  }

  /** The value of a raw integer as `{ value }`; `{ value: null, reason }` without one. */
  value(raw, parameters) {
    if (this.names) {
      return this.names.has(raw) ? { value: this.names.get(raw) } : { value: null, reason: "out_of_range" };
    }
    if (this.bits) {
      return { value: this.flagsOf(BigInt(raw)) };
    }
    const line = this.line(parameters);
    if (typeof line === "string") {
      return { value: null, reason: line };
    }
    const number = this.isFloat ? floatOf(this.width, raw) : raw;
    if (this.isFloat && !Number.isFinite(number)) {
      return { value: null, reason: "not_finite" };
    }
    if (line.isIdentity) {
      return { value: this.isFloat || this.linear === undefined ? number : Number(number) };
    }
    const value = scaled(number, line);
    return Number.isFinite(value) ? { value } : { value: null, reason: "out_of_range" };
  }

  /** The names of set bits; bits without a name follow as one integer. */
  flagsOf(raw) {
    const set = [];
    for (const [name, bit] of this.bits) {
      if (raw & bit) {
        set.push(name);
      }
    }
    const rest = raw & ~this.mask;
    if (rest) {
      set.push(this.integer(rest));
    }
    return Object.freeze(set);
  }

  /** The raw integer nearest to a value, ties away from zero. Throws CodecError if the value is rejected. */
  raw(value, parameters, field) {
    if (this.names || this.bits) {
      return this.check(this.named(value, field), parameters, field);
    }
    const line = this.line(parameters);
    if (typeof line === "string") {
      throw new CodecError(line, `${field} cannot be converted: ${TEXTS[line]}`, field);
    }
    if (typeof value !== "number" && typeof value !== "bigint") {
      throw new TypeError(`${field} is no number`);
    }
    if (typeof value === "number" && !Number.isFinite(value)) {
      throw new CodecError("not_finite", `${field} is not a finite number`, field);
    }
    if (this.isFloat) {
      const bits = floatBits(this.width, typeof value === "bigint" ? this.exactFloat(value, line) : steps(value, line));
      if (bits === null) {
        throw new CodecError("out_of_range", `${field} is too large for its float`, field);
      }
      return this.check(bits, parameters, field);
    }
    const count = typeof value === "number" ? steps(value, line) : Infinity;
    return this.check(Math.abs(count) < COARSE ? rounded(count) : exactSteps(value, line), parameters, field);
  }

  /** The number of an integer, which is rounded once. */
  exactFloat(value, line) {
    const above = value * line.divisor - line.addend;
    const sign = line.factor < 0n ? -1n : 1n;
    return (this.width === 32 ? toOdd : quotient)(above * sign, line.factor * sign);
  }

  /** The raw integer of the name of an enum, of flags as names and integers, or of an integer. */
  named(value, field) {
    const unknown = (name) => new CodecError("out_of_range", `${field} has no value ${JSON.stringify(name)}`, field);
    if (typeof value === "string" && this.names) {
      if (!this.values.has(value)) {
        throw unknown(value);
      }
      return this.values.get(value);
    }
    if (Array.isArray(value) && this.bits) {
      return value.reduce((raw, item) => {
        const isInteger = typeof item === "bigint" || Number.isInteger(item);
        if (!isInteger && !this.bits.has(item)) {
          throw unknown(item);
        }
        return raw | (isInteger ? BigInt(item) : this.bits.get(item));
      }, 0n);
    }
    if (typeof value === "number" && !Number.isInteger(value)) {
      const isFinite = Number.isFinite(value);
      throw new CodecError(isFinite ? "out_of_range" : "not_finite", `${field} has only whole numbers`, field);
    }
    return value;
  }

  /** A raw integer itself. Throws CodecError if it is out of range, TypeError if it is no exact integer. */
  check(raw, parameters, field) {
    if (typeof raw !== "bigint" && !(Number.isInteger(raw) && (!this.isWide || Number.isSafeInteger(raw)))) {
      throw new TypeError(`${field} is no exact integer; integers from 2^53 on are BigInt`);
    }
    if (this.isFloat && !(raw >= 0n && raw <= this.high && Number.isFinite(floatOf(this.width, this.integer(raw))))) {
      throw new CodecError("not_finite", `the raw integer ${raw} of ${field} is no finite number`, field);
    }
    if (!this.allows(raw, parameters)) {
      throw new CodecError("out_of_range", `the raw integer ${raw} of ${field} is out of range`, field);
    }
    return this.integer(raw);
  }

  allows(raw, parameters) {
    if (raw < this.low || raw > this.high) {
      return false;
    }
    if (this.names) {
      return this.names.has(this.integer(raw));
    }
    if (this.bits) {
      return (BigInt(raw) & ~this.mask) === 0n;
    }
    const range = this.range?.by ? own(this.range.cases, parameters[this.range.by]) : this.range;
    if (!range) {
      return true;
    }
    const [low, high] = range.map((bound) => boundAt(bound, parameters));
    if (!this.isFloat) {
      return (low === null || raw >= ceil(low)) && (high === null || raw <= floor(high));
    }
    const line = this.line(parameters);
    if (typeof line === "string") {
      return false;
    }
    const [numerator, denominator] = ratio(floatOf(this.width, this.integer(raw)));
    const value = [numerator * line.factor + line.addend * denominator, denominator * line.divisor];
    return (low === null || compare(value, low) >= 0) && (high === null || compare(value, high) <= 0);
  }

  /** Scale and offset under some parameters, or the reason for which there is none. */
  line(parameters) {
    return this.constantLine ?? this.lineAt(parameters);
  }

  lineAt(parameters) {
    let linear = this.linear;
    if (linear?.by) {
      const choice = parameters[linear.by];
      if (choice === undefined) {
        return "missing_parameter";
      }
      linear = own(linear.cases, choice) ?? null;
    }
    if (linear === null) {
      return "no_scale";
    }
    const { factor = 1, addend = 0, divisor = 1, steps: floats, times } = linear ?? {};
    const [offset, denominator, numerator] = floats ?? [0, Number(divisor), Number(factor)];
    const line = { factor: BigInt(factor), addend: BigInt(addend), divisor: BigInt(divisor), offset, denominator, numerator };
    if (times === undefined) {
      const isExact = [factor, addend, divisor].every(Number.isSafeInteger);
      return Object.assign(line, { isExact, isIdentity: factor === 1 && addend === 0 && divisor === 1 });
    }
    if (parameters[times] === undefined) {
      return "missing_parameter";
    }
    const [above, below] = rational(parameters[times]);
    if (above <= 0n) {
      return "out_of_range";
    }
    line.factor *= above;
    line.addend *= above;
    line.divisor *= below;
    return Object.assign(line, { isExact: false, isIdentity: false, times: [quotient(above, 1n), quotient(below, 1n)] });
  }
}

const TEXTS = {
  missing_parameter: "it depends on a parameter that is not given",
  no_scale: "it has no scale here; use its raw integer",
  out_of_range: "its parameter must be above 0",
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
  if (line.isExact && Number.isSafeInteger(number)) {
    const product = number * Number(line.factor);
    const sum = product + Number(line.addend);
    if (Number.isSafeInteger(product) && Number.isSafeInteger(sum)) {
      return sum / Number(line.divisor);
    }
  }
  const [numerator, denominator] = typeof number === "bigint" ? [number, 1n] : ratio(number);
  return quotient(numerator * line.factor + line.addend * denominator, denominator * line.divisor);
}

/** The raw number of a value in doubles, each operation rounded: 0.15 at a scale of 0.1 is 1.5. */
function steps(value, line) {
  const given = line.times ? (value * line.times[1]) / line.times[0] : value;
  return ((given - line.offset) * line.denominator) / line.numerator;
}

function exactSteps(value, line) {
  const [numerator, denominator] = typeof value === "bigint" ? [value, 1n] : ratio(value);
  return nearest(numerator * line.divisor - line.addend * denominator, denominator * line.factor);
}
