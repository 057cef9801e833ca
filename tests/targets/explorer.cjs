// Runs the scripts of the frame explorer without its page, and interprets the frames of a file of JSON.

const { readFileSync } = require("node:fs");
const { join } = require("node:path");
const vm = require("node:vm");

const [folder, questions] = process.argv.slice(2);
const page = readFileSync(join(folder, "index.html"), "utf-8");
const context = vm.createContext({ TextDecoder, TextEncoder, atob });
for (const [, path] of page.matchAll(/<script src="([^"]*)">/g)) {
  if (path !== "explorer.js") {
    vm.runInContext(readFileSync(join(folder, path), "utf-8"), context, { filename: path });
  }
}
const canwright = vm.runInContext("canwright", context);
const replace = (_, value) => (typeof value === "bigint" ? { bigint: String(value) } : value);

/** The frame with another value of a field, or the reason for which there is none. */
function written(one, { name, value, raw }) {
  try {
    const changed = value === undefined ? raw : canwright.meaning.rawOf(one, name, value);
    return canwright.frames.format(canwright.meaning.encode(one, { raw: { ...one.decoded.raw, [name]: changed } }));
  } catch (error) {
    return error.refusal ?? String(error);
  }
}

/** What the lines of a log contain. */
function logged(lines) {
  const log = { frames: [], marks: new Set(), skipped: 0, errors: 0 };
  const parseRow = canwright.frames.tableParser(lines[0]);
  canwright.frames.parseLines(parseRow ? lines.slice(1) : lines, log, parseRow ?? canwright.frames.parseLine);
  const frames = log.frames.map((frame) => [frame.time, canwright.frames.withMark(frame)]);
  return { frames, skipped: log.skipped, errors: log.errors };
}

const answers = JSON.parse(readFileSync(questions, "utf-8")).map(({ log, line, parameters, enter, leading }) => {
  if (log) {
    return logged(log);
  }
  const { frame = null, problem = null } = line ? canwright.frames.parse(line) : {};
  return !frame ? problem : {
    frame: frame.id === null ? `-#${canwright.frames.format({ ...frame, id: 0 }).split("#")[1]}` : canwright.frames.format(frame),
    sent: frame.sent,
    time: frame.time,
    reasons: frame.id === null ? [] : canwright.meaning.reasons(frame, canwright.meaning.find(leading)),
    found: canwright.meaning.interpret(frame, parameters, leading).map((one) => ({
      edition: one.edition.name,
      direction: one.decoded.direction,
      command: one.decoded.command,
      node: one.decoded.node,
      raw: { ...one.decoded.raw },
      fields: one.decoded.fields.map((field) => ({ ...field })),
      deviation: one.deviation,
      timing: canwright.meaning.timing(one.message).flat(),
      obstacle: canwright.code.obstacle(one),
      series: one.variant?.values ?? null,
      c: canwright.code.obstacle(one) ? "" : canwright.code.c(one),
      python: canwright.code.obstacle(one) ? "" : canwright.code.python(one),
      cansend: canwright.code.cansend(one),
      entered: enter && written(one, { name: enter.name, value: enter.value }),
      entered_raw: enter && written(one, { name: enter.name, raw: enter.raw }),
    })),
  };
});
console.log(JSON.stringify(answers, replace));
