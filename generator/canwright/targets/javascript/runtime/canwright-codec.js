/** Identifies, decodes and encodes frames with the tables of one edition. */

import { rational } from "./canwright-numbers.js";
import { CodecError, FieldType, own } from "./canwright-types.js";

export { CodecError };

const ID = -1; // the `byte` of a segment in the CAN id
const NOTHING = Object.freeze(Object.create(null));

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
    decodeAnswer: (request, frame, parameters) => {
      const reply = codec.answer(directions.request, request.frame, frame);
      return codec.fields(reply.message, reply.node, checkedFrame(frame), codec.known(parameters));
    },
    checkReply: (request, reply) => {
      codec.answer(directions.request, request, reply);
    },
    candidates: (frame) => codec.candidates(directions, frame),
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
    this.answers = new Map();
    for (const { request, reply, nodes = [], asked = null, reported = null, echo = false } of tables.answers) {
      const bits = { asked: asked && new Bits(asked), reported: reported && new Bits(reported) };
      const { command } = this.messages[request];
      this.answers.set(this.messages[request], { reply: this.messages[reply], nodes, ...bits, echo });
      this.ofCommand.reply.set(command, this.messages[reply]);
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

  /** Parameters as the tables have them. Throws TypeError for an unknown one, RangeError for a value that it cannot have. */
  known(parameters = NOTHING) {
    if (KNOWN.has(parameters) && KNOWN.get(parameters) === this) {
      return parameters;
    }
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
    KNOWN.set(Object.freeze(known), this);
    return known;
  }

  identify(router, frame) {
    for (const { rule, mask, plan } of router.routes) {
      const node = rule.node(frame, mask);
      if (node !== undefined) {
        let step = plan;
        const path = [];
        while (step instanceof Select) {
          const value = step.read(frame);
          path.push([step, value]);
          step = step.cases.get(value) ?? step.otherwise;
        }
        if (step instanceof Reject) {
          throw step.error(router.direction, frame, path);
        }
        return { message: step, node };
      }
    }
    const kind = (frame.extended ? "29-bit " : "") + (frame.remote ? "remote " : "");
    throw new CodecError("unknown_id", `no ${router.direction} has the ${kind}id ${hex(frame.id)}`);
  }

  decode(router, given, parameters) {
    const frame = checkedFrame(given);
    const { message, node } = this.identify(router, frame);
    return this.fields(message, node, frame, this.known(parameters));
  }

  decodeAs(direction, command, given, parameters) {
    const frame = checkedFrame(given);
    const message = this.message(direction, command);
    const wrong = message.difference(frame);
    if (wrong) {
      throw wrong;
    }
    return this.fields(message, message.node(frame), frame, this.known(parameters));
  }

  /** The message of a frame with its fields. Throws CodecError for a wrong constant, or if the fields are unknown. */
  fields(message, node, frame, parameters) {
    message.checkConstants(frame, parameters);
    const raws = new Map(message.fields(parameters).map((field) => [field.name, field.read(frame)]));
    return this.result(message, node, frame, raws, parameters);
  }

  result(message, node, frame, raws, parameters) {
    const fields = message.fields(parameters).map((field) => field.result(raws.get(field.name), parameters));
    return new MessageResult({
      family: this.tables.family,
      edition: this.tables.edition,
      direction: message.direction,
      command: message.command,
      node: message.nodeOf(frame, node),
      parameters,
      frame,
      fields: Object.freeze(fields),
      raw: Object.freeze(Object.fromEntries(fields.map(({ name, raw }) => [name, raw]))),
      values: Object.freeze(Object.fromEntries(fields.map(({ name, value }) => [name, value]))),
    });
  }

  message(direction, command) {
    const message = this.ofCommand[direction]?.get(command);
    if (!message) {
      throw new TypeError(`there is no ${direction} of ${JSON.stringify(command)}`);
    }
    return message;
  }

  encode(direction, command, { node = null, values, raw, parameters } = NOTHING) {
    const message = this.message(direction, command);
    const known = this.known(parameters);
    message.checkAvailable(known);
    message.rule.check(node);
    const fields = message.fields(known);
    const given = values ?? raw ?? NOTHING;
    const wrong = Object.keys(given).length !== fields.length || fields.some(({ name }) => !Object.hasOwn(given, name));
    if (wrong || (values && raw)) {
      const names = fields.map(({ name }) => name).join(", ") || "no fields";
      throw new TypeError(`the ${direction} of ${command} needs values, or raw integers, of: ${names}`);
    }
    const raws = new Map(fields.map((field) => [field.name, field.given(given[field.name], known, values !== undefined)]));
    const frame = message.write(node, raws, known);
    return this.result(message, message.rule.nodes ? node : null, frame, raws, known);
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
    const field = this.message(direction, command).fields(known).find((candidate) => candidate.name === name);
    if (!field) {
      throw new TypeError(`the ${direction} of ${command} has no field ${JSON.stringify(name)}`);
    }
    return field;
  }

  /** The reply that a frame is to a request, with its node. Throws CodecError if it is none. */
  answer(requests, givenRequest, givenReply) {
    const request = checkedFrame(givenRequest);
    const frame = checkedFrame(givenReply);
    const { message, node } = this.identify(requests, request);
    message.checkConstants(request, NOTHING);
    const answer = this.answers.get(message);
    if (!answer) {
      throw notAnswer(`${message.command} has no reply`);
    }
    const { reply, asked, reported, echo } = answer;
    const wrong = reply.difference(frame);
    if (wrong) {
      throw notAnswer(wrong.message);
    }
    const to = asked ? asked.read(request) : node;
    const mask = asked ? asked.mask : -1n;
    const nodes = answer.nodes.length ? answer.nodes : to === null ? [] : [to];
    const source = reply.node(frame);
    checkSource(nodes, source, mask);
    if (reported) {
      checkSource(nodes, reported.read(frame), mask & reported.mask);
    }
    if (echo && !(request.data.length === frame.data.length && request.data.every((byte, i) => byte === frame.data[i]))) {
      throw notAnswer(`the reply of ${message.command} is an echo, but this frame differs from the request`);
    }
    return { message: reply, node: source };
  }

  candidates(directions, given) {
    const frame = checkedFrame(given);
    const candidates = [];
    const add = (message, node) => {
      if (!candidates.some((candidate) => candidate.message === message)) {
        candidates.push({ message, node: message.nodeOf(frame, node) });
      }
    };
    const identify = (router) => {
      try {
        const { message, node } = this.identify(router, frame);
        add(message, node);
      } catch (error) {
        if (!(error instanceof CodecError)) {
          throw error;
        }
      }
    };
    identify(directions.reply);
    for (const index of this.tables.explained) {
      if (!this.messages[index].difference(frame)) {
        add(this.messages[index], this.messages[index].node(frame));
      }
    }
    identify(directions.request);
    return Object.freeze(candidates.map(({ message: { direction, command }, node }) => Object.freeze({ direction, command, node })));
  }
}

const KNOWN = new WeakMap(); // parameters that an edition has checked

function choice(parameter, name, value) {
  if (!parameter.values.includes(String(value))) {
    throw new RangeError(`${name} is none of ${parameter.values.join(", ")}; leave it out if it is unknown`);
  }
  return String(value);
}

function number({ minimum = null, maximum = null }, name, value) {
  const ratio = rational(value);
  if (!ratio) {
    throw new RangeError(`${name} is no number; leave it out if it is unknown`);
  }
  const isLess = (bound) => ratio[0] * bound[1] < bound[0] * ratio[1];
  const isGreater = (bound) => ratio[0] * bound[1] > bound[0] * ratio[1];
  if ((minimum !== null && isLess(rational(minimum))) || (maximum !== null && isGreater(rational(maximum)))) {
    throw new RangeError(`${name} must be from ${minimum ?? "-∞"} to ${maximum ?? "∞"}; leave it out if it is unknown`);
  }
  return value;
}

/** Throws CodecError if a node is none of some nodes, in the bits of a mask. */
function checkSource(nodes, source, mask) {
  if (source !== null && nodes.length && nodes.every((node) => (BigInt(source) ^ BigInt(node)) & mask)) {
    throw notAnswer(`it comes from node ${source}, not ${nodes.join(" or ")}`);
  }
}

function notAnswer(text) {
  return new CodecError("not_answer", text);
}

/** A frame with all its parts, immutable. Throws TypeError if it is none. */
function checkedFrame({ id, data = [], extended = false, remote = false }) {
  const bytes = Array.from(data);
  const isId = Number.isInteger(id) && id >= 0 && id < 2 ** 29;
  if (!isId || !bytes.every((byte) => Number.isInteger(byte) && byte >= 0 && byte < 256)) {
    throw new TypeError("a frame has an id of at most 29 bits, and bytes as data");
  }
  return Object.freeze({ id, data: Object.freeze(bytes), extended: Boolean(extended), remote: Boolean(remote) });
}

function hex(value) {
  return `0x${value.toString(16).toUpperCase()}`;
}

/** Some bits of a frame that are an unsigned integer; a BigInt above 53 bits. Bytes beyond the data count as 0. */
class Bits {
  constructor(segments) {
    this.segments = segments;
    this.width = segments.reduce((width, [, , count]) => width + count, 0);
    this.mask = (1n << BigInt(this.width)) - 1n;
  }

  read(frame) {
    if (this.width > 53) {
      const join = (raw, [byte, low, count, rawLow]) => raw | (BigInt(bits(frame, byte, low, count)) << BigInt(rawLow));
      return this.segments.reduce(join, 0n);
    }
    let raw = 0;
    for (const [byte, low, count, rawLow] of this.segments) {
      raw += bits(frame, byte, low, count) * 2 ** rawLow;
    }
    return raw;
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

function bits(frame, byte, low, count) {
  const source = byte === ID ? frame.id : (frame.data[byte] ?? 0);
  return (source >>> low) & (2 ** count - 1);
}

class IdRule {
  constructor({ base, step = 1, nodes = null, extended = false, remote = false }) {
    Object.assign(this, { base, step, nodes, extended, remote });
  }

  /** The node of a frame, null for a fixed id, undefined if the id is not of this rule; `mask` are bits of keys and fields. */
  node(frame, mask) {
    if (this.extended !== frame.extended || this.remote !== frame.remote) {
      return undefined;
    }
    const rest = frame.id & ~mask;
    if (!this.nodes) {
      return rest === this.base ? null : undefined;
    }
    const node = (rest - this.base) / this.step;
    return Number.isInteger(node) && node >= this.nodes[0] && node <= this.nodes[1] ? node : undefined;
  }

  check(node) {
    if (this.nodes && !(Number.isInteger(node) && node >= this.nodes[0] && node <= this.nodes[1])) {
      throw new CodecError("unknown_node", `there is no node ${node}; nodes are ${this.nodes.join("..")}`, "node");
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
}

class Reject {
  constructor(reason) {
    this.reason = reason;
  }

  error(direction, frame, path) {
    let text = `${hex(frame.id)} has bits that are 0 in the ids of this message`;
    if (this.reason === "wrong_length") {
      const [select] = path.findLast(([select]) => select.isLength);
      text = `${hex(frame.id)} has ${frame.data.length} data bytes, not ${[...select.cases.keys()].join(" or ")}`;
    } else if (this.reason === "unknown_code") {
      const codes = path.filter(([select]) => select.bits).map(([, value]) => hex(value));
      text = `no ${direction} on ${hex(frame.id)} has the code ${codes.join(" and ")}`;
    }
    return new CodecError(this.reason, text);
  }
}

class Layout {
  constructor({ parameter = null, values = [], fields }, types) {
    this.parameter = parameter;
    this.values = values;
    this.every = fields.map((field) => new Field(field, types[field.type]));
    this.variants = new Map(values.map((value) => [value, this.every.filter((field) => field.exists(value))]));
  }

  /** All fields under some parameters; null if they are unknown. */
  variant(parameters) {
    return this.parameter === null ? this.every : (this.variants.get(parameters[this.parameter]) ?? null);
  }
}

class Field {
  constructor(table, type) {
    this.name = table.name;
    this.type = type;
    this.elements = table.elements.map((segments) => new Bits(segments));
    this.isArray = table.indices !== undefined;
    this.only = table.only ?? null;
    this.fixed = table.fixed ?? null;
    this.isConstant = table.constant ?? false;
    this.indices = table.indices ?? null;
  }

  exists(value) {
    return this.only === null || this.only.includes(value);
  }

  read(frame) {
    const raws = this.elements.map((element) => this.signed(element.read(frame)));
    return this.isArray ? Object.freeze(raws) : raws[0];
  }

  signed(raw) {
    return this.type.isSigned && raw > this.type.high ? this.type.integer(BigInt(raw) - (1n << BigInt(this.type.width))) : raw;
  }

  /** The raw integers of given values or raw integers. Throws CodecError. */
  given(given, parameters, isValue) {
    const convert = (element) => (isValue ? this.type.raw(element, parameters, this.name) : this.type.check(element, parameters, this.name));
    if (!this.isArray) {
      return convert(given);
    }
    if (!Array.isArray(given) || given.length !== this.elements.length) {
      throw new CodecError("out_of_range", `${this.name} needs ${this.elements.length} elements`, this.name);
    }
    return Object.freeze(given.map(convert));
  }

  result(raw, parameters) {
    const results = (this.isArray ? raw : [raw]).map((element) => this.type.value(element, parameters));
    const reason = results.find((result) => result.reason)?.reason ?? null;
    const value = this.isArray ? Object.freeze(results.map((result) => result.value)) : results[0].value;
    return Object.freeze({ name: this.name, raw, value, unit: this.type.unit ?? null, reason });
  }

  /** What the field is, for tools: its bits and its type. */
  get description() {
    const { name, isArray, indices, only, fixed, isConstant, type } = this;
    const elements = this.elements.map((element) => element.segments);
    const { width, encoding, unit = null, enum: names = null, flags = null } = type;
    const own = { width, encoding, unit, enum: names, flags, linear: type.linear, range: type.range };
    return { name, elements, isArray, indices, only, fixed, isConstant, type: own };
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
    this.mask = table.mask ?? 0;
    this.layout = layout;
    this.layoutNumber = table.layout;
    this.nodeBits = table.node ? new Bits(table.node) : null;
  }

  get description() {
    const { direction, command, rule, length, layout, layoutNumber } = this;
    const keys = this.keys.map(({ bits: { segments }, values }) => ({ segments, values }));
    const { base, step, nodes, extended, remote } = rule;
    const fields = layout.every.map((field) => field.description);
    return { direction, command, base, step, nodes, extended, remote, length, keys, layout: layoutNumber, parameter: layout.parameter, fields };
  }

  node(frame) {
    return this.rule.node(frame, this.mask) ?? null;
  }

  /** The first difference between a frame and this message, as an error; null if the frame is this message. */
  difference(frame) {
    const wrong = (refusal, text) => new CodecError(refusal, `this is no ${this.direction} of ${this.command}: ${text}`);
    if (this.rule.node(frame, this.mask) === undefined) {
      return wrong("unknown_id", "the id differs");
    }
    if (frame.data.length !== this.length && !frame.remote) {
      return wrong("wrong_length", `it has ${frame.data.length} data bytes`);
    }
    const hasKeys = this.keys.every((key) => key.values.includes(key.bits.read(frame)));
    return hasKeys ? null : wrong("unknown_code", "the code differs");
  }

  /** The node of a frame of this message: that in its id, or else in its data; null without one. */
  nodeOf(frame, inId) {
    return this.nodeBits ? this.nodeBits.read(frame) : inId;
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

  checkConstants(frame, parameters) {
    const chosen = (this.layout.variant(parameters) ?? []).filter((field) => field.only !== null);
    for (const field of [...this.layout.every.filter(({ only }) => only === null), ...chosen]) {
      if (field.isConstant && field.read(frame) !== field.fixed) {
        throw new CodecError("wrong_constant", `the constant ${field.name} is not ${field.fixed}`, field.name);
      }
    }
  }

  /** The fields that vary under some parameters. Throws CodecError if these do not determine the fields. */
  fields(parameters) {
    const variant = this.layout.variant(parameters);
    if (variant === null) {
      throw new CodecError("missing_parameter", `the fields of ${this.command} depend on ${this.layout.parameter}, which is not given`);
    }
    return variant.filter((field) => field.fixed === null);
  }

  /** The frame of checked raw integers; bits without a field are 0. */
  write(node, raws, parameters) {
    const data = new Array(this.rule.remote ? 0 : this.length).fill(0);
    let id = this.rule.base + (this.rule.nodes ? node : 0) * this.rule.step;
    for (const key of this.keys) {
      id = key.bits.write(key.values[0], id, data);
    }
    for (const field of this.layout.variant(parameters)) {
      const raw = field.fixed ?? raws.get(field.name);
      field.elements.forEach((element, i) => {
        id = element.write(Array.isArray(raw) ? raw[i] : raw, id, data);
      });
    }
    return checkedFrame({ id, data, extended: this.rule.extended, remote: this.rule.remote });
  }
}

/** A frame with its meaning; immutable. */
class MessageResult {
  constructor({ family, edition, direction, command, node, parameters, frame, fields, raw, values }) {
    this.family = family;
    this.edition = edition;
    this.direction = direction;
    this.command = command;
    this.node = node;
    this.parameters = parameters;
    this.frame = frame;
    this.fields = fields;
    this.raw = raw;
    this.values = values;
    Object.freeze(this);
  }

  toJSON() {
    return withoutBigInt({ ...this });
  }
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
    Object.freeze(value);
  }
  return value;
}
