/** Identifies, decodes and encodes frames with the tables of one edition. */

import { rational } from "./canwright-numbers.js";
import { CodecError, FieldType, joinedBy, own, rejection } from "./canwright-types.js";

export { CodecError };

/** The value of a counter in the next frame; `counter` is the first and the last value, as `MESSAGES` has them. */
export function nextCount([first, last], value) {
  return value >= first && value < last ? value + 1 : first;
}

/** So many increments lead from one value to another; 0 if they are equal, or if one of them is outside of the range. */
export function countSteps([first, last], previous, value) {
  const isWithin = [previous, value].every((count) => count >= first && count <= last);
  return isWithin ? (value - previous + last - first + 1) % (last - first + 1) : 0;
}

const ID = -1; // the `byte` of a segment in the CAN id
const NOTHING = /* @__PURE__ */ Object.freeze(/* @__PURE__ */ Object.create(null));

/** The counters of one sender: those of each message to or from each node increase separately. */
export class Numbering {
  #edition;
  #sent = new Map();

  constructor(edition) {
    this.#edition = edition;
  }

  /** The message to send: the first of its command and node as it is, each further one with the next counters. */
  next(message) {
    const { direction, command, node, code, parameters } = message;
    const { fields } = this.#edition.MESSAGES.find((known) => known.direction === direction && known.command === command);
    const counters = fields.filter((field) => field.counter !== null && own(message.raw, field.name) !== undefined);
    if (!counters.length) {
      return message;
    }
    const key = JSON.stringify([direction, command, node]);
    const sent = this.#sent.get(key) ?? NOTHING;
    const raw = { ...message.raw };
    for (const { name, counter } of counters.filter((field) => own(sent, field.name) !== undefined)) {
      raw[name] = nextCount(counter, Number(sent[name]));
    }
    const encode = direction === "request" ? this.#edition.encodeRequest : this.#edition.encodeReply;
    const numbered = encode(command, { node: node ?? undefined, raw, code, parameters });
    this.#sent.set(key, { ...sent, ...Object.fromEntries(counters.map(({ name }) => [name, numbered.raw[name]])) });
    return numbered;
  }
}

/** The functions of an edition; see `Edition` in canwright-codec.d.ts for its members. */
export function createEdition(tables) {
  const codec = new Codec(tables);
  const directions = { request: codec.router("request", tables.requests), reply: codec.router("reply", tables.replies) };
  const edition = {
    FAMILY: tables.family,
    EDITION: tables.edition,
    SPEC_HASH: tables.hash,
    REPLY_WITHIN_MS: tables.replyWithin,
    PARAMETERS: frozen(tables.parameters),
    MESSAGES: frozen(codec.messages.map((message) => message.description)),
    decodeRequest: (frame, parameters) => codec.decode(directions.request, frame, parameters),
    decodeReply: (frame, parameters) => codec.decode(directions.reply, frame, parameters),
    decodeAs: (direction, command, frame, parameters) => codec.decodeAs(direction, command, frame, parameters),
    decodeAnswer: (request, given, parameters) => {
      const [frame, known] = [checkedFrame(given), codec.known(parameters)];
      return codec.fields(codec.answer(directions.request, request.frame, frame, known), frame, known);
    },
    join: (replies, field, last) => codec.join(replies, field, last),
    checkReply: (request, reply, parameters) => {
      codec.answer(directions.request, request, checkedFrame(reply), codec.known(parameters));
    },
    candidates: (frame, parameters) => codec.candidates(directions, frame, codec.known(parameters)),
    rawOf: (direction, command, field, value, parameters) => codec.rawOf(direction, command, field, value, parameters),
    allows: (direction, command, field, raw, parameters) => codec.allows(direction, command, field, raw, parameters),
    encodeRequest: (command, given) => codec.encode("request", command, given),
    encodeReply: (command, given) => codec.encode("reply", command, given),
  };
  return Object.freeze(edition);
}

class Codec {
  constructor(tables) {
    this.tables = tables;
    const types = tables.types.map((type) => new FieldType(type));
    this.layouts = tables.layouts.map((layout) => new Layout(layout, types));
    this.messages = tables.messages.map((message) => new Message(message, this.layouts[message.layout]));
    this.ofCommand = { request: new Map(), reply: new Map() };
    for (const message of this.messages) {
      this.ofCommand[message.direction].set(message.command, message);
    }
    this.given = NOTHING; // the parameters of the last call, and what `known` made of them
    this.lastKnown = NOTHING;
    this.answers = new Map();
    for (const { request, reply, nodes = [], asked = null, reported = null, echo = false } of tables.answers) {
      const bits = { asked: asked && new Bits(asked), reported: reported && new Bits(reported) };
      const { command } = this.messages[request];
      const plan = { reply: this.messages[reply], nodes, ...bits, echo };
      const plans = this.answers.get(this.messages[request]);
      if (plans) {
        plans.push(plan);
      } else {
        this.answers.set(this.messages[request], [plan]);
        this.ofCommand.reply.set(command, this.messages[reply]);
      }
    }
  }

  router(direction, routes) {
    const plan = (node) => {
      if (typeof node === "string") {
        return new Reject(node);
      }
      if (typeof node === "number") {
        return this.messages[node];
      }
      const cases = new Map(node.cases.flatMap(([values, then]) => values.map((value) => [value, plan(then)])));
      return new Select(node.on, cases, plan(node.otherwise));
    };
    return { direction, routes: routes.map((route) => ({ rule: new IdRule(route), mask: route.mask ?? 0, plan: plan(route.plan) })) };
  }

  /** Parameters as the tables have them; the same object for equal ones. Throws TypeError for an unknown one, RangeError for a value that it cannot have. */
  known(parameters = NOTHING) {
    if (!haveEqualItems(parameters, this.given)) {
      this.lastKnown = this.checked(parameters);
      this.given = { ...parameters };
    }
    return this.lastKnown;
  }

  checked(parameters) {
    const known = Object.create(null); // a parameter can have the name of a property of every object
    for (const [name, value] of Object.entries(parameters)) {
      const parameter = own(this.tables.parameters, name);
      if (!parameter) {
        throw new TypeError(`there is no parameter ${JSON.stringify(name)}`);
      }
      if (value !== undefined && value !== null) {
        known[name] = parameter.values ? choice(parameter, name, value) : number(parameter, name, value);
      }
    }
    return Object.freeze(known);
  }

  /** The message of a frame. Throws CodecError if it is none. */
  identify(router, frame, parameters) {
    const route = router.routes.find(({ rule, mask }) => rule.node(frame, mask, parameters) !== undefined);
    if (!route) {
      const unknown = router.routes.find(({ rule }) => rule.isOfKind(frame) && rule.offset(parameters) === undefined);
      if (unknown) {
        throw rejection("missing_parameter", `${hex(frame.id)} may be an id with the parameter ${unknown.rule.parameter}, which is not given`, []);
      }
      const kind = (frame.extended ? "29-bit " : "") + (frame.remote ? "remote " : "");
      const digits = frame.id.toString(16).toUpperCase().padStart(frame.extended ? 8 : 3, "0");
      throw rejection("unknown_id", `no ${router.direction} has the ${kind}id ${hex(frame.id)}`, [`0x${digits}${frame.remote ? " RTR" : ""}`]);
    }
    let step = route.plan;
    while (step instanceof Select) {
      step = step.next(step.read(frame));
    }
    if (step instanceof Reject) {
      throw step.error(router.direction, frame, route.plan);
    }
    return step;
  }

  decode(router, given, parameters) {
    const [frame, known] = [checkedFrame(given), this.known(parameters)];
    return this.fields(this.identify(router, frame, known), frame, known);
  }

  decodeAs(direction, command, given, parameters) {
    const frame = checkedFrame(given);
    const [message, known] = [this.message(direction, command), this.known(parameters)];
    const wrong = message.difference(frame, known);
    if (wrong) {
      throw rejection(wrong.refusal, wrong.text, []);
    }
    return this.fields(message, frame, known);
  }

  /** The message of a frame with its fields. Throws CodecError for a wrong constant or checksum, or if the fields are unknown. */
  fields(message, frame, parameters) {
    message.check(frame, parameters);
    const variant = message.variant(parameters);
    for (const field of variant.parametric) {
      checkConstant(field, field.required(parameters), frame);
    }
    const raw = { ...variant.unfilled };
    for (const field of variant.fields) {
      raw[field.name] = field.read(frame);
    }
    return new MessageResult(this.tables, message, message.nodeOf(frame, parameters), frame, raw, parameters);
  }

  message(direction, command) {
    const message = this.ofCommand[direction]?.get(command);
    if (!message) {
      throw new TypeError(`there is no ${direction} of ${JSON.stringify(command)}`);
    }
    return message;
  }

  encode(direction, command, { node = null, values, raw, code, parameters } = NOTHING) {
    const message = this.message(direction, command);
    const known = this.known(parameters);
    message.checkAvailable(known);
    message.checkCode(code);
    message.rule.check(node, known, command);
    const { fields } = message.variant(known);
    const given = values ?? raw ?? NOTHING;
    const wrong = Object.keys(given).length !== fields.length || fields.some(({ name }) => !Object.hasOwn(given, name));
    if (wrong || (values && raw)) {
      const names = fields.map(({ name }) => name).join(", ") || "no fields";
      throw new TypeError(`the ${direction} of ${command} needs values, or raw integers, of: ${names}`);
    }
    const raws = Object.fromEntries(fields.map((field) => [field.name, field.given(given[field.name], known, values !== undefined)]));
    const frame = message.write(node, raws, code, known);
    message.checkMeaning(frame);
    return new MessageResult(this.tables, message, message.nodeOf(frame, known), frame, raws, known);
  }

  rawOf(direction, command, name, value, parameters) {
    const known = this.known(parameters);
    return this.field(direction, command, name, known).given(value, known, true);
  }

  allows(direction, command, name, raw, parameters) {
    const known = this.known(parameters);
    const { type } = this.field(direction, command, name, known);
    return [raw].flat().every((element) => type.allows(element, known));
  }

  field(direction, command, name, known) {
    const field = this.message(direction, command).variant(known).fields.find((candidate) => candidate.name === name);
    if (!field) {
      throw new TypeError(`the ${direction} of ${command} has no field ${JSON.stringify(name)}`);
    }
    return field;
  }

  /** The message that a frame is as the reply to a request. Throws CodecError if it is none. */
  answer(requests, givenRequest, frame, parameters) {
    const request = checkedFrame(givenRequest);
    const message = this.identify(requests, request, parameters);
    message.check(request, NOTHING);
    const plans = this.answers.get(message);
    if (!plans) {
      throw notAnswer(`${message.command} has no reply`);
    }
    const reasons = plans.map((plan) => reasonAgainst(plan, message, request, frame, parameters));
    const number = reasons.indexOf("");
    if (number < 0) {
      throw notAnswer(reasons[0]);
    }
    return plans[number].reply;
  }

  /** The values of a field of a reply of several frames, in the order of their numbers; those of arrays in one array. */
  join(replies, field, last) {
    const message = this.ofCommand.reply.get(replies[0]?.command);
    const { frames } = message ?? {};
    if (!frames) {
      throw new RangeError("there are no frames of a reply of several frames");
    }
    const byNumber = new Map(replies.map((reply) => [reply.values[frames.field], reply]));
    const numbers = Array.from({ length: (last ?? frames.last) - frames.first + 1 }, (_, i) => frames.first + i);
    const missing = numbers.find((number) => !byNumber.has(number));
    if (missing !== undefined || replies.length !== numbers.length) {
      throw new RangeError(missing === undefined ? "a frame is unexpected or given twice" : `frame ${missing} is missing`);
    }
    return numbers.flatMap((number) => byNumber.get(number).values[field]);
  }

  candidates(directions, given, parameters) {
    const frame = checkedFrame(given);
    const candidates = [];
    const add = (message) => {
      if (!candidates.includes(message)) {
        candidates.push(message);
      }
    };
    const identify = (router) => {
      try {
        add(this.identify(router, frame, parameters));
      } catch (error) {
        if (!(error instanceof CodecError)) {
          throw error;
        }
      }
    };
    identify(directions.reply);
    for (const index of this.tables.explained) {
      if (!this.messages[index].difference(frame, parameters)) {
        add(this.messages[index]);
      }
    }
    identify(directions.request);
    return Object.freeze(candidates.map((message) => Object.freeze({ direction: message.direction, command: message.command, node: message.nodeOf(frame, parameters) })));
  }
}

/** Whether two objects have the same names with the same values, in the same order. */
function haveEqualItems(left, right) {
  const names = Object.keys(left);
  const others = Object.keys(right);
  return names.length === others.length && names.every((name, i) => name === others[i] && left[name] === right[name]);
}

function choice(parameter, name, value) {
  if (!parameter.values.includes(String(value))) {
    throw new RangeError(`${name} is none of ${parameter.values.join(", ")}; leave it out if it is unknown`);
  }
  return String(value);
}

function number({ minimum = null, maximum = null, whole = false }, name, value) {
  const ratio = rational(value);
  if (!ratio || (whole && ratio[0] % ratio[1])) {
    throw new RangeError(`${name} is no ${whole ? "whole " : ""}number; leave it out if it is unknown`);
  }
  const isLess = (bound) => ratio[0] * bound[1] < bound[0] * ratio[1];
  const isGreater = (bound) => ratio[0] * bound[1] > bound[0] * ratio[1];
  if ((minimum !== null && isLess(rational(minimum))) || (maximum !== null && isGreater(rational(maximum)))) {
    throw new RangeError(`${name} must be from ${minimum ?? "-∞"} to ${maximum ?? "∞"}; leave it out if it is unknown`);
  }
  return value;
}

/** Why a frame is not a reply to a request; empty if it is. */
function reasonAgainst({ reply, nodes: repliers, asked, reported, echo }, message, request, frame, parameters) {
  const wrong = reply.difference(frame, parameters);
  if (wrong) {
    return wrong.text;
  }
  const to = asked ? asked.read(request) : message.node(request, parameters);
  const mask = asked ? asked.mask : -1n;
  const nodes = repliers.length ? repliers : to === null ? [] : [to];
  const isFrom = (source, bits) =>
    source === null || !nodes.length || nodes.some((node) => !((BigInt(source) ^ BigInt(node)) & bits));
  const sources = [[reply.node(frame, parameters), mask], ...(reported ? [[reported.read(frame), mask & reported.mask]] : [])];
  const unexpected = sources.find(([source, bits]) => !isFrom(source, bits));
  if (unexpected) {
    return `it comes from node ${unexpected[0]}, not ${nodes.join(" or ")}`;
  }
  if (echo && !(request.data.length === frame.data.length && request.data.every((byte, i) => byte === frame.data[i]))) {
    return `the reply of ${message.command} is an echo, but this frame differs from the request`;
  }
  return "";
}

function notAnswer(text) {
  return rejection("not_answer", text, []);
}

/** A copy of a frame with all its parts. Throws TypeError if it is none. */
function checkedFrame({ id, data: given = [], extended = false, remote = false }) {
  const isBuffer = given?.length === undefined && given?.byteLength !== undefined; // an ArrayBuffer or a DataView
  const data = isBuffer ? new Uint8Array(given.buffer ?? given, given.byteOffset ?? 0, given.byteLength) : given;
  let isFrame = Number.isInteger(id) && id >= 0 && id < 2 ** 29 && Number.isInteger(data?.length);
  const bytes = [];
  for (let i = 0; i < data?.length; i++) {
    isFrame = isFrame && Number.isInteger(data[i]) && data[i] >= 0 && data[i] < 256;
    bytes.push(data[i]);
  }
  if (!isFrame) {
    throw new TypeError("a frame has an id of at most 29 bits, and bytes as data");
  }
  return { id, data: bytes, extended: Boolean(extended), remote: Boolean(remote) };
}

function hex(value) {
  return `0x${value.toString(16).toUpperCase()}`;
}

const LOW_BITS = 24; // with the 29 bits that a segment of the id has at most, 53

/** Some bits of a frame that are an unsigned integer; a BigInt above 53 bits. Bytes beyond the data count as 0. */
class Bits {
  constructor(segments) {
    this.segments = segments;
    this.width = Math.max(...segments.map(([, , count, rawLow]) => rawLow + count));
    this.mask = (1n << BigInt(this.width)) - 1n;
    this.isWide = this.width > 53;
    const isLow = ([, , , rawLow]) => !this.isWide || rawLow < LOW_BITS;
    this.low = partsOf(segments.filter(isLow), 0);
    this.high = partsOf(segments.filter((segment) => !isLow(segment)), LOW_BITS);
  }

  read(frame) {
    const low = joined(this.low, frame);
    return this.isWide ? (BigInt(joined(this.high, frame)) << BigInt(LOW_BITS)) + BigInt(low) : low;
  }

  /** The id with the bits of an integer; those in the data are written to `data`. */
  write(raw, id, data) {
    const unsigned = BigInt.asUintN(this.width, BigInt(raw));
    let filled = id;
    for (const [byte, low, count, rawLow] of this.segments) {
      const part = Number((unsigned >> BigInt(rawLow)) & ((1n << BigInt(count)) - 1n)) * 2 ** low;
      if (byte === ID) {
        filled |= part;
      } else if (byte < data.length) {
        data[byte] |= part;
      }
    }
    return filled;
  }
}

/** Parts of an integer: where the bits are, and their weight in an integer without its lowest bits. */
function partsOf(segments, lowest) {
  return segments.map(([byte, low, count, rawLow]) => ({ byte, low, ones: 2 ** count - 1, weight: 2 ** (rawLow - lowest) }));
}

function joined(parts, { id, data }) {
  let raw = 0;
  for (const { byte, low, ones, weight } of parts) {
    const source = byte === ID ? id : byte < data.length ? data[byte] : 0;
    raw += ((source >>> low) & ones) * weight;
  }
  return raw;
}

/** The value of a parameter in an id or a constant; undefined if it is not given. */
function whole(parameters, name) {
  const value = parameters[name];
  if (value === undefined) {
    return undefined;
  }
  const [numerator, denominator] = rational(value);
  return Number(numerator / denominator);
}

class IdRule {
  constructor({ base, step = 1, parameter = null, times = 1, nodes = null, extended = false, remote = false }) {
    Object.assign(this, { base, step, parameter, times, nodes, extended, remote });
  }

  isOfKind(frame) {
    return this.extended === frame.extended && this.remote === frame.remote;
  }

  /** The part of the id that is a parameter; undefined if that is not given. */
  offset(parameters) {
    const value = this.parameter === null ? 0 : whole(parameters, this.parameter);
    return value === undefined ? undefined : value * this.times;
  }

  /** The node of a frame, null for a fixed id, undefined if the id is not of this rule; `mask` are bits of keys and fields. */
  node(frame, mask, parameters) {
    const offset = this.isOfKind(frame) ? this.offset(parameters) : undefined;
    if (offset === undefined) {
      return undefined;
    }
    const rest = (frame.id & ~mask) - this.base - offset;
    if (!this.nodes) {
      return rest === 0 ? null : undefined;
    }
    const node = rest / this.step;
    return Number.isInteger(node) && node >= this.nodes[0] && node <= this.nodes[1] ? node : undefined;
  }

  /** Throws TypeError without a node, CodecError if there is no such node, or if the parameter in the id is not given. */
  check(node, parameters, command) {
    if (this.nodes && !Number.isInteger(node)) {
      throw new TypeError(`${command} needs a node from ${this.nodes.join("..")}`);
    }
    if (this.nodes && !(node >= this.nodes[0] && node <= this.nodes[1])) {
      throw new CodecError("unknown_node", `there is no node ${node}; nodes are ${this.nodes.join("..")}`, "node");
    }
    if (this.offset(parameters) === undefined) {
      throw new CodecError("missing_parameter", `the id of ${command} contains ${this.parameter}, which is not given`);
    }
  }
}

class Select {
  constructor(on, cases, otherwise) {
    Object.assign(this, { on, cases, otherwise });
    this.isLength = on === "length";
    this.bits = Array.isArray(on) ? new Bits(on) : null;
  }

  read(frame) {
    if (this.isLength) {
      return frame.data.length;
    }
    return this.bits ? this.bits.read(frame) : frame.id & this.on.mask;
  }

  next(value) {
    return this.cases.get(value) ?? this.otherwise;
  }
}

class Reject {
  constructor(reason) {
    this.reason = reason;
  }

  error(direction, frame, plan) {
    const path = [];
    for (let step = plan; step instanceof Select; step = step.next(step.read(frame))) {
      path.push([step, step.read(frame)]);
    }
    if (this.reason === "wrong_length") {
      const [select] = path.findLast(([select]) => select.isLength);
      const lengths = [...select.cases.keys()];
      const text = `${hex(frame.id)} has ${frame.data.length} data bytes, not ${lengths.join(" or ")}`;
      return rejection(this.reason, text, [hex(frame.id), frame.data.length, lengths]);
    }
    if (this.reason === "unknown_code") {
      const codes = path.filter(([select]) => select.bits).map(([, value]) => hex(value));
      const text = `no ${direction} on ${hex(frame.id)} has the code ${codes.join(" and ")}`;
      return rejection(this.reason, text, [hex(frame.id), codes]);
    }
    return rejection(this.reason, `${hex(frame.id)} has bits that are 0 in the ids of this message`, [hex(frame.id)]);
  }
}

class Layout {
  constructor({ parameter = null, values = [], fields }, types) {
    this.parameter = parameter;
    this.values = values;
    this.every = fields.map((field) => new Field(field, types[field.type]));
    this.common = new Variant(this.every.filter(({ only }) => only === null));
    this.variants = new Map(values.map((value) => [value, new Variant(this.every.filter((field) => field.exists(value)))]));
  }

  /** The fields under some parameters; null if they are unknown. */
  variant(parameters) {
    return this.parameter === null ? this.common : (this.variants.get(parameters[this.parameter]) ?? null);
  }
}

/**
 * The fields that a message has at the same time; `fields` are those that vary, `parametric` the constants that are parameters.
 * A copy of `unfilled` is filled faster than a new object.
 */
class Variant {
  constructor(every) {
    this.every = every;
    this.fields = every.filter(({ fixed, parameter, isChecksum }) => fixed === null && parameter === null && !isChecksum);
    this.constants = every.filter(({ isConstant, parameter }) => isConstant && parameter === null);
    this.conditional = this.constants.filter(({ only }) => only !== null);
    this.parametric = every.filter(({ parameter }) => parameter !== null);
    this.unfilled = Object.fromEntries(this.fields.map(({ name }) => [name, null]));
    this.isWide = this.fields.some(({ type }) => type.isWide);
  }
}

class Field {
  constructor(table, type) {
    this.name = table.name;
    this.type = type;
    this.elements = table.elements.map((segments) => new Bits(segments));
    this.isArray = table.indices !== undefined;
    this.joined = joinedBy(type, this.elements.length);
    this.only = table.only ?? null;
    this.fixed = table.fixed ?? null;
    this.isConstant = table.constant ?? false;
    this.isChecksum = table.checksum ?? false;
    this.counter = table.counter ?? null;
    this.parameter = table.parameter ?? null;
    this.indices = table.indices ?? null;
  }

  /** The raw integer of a constant that is a parameter. Throws CodecError if that is not given. */
  required(parameters) {
    const value = whole(parameters, this.parameter);
    if (value === undefined) {
      throw new CodecError("missing_parameter", `the constant ${this.name} is ${this.parameter}, which is not given`, this.name);
    }
    return this.type.isWide ? BigInt(value) : value;
  }

  exists(value) {
    return this.only === null || this.only.includes(value);
  }

  read(frame) {
    const raw = this.signed(this.elements[0].read(frame));
    return this.isArray ? Object.freeze(this.elements.map((element) => this.signed(element.read(frame)))) : raw;
  }

  signed(raw) {
    return this.type.isSigned && raw >= this.type.half ? raw - this.type.size : raw;
  }

  value(raw, parameters) {
    if (this.joined) {
      return this.joined.value(raw);
    }
    return this.isArray ? Object.freeze(raw.map((element) => this.type.value(element, parameters))) : this.type.value(raw, parameters);
  }

  /** The raw integers of given values or raw integers. Throws CodecError. */
  given(given, parameters, isValue) {
    const convert = (element) => (isValue ? this.type.raw(element, parameters, this.name) : this.type.check(element, parameters, this.name));
    if (!this.isArray) {
      return convert(given);
    }
    if (this.joined && isValue) {
      return Object.freeze(this.joined.raw(given, this.name));
    }
    if (!Array.isArray(given) || given.length !== this.elements.length) {
      throw new CodecError("out_of_range", `${this.name} needs ${this.elements.length} elements`, this.name);
    }
    return Object.freeze(given.map(convert));
  }

  result(raw, value, parameters) {
    if (this.joined) {
      return Object.freeze({ name: this.name, raw, value, unit: null, reason: value === null ? "out_of_range" : null, noValue: null, valueName: null });
    }
    const without = this.isArray ? raw[value.indexOf(null)] : value === null ? raw : undefined;
    const reason = without === undefined ? null : this.type.reason(without, parameters);
    const noValue = this.named(raw, (element) => this.type.noValue(element));
    const valueName = this.named(raw, (element) => this.type.valueName(element));
    return { name: this.name, raw, value, unit: this.type.unit ?? null, reason, noValue, valueName };
  }

  /** The name of a raw integer, or those of all elements of an array; null without any. */
  named(raw, nameOf) {
    if (!this.isArray) {
      return nameOf(raw);
    }
    const names = raw.map(nameOf);
    return names.some((name) => name !== null) ? Object.freeze(names) : null;
  }

  /** What the field is, for tools: its bits and its type. */
  get description() {
    const { name, isArray, indices, only, fixed, isConstant, parameter, isChecksum, counter, type } = this;
    const elements = this.elements.map((element) => element.segments);
    const { width, encoding, unit = null, enum: members = null, flags = null, noValues = null, names = null } = type;
    const own = { width, encoding, unit, enum: members, flags, linear: type.linear, range: type.range, noValues, names };
    return { name, elements, isArray, indices, only, fixed, isConstant, parameter, isChecksum, counter, type: own };
  }
}

class Message {
  constructor(table, layout) {
    this.direction = table.direction;
    this.command = table.command;
    this.rule = new IdRule(table);
    this.length = table.length;
    this.only = Object.entries(table.only ?? NOTHING);
    this.keys = (table.keys ?? []).map(({ segments, values }) => ({ bits: new Bits(segments), values }));
    const condition = ({ segments, values }) => ({ bits: new Bits(segments), values });
    this.confusions = (table.confusions ?? []).map(({ command, conditions }) => ({ command, conditions: conditions.map(condition) }));
    this.mask = table.mask ?? 0;
    this.layout = layout;
    this.layoutNumber = table.layout;
    this.nodeBits = table.node ? new Bits(table.node) : null;
    this.checksum = table.checksum ? new Checksum(table.checksum, layout.every) : null;
    const { sent, everyMs, timeoutMs, frames } = table;
    this.sending = { ...(sent && { sent }), ...(everyMs && { everyMs }), ...(timeoutMs && { timeoutMs }) };
    this.frames = frames ? { field: frames[0], first: frames[1], last: frames[2] } : null;
  }

  get description() {
    const { direction, command, rule, length, layout, layoutNumber } = this;
    const keys = this.keys.map(({ bits: { segments }, values }) => ({ segments, values }));
    const { base, step, nodes, extended, remote } = rule;
    const ofId = rule.parameter === null ? {} : { idParameter: rule.parameter, idParameterStep: rule.times };
    const fields = layout.every.map((field) => field.description);
    return { direction, command, base, step, nodes, extended, remote, length, keys, layout: layoutNumber, parameter: layout.parameter, fields, ...ofId, ...this.sending, ...(this.frames && { frames: this.frames }) };
  }

  node(frame, parameters) {
    return this.rule.node(frame, this.mask, parameters) ?? null;
  }

  /** The first difference between a frame and this message, as `{ refusal, text }`; null if the frame is this message. */
  difference(frame, parameters) {
    const wrong = (refusal, text) => ({ refusal, text: `this is no ${this.direction} of ${this.command}: ${text}` });
    if (this.rule.node(frame, this.mask, parameters) === undefined) {
      const isUnknown = this.rule.isOfKind(frame) && this.rule.offset(parameters) === undefined;
      return isUnknown ? wrong("missing_parameter", `its id contains ${this.rule.parameter}`) : wrong("unknown_id", "the id differs");
    }
    if (frame.data.length !== this.length && !frame.remote) {
      return wrong("wrong_length", `it has ${frame.data.length} data bytes`);
    }
    const hasKeys = this.keys.every((key) => key.values.includes(key.bits.read(frame)));
    return hasKeys ? null : wrong("unknown_code", "the code differs");
  }

  /** The node of a frame of this message: that in its id, or else in its data; null without one. */
  nodeOf(frame, parameters) {
    return this.nodeBits ? this.nodeBits.read(frame) : this.node(frame, parameters);
  }

  /** Throws CodecError if no node with these parameters has the command. */
  checkAvailable(parameters) {
    for (const [name, values] of this.only) {
      const value = parameters[name];
      if (value !== undefined && !values.includes(value)) {
        throw new CodecError("not_available", `${this.command} is available with ${name} ${values.join(" or ")}, not ${value}`);
      }
    }
  }

  /** The code of a frame of this message, undefined if it has one at most. */
  codeOf(frame) {
    return this.keys[0]?.values.length > 1 ? this.keys[0].bits.read(frame) : undefined;
  }

  /** Throws CodecError if a code is given that this message cannot have. */
  checkCode(code) {
    const codes = this.keys[0]?.values ?? [];
    if (code !== undefined && !codes.includes(code)) {
      throw new CodecError("unknown_code", `the ${this.direction} of ${this.command} has ${codes.map(hex).join(" or ") || "no code"}, not ${code}`);
    }
  }

  /** Throws CodecError if receivers identify a frame of this message as another one. */
  checkMeaning(frame) {
    const confusion = this.confusions.find(({ conditions }) => conditions.every(({ bits, values }) => values.includes(bits.read(frame))));
    if (confusion) {
      const data = Array.from(frame.data, (byte) => byte.toString(16).padStart(2, "0")).join(" ").toUpperCase();
      throw new CodecError("wrong_message", `the ${this.direction} of ${this.command} with these values is that of ${confusion.command}: ${data}`);
    }
  }

  /** Throws CodecError for a wrong constant or checksum; if it is unknown which fields there are, of those that there always are. */
  check(frame, parameters) {
    checkConstants(this.layout.common.constants, frame);
    this.checksum?.check(frame);
    checkConstants(this.layout.variant(parameters)?.conditional ?? [], frame);
  }

  /** The fields under some parameters. Throws CodecError if these do not determine the fields. */
  variant(parameters) {
    const variant = this.layout.variant(parameters);
    if (variant === null) {
      throw new CodecError("missing_parameter", `the fields of ${this.command} depend on ${this.layout.parameter}, which is not given`);
    }
    return variant;
  }

  /** The frame of checked raw integers and of a code, if it is given; bits without a field are 0. */
  write(node, raws, code, parameters) {
    const data = new Array(this.rule.remote ? 0 : this.length).fill(0);
    let id = this.rule.base + (this.rule.nodes ? node : 0) * this.rule.step + this.rule.offset(parameters);
    this.keys.forEach((key, i) => {
      id = key.bits.write((i === 0 ? code : undefined) ?? key.values[0], id, data);
    });
    for (const field of this.layout.variant(parameters).every.filter(({ isChecksum }) => !isChecksum)) {
      const raw = field.fixed ?? (field.parameter === null ? raws[field.name] : field.required(parameters));
      field.elements.forEach((element, i) => {
        id = element.write(Array.isArray(raw) ? raw[i] : raw, id, data);
      });
    }
    this.checksum?.write(id, data);
    return checkedFrame({ id, data, extended: this.rule.extended, remote: this.rule.remote });
  }
}

function checkConstants(constants, frame) {
  for (const field of constants) {
    checkConstant(field, field.fixed, frame);
  }
}

/** Throws CodecError if a frame has another raw integer in a constant. */
function checkConstant(field, raw, frame) {
  if (field.read(frame) !== raw) {
    throw rejection("wrong_constant", `the constant ${field.name} is not ${raw}`, [field.name, raw], field.name);
  }
}

/** The checksum of a frame, computed in a register of `width` bits: its poly and its init are aligned to the register. */
class Checksum {
  constructor({ field, arithmetic, width, poly = 0, init = 0, reflected = false, shift = 0, xor = 0, inputs }, fields) {
    Object.assign(this, { arithmetic, width, poly, init, reflected, shift, xor });
    this.field = fields[field];
    this.inputs = inputs.map((input) => (Array.isArray(input) ? new Bits(input) : input));
  }

  of(frame) {
    const bytes = this.inputs.map((input) => (input instanceof Bits ? input.read(frame) : input));
    return ((bytes.reduce((register, byte) => this.next(register, byte), this.init) >>> this.shift) ^ this.xor) >>> 0;
  }

  /** The register after one more byte. */
  next(register, byte) {
    if (this.arithmetic === "sum") {
      return (register + byte) % 2 ** this.width;
    }
    if (this.arithmetic === "xor") {
      return register ^ byte;
    }
    const { width, poly, reflected } = this;
    let next = register ^ (reflected ? byte : byte << (width - 8));
    for (let bit = 0; bit < 8; bit++) {
      const out = reflected ? next & 1 : (next >>> (width - 1)) & 1;
      next = (reflected ? next >>> 1 : next << 1) ^ (out ? poly : 0);
    }
    return next & (2 ** width - 1);
  }

  /** Throws CodecError if the field is not the checksum of a frame. */
  check(frame) {
    const { name } = this.field;
    const [found, computed] = [this.field.read(frame), this.of(frame)];
    if (found !== computed) {
      throw rejection("wrong_checksum", `${name} is ${hex(found)}, but the checksum of this frame is ${hex(computed)}`, [name, hex(found), hex(computed)], name);
    }
  }

  write(id, data) {
    this.field.elements[0].write(this.of({ id, data }), id, data);
  }
}

/** A frame with its meaning; immutable. */
class MessageResult {
  #message;
  #frame;

  constructor({ family, edition }, message, node, frame, raw, parameters) {
    const variant = message.layout.variant(parameters);
    const values = { ...variant.unfilled };
    for (const field of variant.fields) {
      values[field.name] = field.value(raw[field.name], parameters);
    }
    this.#message = message;
    this.family = family;
    this.edition = edition;
    this.direction = message.direction;
    this.command = message.command;
    this.node = node;
    const code = message.codeOf(frame);
    if (code !== undefined) {
      this.code = code;
    }
    this.parameters = parameters;
    this.#frame = frame;
    this.raw = variant.isWide ? forJSON(raw) : Object.freeze(raw);
    this.values = variant.isWide ? forJSON(values) : Object.freeze(values);
    Object.freeze(this);
  }

  get frame() {
    return frozen(this.#frame);
  }

  get fields() {
    const { raw, values, parameters } = this;
    const { fields } = this.#message.layout.variant(parameters);
    return Object.freeze(fields.map((field) => forJSON(field.result(raw[field.name], values[field.name], parameters))));
  }

  toJSON() {
    const { raw, values, ...about } = this;
    return withoutBigInt({ ...about, frame: this.frame, fields: this.fields, raw, values });
  }
}

/** The object, frozen and without BigInt in JSON. */
function forJSON(object) {
  const isOwn = Object.values(object).flat().some((item) => typeof item === "bigint");
  return Object.freeze(isOwn ? Object.defineProperty(object, "toJSON", { value: () => withoutBigInt(object) }) : object);
}

/** A value for JSON: a BigInt is a number if that is exact, otherwise text. */
function withoutBigInt(value) {
  if (typeof value === "bigint") {
    return Number.isSafeInteger(Number(value)) ? Number(value) : String(value);
  }
  if (Array.isArray(value)) {
    return value.map(withoutBigInt);
  }
  const isRecord = typeof value === "object" && value !== null;
  return isRecord ? Object.fromEntries(Object.entries(value).map(([name, item]) => [name, withoutBigInt(item)])) : value;
}

function frozen(value) {
  if (typeof value === "object" && value !== null && !Object.isFrozen(value)) {
    Object.values(value).forEach(frozen);
    forJSON(value);
  }
  return value;
}
