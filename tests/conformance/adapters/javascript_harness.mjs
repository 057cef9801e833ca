// Answers questions about one edition, one JSON line each. BigInt is written as {"bigint": "..."}.

import { createInterface } from "node:readline";
import { pathToFileURL } from "node:url";
import { isDeepStrictEqual } from "node:util";

const edition = await import(pathToFileURL(process.argv[2]).href);

const revive = (_, value) => (value && typeof value === "object" && "bigint" in value ? BigInt(value.bigint) : special(value));
const replace = (_, value) => {
  if (typeof value === "bigint") {
    return { bigint: String(value) };
  }
  return value;
};

function special(value) {
  const name = value && typeof value === "object" ? value.special : undefined;
  return name === undefined ? value : { nan: NaN, inf: Infinity, "-inf": -Infinity }[name];
}

function decoded(message) {
  if (![message, message.frame, message.frame.data, message.fields, message.raw, message.values].every(Object.isFrozen)) {
    throw new Error("a message is not immutable");
  }
  return { command: message.command, node: message.node, code: message.code, raw: { ...message.raw }, fields: message.fields.map((field) => ({ ...field })) };
}

/** The message of a frame that an encoder has written; a rejection of that frame is an error, not a refusal to encode. */
function decodedAgain(decode) {
  try {
    return decode();
  } catch (error) {
    throw new Error("an encoder has written a frame that is rejected", { cause: error });
  }
}

const tasks = {
  decode: ({ direction, frame, parameters }) =>
    decoded(edition[direction === "request" ? "decodeRequest" : "decodeReply"](frame, parameters)),
  decodeAs: ({ direction, command, frame, parameters }) => decoded(edition.decodeAs(direction, command, frame, parameters)),
  encode: ({ direction, command, content }) => {
    const message = edition[direction === "request" ? "encodeRequest" : "encodeReply"](command, content);
    const again = decodedAgain(() => edition.decodeAs(direction, command, message.frame, content.parameters));
    if (!isDeepStrictEqual(again, message)) {
      throw new Error(`${JSON.stringify(message, replace)} is decoded as ${JSON.stringify(again, replace)}`);
    }
    return message.frame;
  },
  answers: ({ request, reply, parameters }) => {
    edition.checkReply(request, reply, parameters);
    return null;
  },
  candidates: ({ frame }) => edition.candidates(frame),
};

for await (const line of createInterface({ input: process.stdin })) {
  const { task, ...question } = JSON.parse(line, revive);
  let answer;
  try {
    answer = { answer: tasks[task](question) };
  } catch (error) {
    answer = error instanceof edition.CodecError ? { refusal: error.refusal, field: error.field } : { error: String(error.stack) };
  }
  process.stdout.write(`${JSON.stringify(answer, replace)}\n`);
}
