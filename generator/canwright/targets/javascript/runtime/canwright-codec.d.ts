/** A frame. `extended` means a 29-bit id, `remote` a frame without data that requests some; both are false if left out. */
export interface Frame {
  readonly id: number;
  /** The data bytes: an array, a `Uint8Array`, a `Buffer`, an `ArrayBuffer` or a `DataView`. */
  readonly data?: ArrayLike<number> | ArrayBuffer | DataView;
  readonly extended?: boolean;
  readonly remote?: boolean;
}

/** A frame with all its parts; immutable. */
export interface WrittenFrame extends Frame {
  readonly data: readonly number[];
  readonly extended: boolean;
  readonly remote: boolean;
}

/** Why a frame or a value is rejected; the same in all languages. */
export type Refusal =
  | "unknown_id"
  | "unknown_code"
  | "wrong_length"
  | "wrong_constant"
  | "missing_parameter"
  | "no_scale"
  | "out_of_range"
  | "not_finite"
  | "unknown_node"
  | "not_answer"
  | "not_available"
  | "wrong_checksum"
  | "no_value"
  | "wrong_message";

/** The value of a counter in the next frame; `counter` is the first and the last value, as `MESSAGES` has them. */
export function nextCount(counter: readonly [number, number], value: number): number;

/** So many increments lead from one value to another; 0 if they are equal, or if one of them is outside of the range. */
export function countSteps(counter: readonly [number, number], previous: number, value: number): number;

/** The counters of one sender: those of each message to or from each node increase separately. */
export class Numbering {
  /** `edition` is the module of an edition. */
  constructor(edition: {
    readonly MESSAGES: readonly MessageDescription[];
    readonly encodeRequest: (...given: any[]) => unknown;
    readonly encodeReply: (...given: any[]) => unknown;
  });
  /**
   * The message to send: the first of its command and node as it is, each further one with the next counters.
   * Throws as the encoder does; the counters do not increase then.
   */
  next<M extends Message<Direction, unknown, unknown, unknown>>(message: M): M;
}

/** A frame or a value is rejected. The error of a received frame has no `stack`. */
export class CodecError extends Error {
  readonly name: "CodecError";
  readonly refusal: Refusal;
  /** The field that caused it. */
  readonly field: string | undefined;
}

export type Direction = "request" | "reply";

/** The raw integer, the value and the accepted values of a field. */
export interface FieldOf<Raw, Value, Given> {
  readonly raw: Raw;
  readonly value: Value;
  readonly given: Given;
}

type Part<Fields, Name extends "raw" | "value"> = { readonly [F in keyof Fields]: Fields[F] extends FieldOf<any, any, any> | undefined ? NonNullable<Fields[F]>[Name] : never };
type GivenRaw<Fields> = { readonly [F in keyof Fields]: NonNullable<Fields[F]> extends FieldOf<infer Raw, any, any> ? (Raw extends readonly unknown[] ? readonly (number | bigint)[] : number | bigint) : never };
type GivenValue<Fields> = { readonly [F in keyof Fields]: NonNullable<Fields[F]> extends FieldOf<any, any, infer Given> ? Given : never };

/** The value of a field in one frame, of an array that of an element. */
export type Joined<Field> = NonNullable<Field> extends FieldOf<any, infer Value, any> ? (Value extends readonly (infer Element)[] ? Element : Value) : never;

/** A field of a message. */
export interface FieldResult {
  readonly name: string;
  readonly raw: number | bigint | readonly (number | bigint)[];
  readonly value: unknown;
  readonly unit: string | null;
  /** Why there is no value; null with a value. */
  readonly reason: Refusal | null;
  /** The name of the specification for no value of a number, such as `not_available`, or null; of an array, those of all elements. */
  readonly noValue: string | null | readonly (string | null)[];
  /** The name that a number has beside its value, such as `maximum`, or null; of an array, those of all elements. */
  readonly valueName: string | null | readonly (string | null)[];
}

/** One frame with its meaning; immutable. `values` are in units, and null where a raw integer has no value. */
export interface Message<D extends Direction, C, Fields, Parameters> {
  readonly family: string;
  readonly edition: string;
  readonly direction: D;
  readonly command: C;
  /** The node that receives or sends the frame; null if neither its id nor its data identifies it. */
  readonly node: number | null;
  /** The code of the frame, if receivers accept several. */
  readonly code?: number;
  readonly parameters: Parameters;
  readonly frame: WrittenFrame;
  readonly fields: readonly FieldResult[];
  readonly raw: Part<Fields, "raw">;
  readonly values: Part<Fields, "value">;
  /** The message without BigInt, for JSON: a BigInt is a number if that is exact, otherwise text. */
  toJSON(): object;
}

/** The content of a message: either values in units or raw integers, of all its fields; neither without fields. */
export type Content<Fields, Parameters, HasNode extends boolean> = {
  readonly parameters?: Parameters;
  /** One of the codes that receivers accept, such as that of a decoded message; the usual one if it is left out. */
  readonly code?: number | undefined;
} & (HasNode extends true ? { readonly node: number } : { /** Ignored: the id contains no node. */ readonly node?: number }) & (
  | { readonly values: GivenValue<Fields>; readonly raw?: undefined }
  | { readonly raw: GivenRaw<Fields>; readonly values?: undefined }
  | (keyof Fields extends never ? { readonly values?: undefined; readonly raw?: undefined } : never)
);

/** A message that a frame can be if its direction is unknown. */
export interface Candidate {
  readonly direction: Direction;
  readonly command: string;
  readonly node: number | null;
}

/** Bits of a frame: byte (-1 for the id), lowest bit, width, lowest bit of the raw integer. */
export type Segment = readonly [byte: number, low: number, width: number, rawLow: number];

/** An integer, or a quotient as text. */
export type Rational = number | bigint | string;

/** A bound of a range: a number, or constant, coefficient and name of a number parameter. */
export type Bound = Rational | readonly [constant: Rational, coefficient: Rational, parameter: string];

/** A fact, or the facts by the values of a parameter; null is unknown. */
export type Dependent<T> = T | null | { readonly by: string; readonly cases: { readonly [value: string]: T | null } };

/** value = (raw * factor + addend) / divisor, multiplied by the parameter `times`. Left out: 1, 0, 1. */
export interface Linear {
  readonly factor?: number | bigint;
  readonly addend?: number | bigint;
  readonly divisor?: number | bigint;
  readonly times?: string;
}

/** The bits and the type of a field. */
export interface FieldDescription {
  readonly name: string;
  /** The bits of the field; of an array, of each element. */
  readonly elements: readonly (readonly Segment[])[];
  readonly isArray: boolean;
  readonly indices: readonly number[] | null;
  /** The values of the parameter of the message under which the field exists; null for all. */
  readonly only: readonly string[] | null;
  /** Whether messages have the field as a value. */
  readonly isValue: boolean;
  /** The raw integer that a sender always writes. */
  readonly fixed: number | bigint | null;
  /** Whether a receiver rejects any other raw integer. */
  readonly isConstant: boolean;
  /** The parameter that is the raw integer of such a field; null if `fixed` is. */
  readonly parameter: string | null;
  /** Whether the sender computes the field from other bytes. */
  readonly isChecksum: boolean;
  /** First and last value of a counter, which the sender increments with each frame; null for another field. */
  readonly counter: readonly [number, number] | null;
  readonly type: {
    readonly width: number;
    readonly encoding: "unsigned" | "signed" | "float";
    readonly unit: string | null;
    readonly enum: readonly (readonly [value: number | bigint, name: string])[] | null;
    readonly flags: readonly (readonly [bit: number, name: string])[] | null;
    readonly linear: Dependent<Linear> | undefined;
    readonly range: Dependent<readonly [low: Bound, high: Bound]> | undefined;
    /** The raw integers of a number that have no value, each with its name; null without any. An encoder writes the last one. */
    readonly noValues: readonly (readonly [first: number | bigint, last: number | bigint, name: string])[] | null;
    /** The raw integers of a number that have a name beside their value; null without any. */
    readonly names: readonly (readonly [raw: number | bigint, name: string])[] | null;
  };
}

/** A message: how its frames are identified, and its fields. */
export interface MessageDescription {
  readonly direction: Direction;
  readonly command: string;
  /** The id is base + node * step, with the bits of keys and fields; plus idParameter * idParameterStep, if there is one. */
  readonly base: number;
  readonly step: number;
  readonly idParameter?: string;
  readonly idParameterStep?: number;
  /** First and last node; null for a fixed id. */
  readonly nodes: readonly [number, number] | null;
  readonly extended: boolean;
  readonly remote: boolean;
  readonly length: number;
  /** When it is sent, if the manual states more than that a reply answers its request. */
  readonly sent?: readonly ("cyclic" | "on_change" | "on_request" | "event")[];
  /** The nominal period of a cyclic frame. */
  readonly everyMs?: number;
  /** The silence that the receiver treats as a failure. */
  readonly timeoutMs?: number;
  /** The field with the number of the frame, the first and the last number, if there are several frames. */
  readonly frames?: { readonly field: string; readonly first: number; readonly last: number };
  /** Bits with their accepted values; the first value is sent. */
  readonly keys: readonly { readonly segments: readonly Segment[]; readonly values: readonly (number | bigint)[] }[];
  /** The position of its layout in the module of texts. */
  readonly layout: number;
  /** The parameter that decides which fields exist. */
  readonly parameter: string | null;
  readonly fields: readonly FieldDescription[];
}

/** The values of a choice, or the limits of a number. */
export interface ParameterDescription {
  readonly values?: readonly string[];
  readonly minimum?: Rational;
  readonly maximum?: Rational;
  /** Whether it is a whole number, as those in ids and constants are. */
  readonly whole?: boolean;
}
