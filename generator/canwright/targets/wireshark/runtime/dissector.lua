-- Registers the dissector of a family in Wireshark: fields, preferences, and the tree of a frame.

local codec, directions, family = ...

local can_id = Field.new("can.id")
local is_extended = Field.new("can.flags.xtd")
local is_remote = Field.new("can.flags.rtr")
local frame_time = Field.new("frame.time_epoch")
local interface = Field.new("frame.interface_id")

-- A protocol of Wireshark can have the name of the family.
local is_free, proto = pcall(Proto, family.name, family.name .. ": " .. family.title)
local prefix = family.name
if not is_free then
    prefix = family.name .. "_can"
    proto = Proto(prefix, prefix .. ": " .. family.title)
end

local function named(name)
    return prefix .. "." .. name
end

local meta = {
    edition = ProtoField.string(named("edition"), "Edition"),
    command = ProtoField.string(named("command"), "Command"),
    direction = ProtoField.string(named("direction"), "Direction"),
    rule = ProtoField.string(named("rule"), "Direction decided by"),
    node = ProtoField.uint32(named("node"), "Node"),
    request_in = ProtoField.framenum(named("request_in"), "Request in", base.NONE, frametype.REQUEST),
    reply_in = ProtoField.framenum(named("reply_in"), "Reply in", base.NONE, frametype.RESPONSE),
    latency = ProtoField.relative_time(named("latency"), "Latency"),
    rejected = ProtoField.string(named("rejected"), "Rejected"),
}

local experts = {
    rejected = ProtoExpert.new(
        named("expert.rejected"), "The frame is no message of this edition",
        expert.group.PROTOCOL, expert.severity.WARN
    ),
    no_reply = ProtoExpert.new(
        named("expert.no_reply"), "The request has no reply", expert.group.SEQUENCE, expert.severity.WARN
    ),
    parameter = ProtoExpert.new(
        named("expert.parameter"), "A value depends on a preference that is not set",
        expert.group.PROTOCOL, expert.severity.NOTE
    ),
    preference = ProtoExpert.new(
        named("expert.preference"), "A preference is invalid", expert.group.PROTOCOL, expert.severity.ERROR
    ),
}

local proto_fields, all_fields, all_experts = {}, {}, {}
for _, name in ipairs({
    "edition", "command", "direction", "rule", "node", "request_in", "reply_in", "latency", "rejected",
}) do
    all_fields[#all_fields + 1] = meta[name]
end
for _, name in ipairs({ "rejected", "no_reply", "parameter", "preference" }) do
    all_experts[#all_experts + 1] = experts[name]
end

local function integer_field(kind, name, label, members)
    return ProtoField[kind](named(name), label, base.DEC, members)
end

for _, entry in ipairs(family.fields) do
    local made = { flags = {}, kind = entry.kind, raw_kind = entry.raw }
    if entry.kind == "double" then
        made.value = ProtoField.double(named(entry.name), entry.label)
    else
        made.value = integer_field(entry.kind, entry.name, entry.label, entry.members)
    end
    all_fields[#all_fields + 1] = made.value
    if entry.raw then
        made.raw = integer_field(entry.raw, entry.name .. ".raw", entry.label .. " (raw)")
        all_fields[#all_fields + 1] = made.raw
    end
    for _, flag in ipairs(entry.flags) do
        made.flags[flag.name] = ProtoField.bool(named(entry.name .. "." .. flag.filter), flag.label)
        all_fields[#all_fields + 1] = made.flags[flag.name]
    end
    proto_fields[entry.field] = made
end
proto.fields = all_fields
proto.experts = all_experts

-- Preferences. The number 0 is the choice without an effect.

local prefs = proto.prefs

local function choices(none, texts)
    local listed = { { 1, none, 0 } }
    for number, text in ipairs(texts) do
        listed[#listed + 1] = { number + 1, text, number }
    end
    return listed
end

local edition_names = {}
for number, edition in ipairs(family.editions) do
    edition_names[number] = edition.name
end
prefs.edition = Pref.enum(
    "Edition", #family.editions == 1 and 1 or 0, "The edition of all nodes that are not listed below",
    choices("none", edition_names), false
)
prefs.nodes = Pref.string(
    "Nodes", "", "Editions and parameters of some nodes, for example 1-4: " .. family.example
)
for _, parameter in ipairs(family.parameters) do
    if parameter.values then
        prefs[parameter.preference] = Pref.enum(
            parameter.label, 0, parameter.about, choices("not set", parameter.values), false
        )
    else
        prefs[parameter.preference] = Pref.string(parameter.label, "", parameter.about)
    end
end
prefs.marks = Pref.enum(
    "Use direction marks", 0, "Whether the direction that the capture file gives decides on requests and replies",
    { { 1, "if a bus has both", 0 }, { 2, "always", 1 }, { 3, "never", 2 } }, false
)
prefs.sent = Pref.enum(
    "Frames marked as sent", 0, "Who sent the frames that the capture file marks as outbound",
    { { 1, "requests", 0 }, { 2, "replies", 1 } }, false
)
prefs.window = Pref.uint("Time for a reply in us", 2000, "A later frame is not the reply to a request")

-- The settings: default edition and parameters, those of nodes, and the text of the first mistake.
local settings, state, frames, ids

local function mistake(text)
    settings.mistake = settings.mistake or text
end

local function set_parameter(parameters, parameter, text)
    if parameter.values then
        for _, value in ipairs(parameter.values) do
            if value == text then
                parameters[parameter.name] = value
                return
            end
        end
        mistake(parameter.preference .. ": no value " .. text)
        return
    end
    local number = codec.rational(text)
    local value = number and number.numerator / number.denominator
    if not value or (parameter.minimum and value < parameter.minimum) or (parameter.maximum and value > parameter.maximum)
        or (parameter.positive and value <= 0) then
        mistake(parameter.preference .. ": invalid number " .. text)
        return
    end
    parameters[parameter.name] = number
end

local function named(items, text)
    for _, item in ipairs(items) do
        if item.name == text then
            return item
        end
    end
    return nil
end

-- One entry of the preference `nodes`, such as `1-4, 7: EDITION NAME=VALUE`.
local function set_nodes(entry)
    local list, rest = entry:match("^([^:]*):?(.*)$")
    local listed = { edition = settings.edition, parameters = {} }
    for name, value in pairs(settings.parameters) do
        listed.parameters[name] = value
    end
    for word in rest:gmatch("%S+") do
        local name, value = word:match("^(.-)=(.*)$")
        local parameter = name and named(family.parameters, name)
        local edition = not name and named(family.editions, word)
        if parameter then
            set_parameter(listed.parameters, parameter, value)
        elseif edition then
            listed.edition = edition
        else
            mistake("nodes: unknown " .. word)
        end
    end
    for part in list:gmatch("[^,%s]+") do
        local first, last = part:match("^(%d+)%-(%d+)$")
        first = tonumber(first or part:match("^%d+$"))
        last = tonumber(last) or first
        if first and last - first < 65536 then
            for node = first, last do
                settings.nodes[node] = listed
            end
        else
            mistake("nodes: invalid " .. part)
        end
    end
end

local function read_settings()
    settings = { nodes = {}, parameters = {}, edition = family.editions[prefs.edition] }
    for _, parameter in ipairs(family.parameters) do
        local chosen = prefs[parameter.preference]
        if parameter.values then
            settings.parameters[parameter.name] = parameter.values[chosen]
        elseif chosen ~= "" then
            set_parameter(settings.parameters, parameter, chosen)
        end
    end
    for entry in prefs.nodes:gmatch("[^;]+") do
        set_nodes(entry)
    end
end

local function reset()
    read_settings()
    state = directions.new(prefs.window * 1000)
    frames, ids = {}, {}
end

proto.init = reset
proto.prefs_changed = reset

local function edition_of(node)
    local listed = node and settings.nodes[node]
    if listed then
        return listed.edition
    end
    return settings.edition
end

-- The edition of the frames with an id, and their direction if it is always the same; nil for an unknown id. A frame
-- without a node can be of any edition in use; the default edition comes first.
local function find_edition(frame)
    local used = { settings.edition }
    for _, edition in ipairs(family.editions) do
        for _, listed in pairs(settings.nodes) do
            if listed.edition == edition and edition ~= settings.edition then
                used[#used + 1] = edition
                break
            end
        end
    end
    for _, edition in pairs(used) do
        local nodes, is_request, is_reply = codec.nodes(edition, frame)
        for _, node in ipairs(nodes) do
            if node == false or edition_of(node) == edition then
                local only
                if not (is_request and is_reply) then
                    only = is_request and "request" or "reply"
                end
                return { edition = edition, only = only }
            end
        end
    end
    return nil
end

local function of_id(frame)
    local key = string.format("%d %s %s", frame[0], tostring(frame.extended), tostring(frame.remote))
    if ids[key] == nil then
        ids[key] = find_edition(frame) or false
    end
    return ids[key]
end

local function last(values)
    return values[#values] and values[#values].value
end

local function read_frame(tvb)
    local id = { can_id() }
    if #id == 0 then
        return nil
    end
    local frame = {
        [0] = last(id),
        length = tvb:len(),
        extended = last({ is_extended() }) == true,
        remote = last({ is_remote() }) == true,
    }
    if not frame.remote then
        for index = 1, frame.length do
            frame[index] = tvb(index - 1, 1):uint()
        end
    end
    return frame, #id
end

local MARKS = { [P2P_DIR_SENT] = "sent", [P2P_DIR_RECV] = "received" }

local function judge(frame, pinfo, known)
    local time = frame_time().value
    local source = interface()
    return directions.judge(state, known.edition, known.only, frame, {
        bus = source and source.value or 0,
        time = { time.secs, time.nsecs },
        mark = prefs.marks ~= 2 and MARKS[pinfo.p2p_dir] or nil,
        trusts_marks = prefs.marks == 1,
        sent = prefs.sent == 0 and "request" or "reply",
        number = pinfo.number,
        is_first_pass = not pinfo.visited,
    })
end

local function range_of(tvb, segments)
    local first, after
    for _, segment in ipairs(segments) do
        if segment[1] > 0 then
            first = math.min(first or segment[1], segment[1])
            after = math.max(after or segment[1], segment[1])
        end
    end
    if not first or after > tvb:len() then
        return nil
    end
    return tvb(first - 1, after - first + 1)
end

-- Adds a value with the bytes that have it; a value of the id has none.
local function add(tree, field, range, value)
    if range then
        return tree:add(field, range, value)
    end
    return tree:add(field, value)
end

local function integer(kind, raw)
    if kind == "uint32" or kind == "int32" then
        return raw.number
    end
    local high = raw.high < 0 and raw.high + 4294967296 or raw.high
    return kind == "int64" and Int64.new(raw.low, high) or UInt64.new(raw.low, high)
end

local function shown_integer(raw)
    if math.abs(raw.number) <= 9007199254740992 then
        return string.format("%.0f", raw.number)
    end
    return tostring(integer(raw.high < 0 and "int64" or "uint64", raw))
end

-- The shortest text of a number.
local function shown_number(number)
    for digits = 15, 17 do
        local text = string.format("%." .. digits .. "g", number)
        if tonumber(text) == number then
            return text
        end
    end
    return tostring(number)
end

local function shown_value(decoded)
    local type_ = decoded.field.type
    if type_.flags then
        return #decoded.value > 0 and table.concat(decoded.value, ", ") or "none"
    end
    if type_.enum then
        return decoded.value or ("unknown " .. shown_integer(decoded.raw))
    end
    if decoded.value == nil then
        return "raw " .. shown_integer(decoded.raw)
    end
    local text = type_.plain and shown_integer(decoded.raw) or shown_number(decoded.value)
    return type_.unit and text .. " " .. type_.unit or text
end

local function label_of(decoded)
    return decoded.index and string.format("%s[%d]", decoded.field.label, decoded.index) or decoded.field.label
end

local function add_field(tree, tvb, decoded)
    local known = proto_fields[decoded.field.name]
    local range = range_of(tvb, decoded.segments)
    local text = label_of(decoded) .. ": " .. shown_value(decoded)
    local item
    if known.kind ~= "double" then
        item = add(tree, known.value, range, integer(known.kind, decoded.raw))
    else
        local number = decoded.value
        if decoded.field.type.enum or decoded.field.type.flags then
            number = decoded.raw.number
        end
        if number then
            item = add(tree, known.value, range, number)
        end
        local raw = add(item or tree, known.raw, range, integer(known.raw_kind, decoded.raw))
        raw:set_text(label_of(decoded) .. " (raw): " .. shown_integer(decoded.raw))
        item = item or raw
    end
    item:set_text(text)
    for _, flag in ipairs(decoded.field.type.flags or {}) do
        local is_set = codec.has_flag(decoded.raw, flag.bit)
        add(item, known.flags[flag.name], range, is_set):set_text(flag.label .. ": " .. (is_set and "1" or "0"))
    end
    if decoded.reason == "missing_parameter" then
        item:add_proto_expert_info(experts.parameter)
    end
    return decoded.field.name .. (decoded.index and "[" .. decoded.index .. "]" or "") .. " " .. shown_value(decoded)
end

local function reject(tree, reason, text)
    tree:add(meta.rejected, reason):set_generated()
    tree:add_proto_expert_info(experts.rejected, text or reason)
    return "rejected: " .. (text or reason)
end

local function add_exchange(tree, result, pinfo)
    local request = result.exchange
    if request then
        tree:add(meta.request_in, request.number):set_generated()
        if result.latency then
            local latency = result.latency
            local seconds = math.floor(latency / 1000000000)
            tree:add(meta.latency, NSTime.new(seconds, math.floor(latency - seconds * 1000000000))):set_generated()
        end
    end
    local opened = result.opened
    if opened then
        for _, number in ipairs(opened.replies) do
            tree:add(meta.reply_in, number):set_generated()
        end
        if pinfo.visited and result.is_first_pass and opened.missing > 0 then
            tree:add_proto_expert_info(experts.no_reply)
        end
    end
end

local function parameters_of(node)
    local listed = node and settings.nodes[node]
    return listed and listed.parameters or settings.parameters
end

-- Adds what a frame means; the texts of its values are the info column.
local function add_frame(tree, tvb, pinfo, result)
    local frame, message = result.frame, result.message
    tree:add(meta.edition, result.edition.name):set_generated()
    tree:add(meta.direction, result.direction):set_generated()
    tree:add(meta.rule, result.rule):set_generated()
    local title = result.direction
    if message then
        tree:add(meta.command, message.command):set_generated()
        title = message.command .. " " .. message.direction
    end
    if result.node then
        tree:add(meta.node, result.node):set_generated()
        title = string.format("%s, node %d", title, result.node)
    end
    add_exchange(tree, result, pinfo)
    local texts = {}
    if not message then
        texts[1] = reject(tree, result.reason)
    else
        local fields, reason, parameter = codec.decode(message, frame, parameters_of(result.node))
        if not fields then
            texts[1] = reject(tree, reason, parameter and reason .. ": " .. parameter)
        else
            for _, decoded in ipairs(fields) do
                texts[#texts + 1] = add_field(tree, tvb, decoded)
            end
        end
    end
    tree:set_text(family.name .. " " .. result.edition.name .. ", " .. title)
    if #texts > 0 then
        title = title .. ": " .. table.concat(texts, ", ")
    end
    return title
end

local function result_of(frame, occurrence, pinfo, known)
    local of_packet = frames[pinfo.number]
    if not of_packet then
        of_packet = {}
        frames[pinfo.number] = of_packet
    end
    local result = of_packet[occurrence]
    if not result then
        result = judge(frame, pinfo, known)
        of_packet[occurrence] = result
    end
    return result
end

local function hint(tvb, tree, frame)
    if settings.mistake or prefs.edition ~= 0 or next(settings.nodes) then
        return
    end
    for _, edition in ipairs(family.editions) do
        if #codec.nodes(edition, frame) > 0 then
            tree:add(proto, tvb()):set_text(
                family.name .. ": choose the edition in Edit, Preferences, Protocols, " .. string.upper(prefix)
            )
            return
        end
    end
end

function proto.dissector(tvb, pinfo, tree)
    local frame, occurrence = read_frame(tvb)
    if not frame then
        return 0
    end
    local known = of_id(frame)
    if not known then
        hint(tvb, tree, frame)
        return 0
    end
    local result = result_of(frame, occurrence, pinfo, known)
    local branch = tree:add(proto, tvb())
    if settings.mistake then
        branch:add_proto_expert_info(experts.preference, settings.mistake)
    end
    pinfo.cols.protocol = string.upper(family.name)
    pinfo.cols.info = add_frame(branch, tvb, pinfo, result)
    return math.max(1, tvb:len())
end

proto:register_heuristic("can", function(tvb, pinfo, tree)
    return proto.dissector(tvb, pinfo, tree) > 0
end)
