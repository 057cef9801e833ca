// Ratios of times as JSON: the decoder of a generated edition beside a function by hand, both in turns of some milliseconds.

const edition = await import(process.argv[2]);

const TURNS = 101;
const TURN_MS = 4;

const REPLIES = [
  [0x9a, 0x19, 0x00, 0x20, 0x1c, 0x00, 0x00, 0x00],
  [0x9c, 0x32, 0x64, 0x00, 0xf4, 0x01, 0x00, 0x40],
  [0xa1, 0x32, 0x9c, 0xff, 0x0c, 0xfe, 0x00, 0xc0],
  [0x92, 0x32, 0x64, 0x00, 0xf4, 0x01, 0x00, 0x00],
].map((bytes) => ({ id: 0x141, data: Uint8Array.from(bytes) }));
const FOREIGN = { id: 0x7ff, data: new Uint8Array(8) };
const PARAMETERS = { series: "MG", encoder_bits: 18 };

/** What a firmware engineer writes for these replies: the fields in units, no check of values. */
function byHand({ id, data }) {
  if (id < 0x141 || id > 0x160 || data.length !== 8) {
    return null;
  }
  const view = new DataView(data.buffer, data.byteOffset, 8);
  const node = id - 0x140;
  switch (view.getUint8(0)) {
    case 0x9a:
      return { node, temperature: view.getInt8(1), voltage: view.getUint16(3, true) / 100, state: view.getUint8(6), errors: view.getUint8(7) };
    case 0x9c:
    case 0xa1:
      return {
        node,
        temperature: view.getInt8(1),
        current: (view.getInt16(2, true) * 33) / 2048,
        speed: view.getInt16(4, true),
        encoder: (view.getUint16(6, true) * 45) / 8192,
      };
    case 0x92:
      return { node, angle: Number(view.getBigInt64(0, true) >> 8n) / 100 };
  }
  return null;
}

const request = edition.encodeRequest("read_status_1", { node: 1 }).frame;
const asked = { frame: request };
const decode = (frame) => edition.decodeReply(frame, PARAMETERS).node;
const decodeStatus = () => decode(REPLIES[0]);

console.log(
  JSON.stringify({
    decode: ratio(overReplies(decode), overReplies((frame) => byHand(frame).node)),
    decodeAnswer: ratio(() => edition.decodeAnswer(asked, REPLIES[0], PARAMETERS).node, decodeStatus),
    foreign: ratio(() => refused(FOREIGN), overReplies(decode)),
  }),
);

function overReplies(work) {
  let turn = 0;
  return () => work(REPLIES[turn++ % REPLIES.length]);
}

function refused(frame) {
  try {
    decode(frame);
  } catch ({ refusal }) {
    return refusal.length;
  }
  throw new Error("a foreign frame was decoded");
}

/** The median of the ratios of two turns. */
function ratio(first, second) {
  const counts = [first, second].map((work) => {
    seconds(work, 20_000); // until it is compiled
    return Math.ceil(TURN_MS / 1000 / seconds(work, 2_000));
  });
  const ratios = Array.from({ length: TURNS }, () => seconds(first, counts[0]) / seconds(second, counts[1]));
  return ratios.sort((left, right) => left - right)[TURNS >> 1];
}

function seconds(work, count) {
  let sum = 0; // of results, so that none can be left out
  const from = process.hrtime.bigint();
  for (let i = 0; i < count; i++) {
    sum += work();
  }
  const wall = Number(process.hrtime.bigint() - from) / 1e9;
  return Number.isNaN(sum) ? Infinity : wall / count;
}
