// The bus load calculator: reads the data and the form of its page, and uses no network.
"use strict";

/**
 * The load in percent, the time to send every command once in ms, and the highest rate of that in Hz, with as many stuff
 * bits as there can be. `rows` have a command and a rate; a command is sent once to each node, or once to all of them.
 * `cyclic` are frames that are sent without a request, each with its period.
 */
function busLoad(rows, nodes, kbps, replyMs, cyclic) {
  let load = 0;
  for (const { bits, everyMs, perNode } of cyclic) {
    load += ((perNode ? nodes : 1) * bits[1] * 100) / (kbps * everyMs);
  }
  let cycleMs = 0;
  for (const { command, rateHz } of rows) {
    const times = command.perNode ? nodes : 1;
    const request = command.request ? command.request[1] : 0;
    const reply = command.reply ? command.reply[1] * command.replies : 0;
    const bits = times * (request + reply);
    load += (bits * rateHz) / (kbps * 10);
    cycleMs += bits / kbps + (command.request && command.reply ? times * (replyMs || 0) : 0);
  }
  return { load, cycleMs, maximumHz: cycleMs > 0 ? 1000 / cycleMs : 0 };
}

function fill(select, values, label) {
  select.replaceChildren(...values.map((value, index) => new Option(label(value), String(index))));
}

function start(data) {
  const field = (name) => document.getElementById(name);
  const edition = () => data[Number(field("edition").value)];
  const rows = () => [...field("rows").children];
  const update = () => {
    const one = edition();
    const found = busLoad(
      rows().map((row) => ({
        command: one.commands[Number(row.querySelector("select").value)],
        rateHz: Math.max(0, Number(row.querySelector("input").value)),
      })),
      Math.max(1, Number(field("nodes").value)),
      one.rates[Number(field("bitrate").value)],
      Number(field("reply").value),
      one.cyclic,
    );
    field("cyclic").hidden = one.cyclic.length === 0;
    field("cyclic").lastElementChild.textContent = one.cyclic.map((frame) => frame.name + " · " + frame.everyMs + " ms").join(", ");
    field("load").textContent = found.load.toFixed(1) + " %";
    field("cycle").textContent = found.cycleMs.toFixed(3) + " ms";
    field("maximum").textContent = found.maximumHz.toFixed(0) + " Hz";
    field("load").className = found.load > 70 ? "high" : "";
    rows().forEach((row) => (row.querySelector("button").hidden = rows().length === 1));
  };
  const add = () => {
    const row = field("row").content.firstElementChild.cloneNode(true);
    const one = edition();
    fill(row.querySelector("select"), one.commands, (command) => command.name + " · " + command.title);
    row.querySelector("select").value = String(one.usual);
    row.querySelector("button").addEventListener("click", () => {
      row.remove();
      update();
    });
    field("rows").append(row);
    update();
  };
  const select = () => {
    const one = edition();
    fill(field("bitrate"), one.rates, (rate) => rate + " kbit/s");
    field("nodes").value = String(Math.min(4, one.nodes));
    field("reply").value = String(one.replyMs || 0);
    field("rows").replaceChildren();
    add();
  };
  fill(field("edition"), data, (one) => one.edition);
  field("edition").addEventListener("change", select);
  field("add").addEventListener("click", add);
  for (const name of ["rows", "nodes", "bitrate", "reply"]) field(name).addEventListener("input", update);
  select();
}

if (typeof document !== "undefined") start(JSON.parse(document.getElementById("data").textContent));
if (typeof module !== "undefined") module.exports = { busLoad };
