/** What the generated functions of editions share: checks of frames and of what is given, and messages. */

import { compare, rational } from "./canwright-numbers.js";
import { CodecError, FieldType, own, rejection } from "./canwright-types.js";

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

/** The functions of an edition; its module declares them. */
export class Edition {
  #routes;
  #ofCommand = { request: new Map(), reply: new Map() };
  #explained;
  #names = []; // of the parameters of the last call, with their values, and what `checkParameters` made of them
  #values = [];
  #lastKnown = NOTHING;

  constructor({ family, edition, hash, replyWithin, parameters, messages, explained, answers, requests, replies }) {
    const routes = (each) => each.map(({ rule, message }) => ({ rule: new IdRule(rule), message }));
    this.#routes = { request: routes(requests), reply: routes(replies) };
    this.#explained = explained;
    for (const message of messages) {
      Object.assign(message, { family, edition });
      this.#ofCommand[message.direction].set(message.command, message);
    }
    for (const plan of answers) {
      const { command, answers: plans } = plan.request;
      plans.push(plan);
      this.#ofCommand.reply.set(command, plans[0].reply);
    }
    this.FAMILY = family;
    this.EDITION = edition;
    this.SPEC_HASH = hash;
    this.REPLY_WITHIN_MS = replyWithin;
    this.PARAMETERS = frozen(parameters);
    this.MESSAGES = frozen(messages.map((message) => message.description));
    Object.freeze(this);
  }

  decodeRequest = this.#decoder("request");
  decodeReply = this.#decoder("reply");

  decodeAs = (direction, command, given, parameters) => {
    const frame = checkedFrame(given);
    const [message, known] = [this.#message(direction, command), this.checkParameters(parameters)];
    const wrong = message.difference(frame, known);
    if (wrong) {
      throw wrong;
    }
    return message.decode(frame, known);
  };

  decodeAnswer = (request, given, parameters) => {
    const [frame, known] = [checkedFrame(given), this.checkParameters(parameters)];
    return this.#answer(request.frame, frame, known).decode(frame, known);
  };

  checkReply = (request, reply, parameters) => {
    this.#answer(request, checkedFrame(reply), this.checkParameters(parameters));
  };

  /** The values of a field of a reply of several frames, in the order of their numbers; those of arrays in one array. */
  join = (replies, field, last) => {
    const { frames } = this.#ofCommand.reply.get(replies[0]?.command) ?? {};
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
  };

  candidates = (given, parameters) => {
    const [frame, known] = [checkedFrame(given), this.checkParameters(parameters)];
    const explained = this.#explained.filter((message) => !message.difference(frame, known));
    const found = [this.#identify("reply", frame, known), ...explained, this.#identify("request", frame, known)];
    const candidates = new Set(found.filter((message) => message instanceof Definition));
    return Object.freeze(Array.from(candidates, (message) => Object.freeze({ direction: message.direction, command: message.command, node: message.nodeOf(frame, known) })));
  };

  rawOf = (direction, command, name, value, parameters) => {
    const known = this.checkParameters(parameters);
    return this.#field(direction, command, name, known).given(value, known, true);
  };

  /** Whether a sender can send a raw integer of a field; for tools. */
  allows = (direction, command, name, raw, parameters) => {
    const known = this.checkParameters(parameters);
    return this.#field(direction, command, name, known).allows(raw, known);
  };

  encodeRequest = (command, given) => this.#encode("request", command, given);
  encodeReply = (command, given) => this.#encode("reply", command, given);

  /** Parameters as the functions of messages need them; the same object for equal ones. Throws TypeError for an unknown one, RangeError for a value that it cannot have. */
  checkParameters(parameters = NOTHING) {
    const names = Object.keys(parameters);
    const isSame = (name, i) => name === this.#names[i] && parameters[name] === this.#values[i];
    if (names.length !== this.#names.length || !names.every(isSame)) {
      this.#lastKnown = this.#checked(parameters);
      this.#names = names;
      this.#values = Object.values(parameters);
    }
    return this.#lastKnown;
  }

  #checked(parameters) {
    const known = Object.create(null); // a parameter can have the name of a property of every object
    for (const [name, value] of Object.entries(parameters)) {
      const parameter = own(this.PARAMETERS, name);
      if (!parameter) {
        throw new TypeError(`there is no parameter ${JSON.stringify(name)}`);
      }
      if (value !== undefined && value !== null) {
        known[name] = checkedValue(parameter, name, value);
      }
    }
    return Object.freeze(known);
  }

  /** The message of a frame, or the error if it is none. */
  #identify(direction, frame, parameters) {
    const routes = this.#routes[direction];
    for (const { rule, message } of routes) {
      if (rule.node(frame, parameters) !== undefined) {
        return message(frame);
      }
    }
    const unknown = routes.find(({ rule }) => rule.lacksParameter(frame, parameters));
    if (unknown) {
      return rejection("missing_parameter", () => [`${hex(frame.id)} may be an id with the parameter ${unknown.rule.parameter}, which is not given`]);
    }
    return unknownId(direction, frame);
  }

  /** The function that decodes frames of one direction. It throws errors itself: each call between takes time. */
  #decoder(direction) {
    return (given, parameters) => {
      const [frame, known] = [checkedFrame(given), this.checkParameters(parameters)];
      const message = this.#identify(direction, frame, known);
      if (message instanceof CodecError) {
        throw message;
      }
      return message.decode(frame, known);
    };
  }

  #message(direction, command) {
    const message = this.#ofCommand[direction]?.get(command);
    if (!message) {
      throw new TypeError(`there is no ${direction} of ${JSON.stringify(command)}`);
    }
    return message;
  }

  #encode(direction, command, content = NOTHING) {
    const [message, known] = [this.#message(direction, command), this.checkParameters(content.parameters)];
    return message.decode(message.write(new Given(message, content, known), known), known);
  }

  #field(direction, command, name, known) {
    const field = this.#message(direction, command).fields(known).find((candidate) => candidate.name === name);
    if (!field) {
      throw new TypeError(`the ${direction} of ${command} has no field ${JSON.stringify(name)}`);
    }
    return field;
  }

  /** The message that a frame is as the reply to a request. Throws CodecError if it is none. */
  #answer(givenRequest, frame, parameters) {
    const request = checkedFrame(givenRequest);
    const message = this.#identify("request", request, parameters);
    if (message instanceof CodecError) {
      throw message;
    }
    message.check(request);
    let first;
    for (const plan of message.answers) {
      const reason = reasonAgainst(plan, request, frame, parameters);
      if (reason === "") {
        return plan.reply;
      }
      first ??= reason;
    }
    throw rejection("not_answer", () => [first ?? `${message.command} has no reply`]);
  }
}

/** The value of a choice as text, or that of a number. Throws RangeError if the parameter cannot have it. */
function checkedValue({ values, minimum, maximum, whole: isWhole }, name, value) {
  const refused = (text) => new RangeError(`${name} ${text}; leave it out if it is unknown`);
  if (values) {
    if (!values.includes(String(value))) {
      throw refused(`is none of ${values.join(", ")}`);
    }
    return String(value);
  }
  const number = rational(value);
  if (!number || (isWhole && number[0] % number[1])) {
    throw refused(`is no ${isWhole ? "whole " : ""}number`);
  }
  if ((minimum !== undefined && compare(number, rational(minimum)) < 0) || (maximum !== undefined && compare(number, rational(maximum)) > 0)) {
    throw refused(`must be from ${minimum ?? "-∞"} to ${maximum ?? "∞"}`);
  }
  return value;
}

/** Why a frame is not a reply to a request; empty if it is. */
function reasonAgainst({ request: message, reply, nodes: repliers = [], asked, reported, echo }, request, frame, parameters) {
  const wrong = reply.difference(frame, parameters);
  if (wrong) {
    return wrong.message;
  }
  const to = asked ? asked.read(request) : message.node(request, parameters);
  const mask = asked ? asked.mask : -1n;
  const nodes = repliers.length ? repliers : to === null ? [] : [to];
  const source = reply.node(frame, parameters);
  if (!isFrom(nodes, source, mask)) {
    return `it comes from node ${source}, not ${nodes.join(" or ")}`;
  }
  if (reported && !isFrom(nodes, reported.read(frame), mask & reported.mask)) {
    return `it comes from node ${reported.read(frame)}, not ${nodes.join(" or ")}`;
  }
  if (echo && !(request.data.length === frame.data.length && request.data.every((byte, i) => byte === frame.data[i]))) {
    return `the reply of ${message.command} is an echo, but this frame differs from the request`;
  }
  return "";
}

/** Whether a node is one of several in some bits, as far as it is known. */
function isFrom(nodes, source, mask) {
  return source === null || !nodes.length || nodes.some((node) => source === node || !((BigInt(source) ^ BigInt(node)) & mask));
}

/** A copy of a frame with all its parts. Throws TypeError if it is none. */
function checkedFrame({ id, data: given = [], extended = false, remote = false }) {
  const isBuffer = given?.length === undefined && given?.byteLength !== undefined; // an ArrayBuffer or a DataView
  const data = isBuffer ? new Uint8Array(given.buffer ?? given, given.byteOffset ?? 0, given.byteLength) : given;
  let isFrame = Number.isInteger(id) && id >= 0 && id < 2 ** 29 && Number.isInteger(data?.length);
  const bytes = Array.isArray(data) ? [...data] : isFrame ? copied(data) : [];
  for (const byte of bytes) {
    isFrame = isFrame && (byte & 0xff) === byte;
  }
  if (!isFrame) {
    throw new TypeError("a frame has an id of at most 29 bits, and bytes as data");
  }
  return { id, data: bytes, extended: Boolean(extended), remote: Boolean(remote) };
}

/** An array of what is no array: each kind has its own loop, which is faster. */
function copied(data) {
  const bytes = new Array(data.length);
  for (let i = 0; i < data.length; i++) {
    bytes[i] = data[i];
  }
  return bytes;
}

function hex(value) {
  return `0x${value.toString(16).toUpperCase()}`;
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

/** The ids of messages; `mask` are bits of keys and fields. */
class IdRule {
  constructor({ base, step = 1, parameter = null, times = 1, nodes = null, extended = false, remote = false, mask = 0 }) {
    Object.assign(this, { base, step, parameter, times, nodes, extended, remote, mask });
  }

  isOfKind(frame) {
    return this.extended === frame.extended && this.remote === frame.remote;
  }

  /** The part of the id that is a parameter; undefined if that is not given. */
  offset(parameters) {
    const value = this.parameter === null ? 0 : whole(parameters, this.parameter);
    return value === undefined ? undefined : value * this.times;
  }

  /** Whether the id of a frame can contain a parameter that is not given. */
  lacksParameter(frame, parameters) {
    return this.isOfKind(frame) && this.offset(parameters) === undefined;
  }

  /** The node of a frame, null for a fixed id, undefined if the id is not of this rule. */
  node(frame, parameters) {
    const offset = this.isOfKind(frame) ? this.offset(parameters) : undefined;
    if (offset === undefined) {
      return undefined;
    }
    const rest = (frame.id & ~this.mask) - this.base - offset;
    if (!this.nodes) {
      return rest === 0 ? null : undefined;
    }
    const node = rest / this.step;
    return Number.isInteger(node) && node >= this.nodes[0] && node <= this.nodes[1] ? node : undefined;
  }
}

/** The fields of messages; `values` are those of the parameter under which they are known. */
export function layoutsOf(types, layouts) {
  return layouts.map(({ parameter = null, values = [], fields }) => ({ parameter, values, every: fields.map((field) => new Field(field, types[field.type])) }));
}

export function typesOf(types) {
  return types.map((type) => new FieldType(type));
}

class Field {
  constructor({ hidden: isHidden = false, constant: isConstant = false, checksum: isChecksum = false, ...table }, type) {
    const { name, elements, indices = null, only = null, fixed = null, parameter = null, counter = null } = table;
    const isArray = indices !== null;
    Object.assign(this, { name, type, only, isArray, count: elements.length, isValue: !isHidden });
    this.description = { name, elements, isArray, indices, only, isValue: !isHidden, fixed, isConstant, parameter, isChecksum, counter, type: type.description }; // for tools
  }

  exists(value) {
    return this.only === null || this.only.includes(value);
  }

  /** The raw integers of given values or raw integers. Throws CodecError. */
  given(given, parameters, isValue) {
    const convert = (element) => (isValue ? this.type.raw(element, parameters, this.name) : this.type.check(element, parameters, this.name));
    if (!this.isArray) {
      return convert(given);
    }
    if (this.type.joined && isValue) {
      return Object.freeze(this.type.joined.raw(given, this.name, this.count));
    }
    if (!Array.isArray(given) || given.length !== this.count) {
      throw new CodecError("out_of_range", `${this.name} needs ${this.count} elements`, this.name);
    }
    return Object.freeze(given.map(convert));
  }

  allows(raw, parameters) {
    return [raw].flat().every((element) => this.type.allows(element, parameters));
  }

  result(raw, value, parameters) {
    const without = this.isArray && Array.isArray(value) ? value.indexOf(null) : value === null ? 0 : -1;
    const reason = without < 0 ? null : this.type.reason([raw].flat()[without], parameters);
    const noValue = this.named(raw, (element) => this.type.noValue(element));
    const valueName = this.named(raw, (element) => this.type.valueName(element));
    return { name: this.name, raw, value, unit: this.type.unit ?? null, reason, noValue, valueName };
  }

  /** The name of a raw integer, or those of all elements of an array; null without any. */
  named(raw, nameOf) {
    const names = [raw].flat().map(nameOf);
    return !this.isArray ? names[0] : names.some((name) => name !== null) ? Object.freeze(names) : null;
  }
}

/** A request or a reply: what it is, and its generated functions. */
export class Definition {
  constructor(layouts, about, { hasKeys = () => true, nodeInData = null, check = () => {}, read, write }) {
    const { direction, command, length, frames } = about;
    Object.assign(this, { about, direction, command, length, frames, hasKeys, nodeInData, check, read, write });
    this.layout = layouts[about.layout];
    this.rule = new IdRule(about);
    this.answers = []; // the plans of its replies
  }

  /** What the message is, for tools, under the names of `MessageDescription`; its mask is the bits of its keys and fields. */
  get description() {
    const { mask, parameter: idParameter, times: idParameterStep = 1, ...about } = this.about;
    const { parameter, every } = this.layout;
    const ofId = idParameter && { idParameter, idParameterStep };
    return { step: 1, nodes: null, extended: false, remote: false, keys: [], ...about, parameter, fields: every.map((field) => field.description), ...ofId };
  }

  /** The node in the id of a frame; null without one. */
  node(frame, parameters) {
    return this.rule.node(frame, parameters) ?? null;
  }

  /** The node of a frame of this message: that in its id, or else in its data; null without one. */
  nodeOf(frame, parameters) {
    return this.nodeInData ? this.nodeInData(frame) : this.node(frame, parameters);
  }

  /** The error of a frame that is not this message; null if it is. */
  difference(frame, parameters) {
    const wrong = (refusal, text) => rejection(refusal, () => [`this is no ${this.direction} of ${this.command}: ${text}`]);
    if (this.rule.node(frame, parameters) === undefined) {
      const isOpen = this.rule.lacksParameter(frame, parameters);
      return isOpen ? wrong("missing_parameter", `its id contains ${this.rule.parameter}`) : wrong("unknown_id", "the id differs");
    }
    if (frame.data.length !== this.length && !frame.remote) {
      return wrong("wrong_length", `it has ${frame.data.length} data bytes`);
    }
    return this.hasKeys(frame) ? null : wrong("unknown_code", "the code differs");
  }

  /** A frame of this message with its fields. Throws CodecError for a wrong constant or checksum, or if the fields are unknown. */
  decode(frame, parameters) {
    this.check(frame);
    return this.read(frame, this.nodeOf(frame, parameters), parameters);
  }

  /** The error if the parameter that decides on the fields is not given. */
  undetermined() {
    return new CodecError("missing_parameter", `the fields of ${this.command} depend on ${this.layout.parameter}, which is not given`);
  }

  /** The fields that have values under some parameters. Throws CodecError if these do not determine the fields. */
  fields(parameters) {
    const { parameter, values, every } = this.layout;
    if (parameter !== null && !values.includes(parameters[parameter])) {
      throw this.undetermined();
    }
    return every.filter((field) => field.isValue && field.exists(parameters[parameter]));
  }
}

/** What a program gives for a message; the encoder of the message asks for each part. */
class Given {
  constructor(message, { node = null, values, raw, code }, parameters) {
    Object.assign(this, { message, node, values, raw, code, parameters });
  }

  /** Throws CodecError if no node with these parameters has the command. */
  checkAvailable(name, values) {
    const value = this.parameters[name];
    if (value !== undefined && !values.includes(value)) {
      throw new CodecError("not_available", `${this.message.command} is available with ${name} ${values.join(" or ")}, not ${value}`);
    }
  }

  /** The code of the frame. Throws CodecError if a code is given that the message cannot have. */
  codeOf(codes) {
    if (this.code !== undefined && !codes.includes(this.code)) {
      const { direction, command } = this.message;
      throw new CodecError("unknown_code", `the ${direction} of ${command} has ${codes.map(hex).join(" or ") || "no code"}, not ${this.code}`);
    }
    return this.code ?? codes[0];
  }

  /** Throws TypeError without a node, CodecError if there is no such node. */
  checkNode(first, last) {
    if (!Number.isInteger(this.node)) {
      throw new TypeError(`${this.message.command} needs a node from ${first}..${last}`);
    }
    if (this.node < first || this.node > last) {
      throw new CodecError("unknown_node", `there is no node ${this.node}; nodes are ${first}..${last}`, "node", [`${first}..${last}`]);
    }
  }

  /** Throws CodecError without the parameter in the id. */
  checkParameter(name) {
    if (this.parameters[name] === undefined) {
      throw new CodecError("missing_parameter", `the id of ${this.message.command} contains ${name}, which is not given`);
    }
  }

  /** The raw integers of all fields, by name. Throws TypeError for missing or other fields, CodecError for invalid content. */
  raws(names) {
    const { values, raw, parameters, message } = this;
    const given = values ?? raw ?? NOTHING;
    const isWrong = Object.keys(given).length !== names.length || names.some((name) => !Object.hasOwn(given, name));
    if (isWrong || (values && raw)) {
      throw new TypeError(`the ${message.direction} of ${message.command} needs values, or raw integers, of: ${names.join(", ") || "no fields"}`);
    }
    const fields = message.fields(parameters).map((field) => [field.name, field.given(given[field.name], parameters, values !== undefined)]);
    return Object.fromEntries(fields);
  }

  /** The frame of an id without its node and its parameter, and of data. */
  frame(filled, data) {
    const { rule } = this.message;
    const id = rule.base + (rule.nodes ? this.node : 0) * rule.step + rule.offset(this.parameters);
    return { id: id | filled, data, extended: rule.extended, remote: rule.remote };
  }
}

/** Throws CodecError if a frame has another raw integer in a constant. */
export function checkConstant(found, raw, name) {
  if (found !== raw) {
    throw rejection("wrong_constant", () => [`the constant ${name} is not ${raw}`, name, raw], name);
  }
}

/** The raw integer of a constant that is a parameter. Throws CodecError if that is not given. */
export function required(parameters, parameter, name) {
  const value = whole(parameters, parameter);
  if (value === undefined) {
    throw new CodecError("missing_parameter", `the constant ${name} is ${parameter}, which is not given`, name);
  }
  return value;
}

/** The function of a checksum, computed in a register of `width` bits: its poly and its init are aligned to the register. */
export function checksum({ arithmetic, width, poly = 0, init = 0, reflected = false, shift = 0, xor = 0 }) {
  const shifted = (register) => {
    const out = reflected ? register & 1 : (register >>> (width - 1)) & 1;
    return (reflected ? register >>> 1 : register << 1) ^ (out ? poly : 0);
  };
  const next = {
    sum: (register, byte) => (register + byte) % 2 ** width,
    xor: (register, byte) => register ^ byte,
    crc: (register, byte) => {
      let next = register ^ (reflected ? byte : byte << (width - 8));
      for (let bit = 0; bit < 8; bit++) {
        next = shifted(next);
      }
      return next & (2 ** width - 1);
    },
  }[arithmetic];
  return (bytes) => ((bytes.reduce(next, init) >>> shift) ^ xor) >>> 0;
}

/** Throws CodecError if a field is not the checksum of its frame. */
export function checkChecksum(found, computed, name) {
  if (found !== computed) {
    const text = () => `${name} is ${hex(found)}, but the checksum of this frame is ${hex(computed)}`;
    throw rejection("wrong_checksum", () => [text(), name, hex(found), hex(computed)], name);
  }
}

/** The error of a frame that receivers identify as another message. */
export function wrongMessage({ direction, command }, meant, { data }) {
  const bytes = Array.from(data, (byte) => byte.toString(16).padStart(2, "0")).join(" ").toUpperCase();
  return new CodecError("wrong_message", `the ${direction} of ${command} with these values is that of ${meant}: ${bytes}`);
}

/** The error of a frame of which no message has the length. */
export function wrongLength({ id, data }, lengths) {
  return rejection("wrong_length", () => [`${hex(id)} has ${data.length} data bytes, not ${lengths.join(" or ")}`, hex(id), data.length, lengths]);
}

/** The error of a frame of which no message has the codes. */
export function unknownCode({ id }, direction, values) {
  const codes = () => values.map(hex);
  return rejection("unknown_code", () => [`no ${direction} on ${hex(id)} has the code ${codes().join(" and ")}`, hex(id), codes()]);
}

/** The error of a frame with an id of no message. */
function unknownId(direction, { id, extended, remote }) {
  const kind = (extended ? "29-bit " : "") + (remote ? "remote " : "");
  const digits = () => id.toString(16).toUpperCase().padStart(extended ? 8 : 3, "0");
  return rejection("unknown_id", () => [`no ${direction} has the ${kind}id ${hex(id)}`, `0x${digits()}${remote ? " RTR" : ""}`]);
}

/** The error of a frame with bits in its id that only other messages fill. */
export function unusedBits({ id }) {
  return rejection("unknown_id", () => [`${hex(id)} has bits that are 0 in the ids of this message`, hex(id)]);
}

class Exact {
  toJSON() {
    return withoutBigInt(this);
  }
}

/** What objects with BigInt inherit, so that JSON has them. */
export const EXACT = /* @__PURE__ */ new Exact();

/** A frame with its meaning; immutable. */
export class MessageResult {
  #message;
  #frame;

  constructor(message, node, parameters, frame, raw, values, code) {
    this.#message = message;
    this.family = message.family;
    this.edition = message.edition;
    this.direction = message.direction;
    this.command = message.command;
    this.node = node;
    if (code !== undefined) {
      this.code = code;
    }
    this.parameters = parameters;
    this.#frame = frame;
    this.raw = raw;
    this.values = values;
    Object.freeze(this);
  }

  get frame() {
    return frozen(this.#frame);
  }

  get fields() {
    const { raw, values, parameters } = this;
    return Object.freeze(this.#message.fields(parameters).map((field) => forJSON(field.result(raw[field.name], values[field.name], parameters))));
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
