-- Registers the dissector of a family in Wireshark: fields, preferences, and the tree of a frame.

local codec, directions, family = ...

local can_id = Field.new("can.id")
local is_extended = Field.new("can.flags.xtd")
local is_remote = Field.new("can.flags.rtr")
local interface = Field.new("frame.interface_id")

-- A protocol of Wireshark can have the name of the family.
local is_free, proto = pcall(Proto, family.name, family.name .. ": " .. family.title)
local prefix = family.name
if not is_free then
    prefix = family.name .. "_can"
    proto = Proto(prefix, prefix .. ": " .. family.title)
end

local column = string.upper(family.name)

local function named(name)
    return prefix .. "." .. name
end

local all_fields, proto_fields, meta = {}, {}, {}

local function add_proto_field(kind, name, label, ...)
    local made = ProtoField[kind](named(name), label, ...)
    all_fields[#all_fields + 1] = made
    return made
end

local function add_meta(name, label, kind, ...)
    meta[name] = add_proto_field(kind or "string", name, label, ...)
end

add_meta("edition", "Edition")
add_meta("command", "Command")
add_meta("sending", "Timing")
add_meta("direction", "Direction")
add_meta("rule", "Direction decided by")
add_meta("node", "Node", "uint32")
add_meta("request_in", "Request in", "framenum", base.NONE, frametype.REQUEST)
add_meta("reply_in", "Reply in", "framenum", base.NONE, frametype.RESPONSE)
add_meta("latency", "Latency", "relative_time")
add_meta("rejected", "Rejected")

local all_experts, experts = {}, {}

local function add_expert(name, text, group, severity)
    experts[name] = ProtoExpert.new(named("expert." .. name), text, expert.group[group], expert.severity[severity])
    all_experts[#all_experts + 1] = experts[name]
end

add_expert("rejected", "The frame is no message of this edition", "PROTOCOL", "WARN")
add_expert("no_reply", "The request has no reply", "SEQUENCE", "WARN")
add_expert("parameter", "A value depends on a preference that is not set", "PROTOCOL", "NOTE")
add_expert("preference", "A preference is invalid", "PROTOCOL", "ERROR")

for _, entry in ipairs(family.fields) do
    local made = { flags = {}, kind = entry.kind, raw_kind = entry.raw }
    if entry.kind == "double" or entry.kind == "string" then
        made.value = add_proto_field(entry.kind, entry.name, entry.label)
    else
        made.value = add_proto_field(entry.kind, entry.name, entry.label, base.DEC, entry.members)
    end
    if entry.raw then
        made.raw = add_proto_field(entry.raw, entry.name .. ".raw", entry.label .. " (raw)", base.DEC)
    end
    for _, flag in ipairs(entry.flags) do
        made.flags[flag.name] = add_proto_field("bool", entry.name .. "." .. flag.filter, flag.label)
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
    { { 1, "if a node has both", 0 }, { 2, "always", 1 }, { 3, "never", 2 } }, false
)
prefs.sent = Pref.enum(
    "Frames marked as sent", 0, "Who sent the frames that the capture file marks as outbound",
    { { 1, "requests", 0 }, { 2, "replies", 1 } }, false
)
prefs.window = Pref.uint("Time for a reply in us", 2000, "A later frame is not the reply to a request")

-- The settings: default edition and parameters, those of nodes, and the text of the first mistake. `results` are those of
-- the first, second, ... CAN frame of a packet, each by the number of the packet; `noted` are the packets with a note that is
-- given once; `is_complete` says whether all results are from the first pass.
local settings, state, results, ids, noted, is_complete
local own_dissector

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
        or (parameter.positive and value <= 0) or (parameter.whole and value ~= math.floor(value)) then
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
    settings = {
        nodes = {}, parameters = {}, edition = family.editions[prefs.edition], has_marks = prefs.marks ~= 2,
    }
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
    settings.is_asleep = prefs.edition == 0 and not next(settings.nodes) and not settings.mistake
    local listed = { settings.parameters }
    for _, of_node in pairs(settings.nodes) do
        listed[#listed + 1] = of_node.parameters
    end
    for _, edition in ipairs(family.editions) do
        codec.configure(edition, listed)
    end
end

-- The edition and the parameters of a node, or of those that are not listed.
local function settings_of(node)
    return node and settings.nodes[node] or settings
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
            if node == false or settings_of(node).edition == edition then
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

local function of_id(id, is_extended_id, is_remote_frame)
    local key = id + (is_extended_id and 0x20000000 or 0) + (is_remote_frame and 0x40000000 or 0)
    if ids[key] == nil then
        ids[key] = find_edition({ [0] = id, length = 0, extended = is_extended_id, remote = is_remote_frame }) or false
    end
    return ids[key]
end

-- The value of the last field, and how many there are.
local function last(...)
    local count = select("#", ...)
    if count == 0 then
        return nil, 0
    end
    return select(count, ...).value, count
end

local MARKS = { [P2P_DIR_SENT] = "sent", [P2P_DIR_RECV] = "received" }

local function bytes_of(tvb, length)
    if length > 0 then
        return tvb:raw(0, length):byte(1, -1)
    end
end

-- The frame that an id begins.
local function read_frame(tvb, pinfo, id, is_extended_id, is_remote_frame)
    local length = tvb:len()
    return {
        [0] = id,
        length = length,
        extended = is_extended_id,
        remote = is_remote_frame,
        number = pinfo.number,
        time = math.floor(pinfo.rel_ts * 1000000000 + 0.5),
        mark = settings.has_marks and MARKS[pinfo.p2p_dir] or nil,
        bytes_of(tvb, is_remote_frame and 0 or length),
    }
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

local function integer(kind, decoded)
    if kind == "uint32" or kind == "int32" then
        return decoded.number
    end
    local high = decoded.high < 0 and decoded.high + 4294967296 or decoded.high
    return kind == "int64" and Int64.new(decoded.low, high) or UInt64.new(decoded.low, high)
end

local function shown_integer(decoded)
    if math.abs(decoded.number) <= 9007199254740992 then
        return string.format("%.0f", decoded.number)
    end
    return tostring(integer(decoded.high < 0 and "int64" or "uint64", decoded))
end

local FORMS = { "%.15g", "%.16g", "%.17g" }

-- The shortest text of a number.
local function shown_number(number)
    for _, form in ipairs(FORMS) do
        local text = string.format(form, number)
        if tonumber(text) == number then
            return text
        end
    end
    return tostring(number)
end

local function shown_value(decoded)
    local type_ = decoded.field.type
    if decoded.raws then
        return type_.text and decoded.value or decoded.value and string.format("%.0f", decoded.value)
            or "digits " .. table.concat(decoded.raws, " ")
    end
    if type_.flags then
        return #decoded.value > 0 and table.concat(decoded.value, ", ") or "none"
    end
    if type_.enum then
        return decoded.value or ("unknown " .. shown_integer(decoded))
    end
    if decoded.no_value then
        return decoded.no_value .. " (" .. shown_integer(decoded) .. ")"
    end
    local name = decoded.name_of_number and " (" .. decoded.name_of_number .. ")" or ""
    if decoded.value == nil then
        return "raw " .. shown_integer(decoded) .. name
    end
    local text = type_.plain and shown_integer(decoded) or shown_number(decoded.value)
    return (type_.unit and text .. " " .. type_.unit or text) .. name
end

local function label_of(decoded)
    return decoded.index and string.format("%s[%d]", decoded.field.label, decoded.index) or decoded.field.label
end

local function add_field(tree, tvb, decoded)
    local known = proto_fields[decoded.field.name]
    local range = range_of(tvb, decoded.segments)
    local text = label_of(decoded) .. ": " .. shown_value(decoded)
    local item
    if known.kind == "string" then
        item = add(tree, known.value, range, shown_value(decoded))
    elseif decoded.raws then
        item = decoded.value and add(tree, known.value, range, decoded.value) or tree:add(range or tvb, text)
    elseif known.kind ~= "double" then
        item = add(tree, known.value, range, integer(known.kind, decoded))
    else
        local number = decoded.value
        if decoded.field.type.enum or decoded.field.type.flags then
            number = decoded.number
        end
        if number then
            item = add(tree, known.value, range, number)
        end
        local raw = add(item or tree, known.raw, range, integer(known.raw_kind, decoded))
        raw:set_text(label_of(decoded) .. " (raw): " .. shown_integer(decoded))
        item = item or raw
    end
    item:set_text(text)
    for _, flag in ipairs(decoded.field.type.flags or {}) do
        local is_set = codec.has_flag(decoded, flag.bit)
        add(item, known.flags[flag.name], range, is_set):set_text(flag.label .. ": " .. (is_set and "1" or "0"))
    end
end

local function add_exchange(tree, result)
    if result.request then
        tree:add(meta.request_in, result.request):set_generated()
        if result.latency then
            local seconds = math.floor(result.latency / 1000000000)
            tree:add(meta.latency, NSTime.new(seconds, math.floor(result.latency - seconds * 1000000000))):set_generated()
        end
    end
    for _, number in ipairs(result) do
        tree:add(meta.reply_in, number):set_generated()
    end
end

-- Adds the checksum of a frame and whether it is correct.
local function add_checksum(tree, tvb, message, frame)
    local field, found, computed = codec.checksum(message, frame)
    if field then
        local known, hex = proto_fields[field.name], "0x%0" .. math.ceil(field.type.width / 4) .. "X"
        local shared, kind = known.value, known.kind
        if kind == "double" then
            shared, kind = known.raw, known.raw_kind
        end
        local raw = integer(kind, { low = found, high = 0, number = found })
        local item = add(tree, shared, range_of(tvb, field.elements[1]), raw)
        local validity = found == computed and "correct" or "incorrect, should be " .. hex:format(computed)
        item:set_text(string.format("%s: %s [%s]", field.label, hex:format(found), validity))
    end
end

-- Adds what a frame means.
local function add_frame(tree, tvb, known, result, fields)
    local message = result.message
    tree:add(meta.edition, known.edition.name):set_generated()
    tree:add(meta.direction, result.direction):set_generated()
    tree:add(meta.rule, result.rule):set_generated()
    if message then
        tree:add(meta.command, message.command):set_generated()
        if message.sending then
            tree:add(meta.sending, message.sending):set_generated()
        end
    end
    if result.node then
        tree:add(meta.node, result.node):set_generated()
    end
    add_exchange(tree, result)
    for _, decoded in ipairs(fields) do
        add_field(tree, tvb, decoded)
    end
end

-- What a frame is. In the first pass, the reply that confirms a request is still to come.
local function title_of(result, is_visited)
    local message = result.message
    local text = message and message.command .. " " .. message.direction or result.direction
    if result.rule == "assumed" and (result.direction == "reply" or is_visited) then
        text = text .. " (assumed)"
    end
    return result.node and string.format("%s, node %d", text, result.node) or text
end

-- Whether a packet is the first one with a note.
local function is_first(note, number)
    noted[note] = noted[note] or number
    return noted[note] == number
end

local function lacks_parameter(fields, reason)
    if reason == "missing_parameter" then
        return true
    end
    for _, decoded in ipairs(fields) do
        if decoded.reason == "missing_parameter" then
            return true
        end
    end
    return false
end

local NONE = {}

-- The remarks with one more: an expert item and a text.
local function with_remark(remarks, ...)
    remarks = #remarks > 0 and remarks or {}
    remarks[#remarks + 1] = { ... }
    return remarks
end

-- The remarks about a frame.
local function remarks_of(result, fields, reason, pinfo, frame)
    local lacking, remarks = lacks_parameter(fields, reason), NONE
    if reason and not lacking then
        remarks = with_remark(remarks, experts.rejected, reason)
    end
    if lacking and is_first("parameter", frame.number) then
        remarks = with_remark(remarks, experts.parameter)
    end
    if settings.mistake and is_first("mistake", frame.number) then
        remarks = with_remark(remarks, experts.preference, settings.mistake)
    end
    if result.expects_reply and pinfo.visited and is_complete and #result < math.max(1, #result.message.answer.nodes) then
        remarks = with_remark(remarks, experts.no_reply)
    end
    return remarks
end

-- The fields of a frame, and why it is rejected: the reason, and a text.
local function decoded_fields(frame, result)
    if not result.message then
        return {}, result.reason, result.reason
    end
    local fields, reason, parameter = codec.decode(result.message, frame, settings_of(result.node).parameters)
    return fields or {}, reason, parameter and reason .. ": " .. parameter or reason
end

local function result_of(frame, occurrence, pinfo, known)
    local of_occurrence = results[occurrence]
    if not of_occurrence then
        of_occurrence = {}
        results[occurrence] = of_occurrence
    end
    local result = of_occurrence[frame.number]
    if not result then
        is_complete = is_complete and not pinfo.visited
        local source = interface()
        result = directions.judge(state, source and source.value or 0, known.edition, known.only, frame)
        of_occurrence[frame.number] = result
    end
    return result
end

local function hint(tvb, tree, frame)
    for _, edition in ipairs(family.editions) do
        if #codec.nodes(edition, frame) > 0 then
            tree:add(proto, tvb()):set_text(
                family.name .. ": choose the edition in Edit, Preferences, Protocols, " .. string.upper(prefix)
            )
            return
        end
    end
end

-- What a frame is and its values, in one line.
local function info_of(title, fields, rejection)
    if rejection then
        return title .. ": rejected: " .. rejection
    elseif #fields == 0 then
        return title
    end
    local texts = {}
    for number, decoded in ipairs(fields) do
        texts[number] = decoded.name .. " " .. shown_value(decoded)
    end
    return title .. ": " .. table.concat(texts, ", ")
end

-- Adds a frame to the columns, and to the tree if anybody looks at it or there is a remark; whether it is one of the family.
local function dissect(tvb, pinfo, tree)
    if settings.is_asleep and not tree.visible then
        return false
    end
    local id, occurrence = last(can_id())
    if not id then
        return false
    end
    local is_extended_id, is_remote_frame = last(is_extended()) == true, last(is_remote()) == true
    if settings.is_asleep then
        hint(tvb, tree, read_frame(tvb, pinfo, id, is_extended_id, is_remote_frame))
        return false
    end
    local known = of_id(id, is_extended_id, is_remote_frame)
    if not known then
        return false
    end
    local frame = read_frame(tvb, pinfo, id, is_extended_id, is_remote_frame)
    local result = result_of(frame, occurrence, pinfo, known)
    local fields, reason, rejection = decoded_fields(frame, result)
    local remarks, title = remarks_of(result, fields, reason, pinfo, frame), title_of(result, pinfo.visited)
    if #remarks > 0 or tree:referenced(own_dissector) then
        local branch = tree:add(proto, tvb())
        add_frame(branch, tvb, known, result, fields)
        if result.message then
            add_checksum(branch, tvb, result.message, frame)
        end
        if reason then
            branch:add(meta.rejected, reason):set_generated()
        end
        for _, remark in ipairs(remarks) do
            branch:add_proto_expert_info(table.unpack(remark))
        end
        branch:set_text(family.name .. " " .. known.edition.name .. ", " .. title)
    end
    local columns = pinfo.cols
    columns.protocol, columns.info = column, info_of(title, fields, rejection)
    return true
end

function proto.dissector(tvb, pinfo, tree)
    return dissect(tvb, pinfo, tree) and math.max(1, tvb:len()) or 0
end

-- In a terminal, the edition is not chosen later, so frames need not be offered to this dissector without one.
local is_registered = false

local function register()
    if not is_registered then
        is_registered = true
        proto:register_heuristic("can", dissect)
    end
end

if gui_enabled() then
    register()
end

local function reset()
    read_settings()
    own_dissector = Dissector.get(prefix)
    state = directions.new(prefs.window * 1000, prefs.sent == 0 and "request" or "reply", prefs.marks == 1)
    results, ids, noted, is_complete = {}, {}, {}, true
    if not settings.is_asleep then
        register()
    end
end

proto.init = reset
proto.prefs_changed = reset
