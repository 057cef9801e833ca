// The bus load calculator: reads the data and the form of its page, and uses no network.
"use strict";

/** The load in percent, the time of one cycle in ms, and the highest rate in Hz, with as many stuff bits as there can be. */
function busLoad(command, nodes, rateHz, kbps, replyMs) {
  const request = command.request ? command.request[1] : 0;
  const reply = command.reply ? command.reply[1] * command.replies : 0;
  const bits = nodes * (request + reply);
  const cycleMs = bits / kbps + (command.request && command.reply ? nodes * (replyMs || 0) : 0);
  return { load: (bits * rateHz) / (kbps * 10), cycleMs, maximumHz: cycleMs > 0 ? 1000 / cycleMs : 0 };
}

function fill(select, values, label) {
  select.replaceChildren(...values.map((value, index) => new Option(label(value), String(index))));
}

function start(data) {
  const field = (name) => document.getElementById(name);
  const edition = () => data[Number(field("edition").value)];
  const update = () => {
    const one = edition();
    const found = busLoad(
      one.commands[Number(field("command").value)],
      Math.max(1, Number(field("nodes").value)),
      Math.max(0, Number(field("rate").value)),
      one.rates[Number(field("bitrate").value)],
      Number(field("reply").value),
    );
    field("load").textContent = found.load.toFixed(1) + " %";
    field("cycle").textContent = found.cycleMs.toFixed(3) + " ms";
    field("maximum").textContent = found.maximumHz.toFixed(0) + " Hz";
    field("load").className = found.load > 70 ? "high" : "";
  };
  const select = () => {
    const one = edition();
    fill(field("command"), one.commands, (command) => command.name + " · " + command.title);
    fill(field("bitrate"), one.rates, (rate) => rate + " kbit/s");
    field("nodes").value = String(Math.min(4, one.nodes));
    field("reply").value = String(one.replyMs || 0);
    update();
  };
  fill(field("edition"), data, (one) => one.edition);
  field("edition").addEventListener("change", select);
  for (const name of ["command", "nodes", "rate", "bitrate", "reply"]) field(name).addEventListener("input", update);
  select();
}

if (typeof document !== "undefined") start(JSON.parse(document.getElementById("data").textContent));
if (typeof module !== "undefined") module.exports = { busLoad };
