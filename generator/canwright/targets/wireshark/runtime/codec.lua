-- Identifies frames and decodes their fields, from the tables of an edition. It runs in Lua 5.2 and later, without Wireshark.
--
-- A frame is a table: [0] is the CAN id, the data bytes follow from [1] on; `length`, `extended`, `remote`.
-- A segment is {index in the frame, 2^low, 2^width, 2^raw_low, whether raw_low counts from bit 32}: some bits of one byte;
-- in the tables it is {byte, low, width, raw_low}, and the byte of the id is -1.
-- A key is an unsigned integer as a number, or as a text of its two halves if it has more than 32 bits.

local codec = {}

local TWO_32 = 4294967296

local function power(exponent)
    return math.floor(2 ^ exponent)
end

-- The segments of a table; those that cross bit 32 of the raw integer are divided there.
local function segments_of(listed)
    local segments = {}
    for _, segment in ipairs(listed) do
        local byte, low, width, raw_low = segment[1], segment[2], segment[3], segment[4]
        local lower = math.min(width, math.max(0, 32 - raw_low))
        if lower > 0 then
            segments[#segments + 1] = { byte + 1, power(low), power(lower), power(raw_low) }
        end
        if width > lower then
            local above = raw_low + lower - 32
            segments[#segments + 1] = { byte + 1, power(low + lower), power(width - lower), power(above), true }
        end
    end
    return segments
end

-- The bits of the id under a mask, not shifted.
local function id_bits(mask)
    local runs = {}
    for bit = 0, 28 do
        if math.floor(mask / 2 ^ bit) % 2 == 1 then
            local last = runs[#runs]
            if last and last[2] + last[3] == bit then
                last[3] = last[3] + 1
            else
                runs[#runs + 1] = { -1, bit, 1, bit }
            end
        end
    end
    return segments_of(runs)
end

local function set_of(listed)
    local set = {}
    for _, value in ipairs(listed) do
        set[value] = true
    end
    return set
end

local function link_rule(rule)
    rule.step = rule.step or 1
    rule.first, rule.last = rule.nodes and rule.nodes[1], rule.nodes and rule.nodes[2]
    rule.extended, rule.remote = rule.extended or false, rule.remote or false
    rule.filled = id_bits(rule.mask or 0)
end

local function link_type(type_)
    type_.signed, type_.float = type_.encoding == "signed", type_.encoding == "float"
    type_.plain = type_.linear == nil
    type_.linear = type_.plain and { identity = true } or type_.linear
    type_.scale_by = type_.linear and type_.linear.by
    if type_.scale_by then
        type_.linear = type_.linear.cases
    end
    type_.limited = type_.enum or type_.flags or type_.limits
    if type_.enum then
        local names = {}
        for _, member in ipairs(type_.enum) do
            names[member[1]] = member[2]
        end
        type_.enum = names
    end
    if type_.flags then
        type_.named = {}
        for number, flag in ipairs(type_.flags) do
            type_.flags[number] = { bit = flag[1], name = flag[2], label = flag[3] }
            type_.named[flag[1]] = true
        end
    end
end

local function link_layout(layout, types)
    layout.values = set_of(layout.values or {})
    for _, field in ipairs(layout.fields) do
        field.type = types[field.type + 1]
        field.only = field.only and set_of(field.only)
        for number, element in ipairs(field.elements) do
            field.elements[number] = segments_of(element)
        end
    end
end

local function link_message(message, layouts)
    link_rule(message)
    message.layout = layouts[message.layout + 1]
    message.keys = message.keys or {}
    for _, key in ipairs(message.keys) do
        key.segments, key.values = segments_of(key.segments), set_of(key.values)
    end
    message.node = message.node and segments_of(message.node)
    for _, bits in ipairs(message.reserved) do
        bits[1], bits[2], bits[3] = bits[1] + 1, power(bits[2]), power(bits[3])
    end
end

-- The bits of a node, with the number of nodes that they distinguish.
local function node_bits(listed)
    if not listed then
        return nil
    end
    local width = 0
    for _, segment in ipairs(listed) do
        width = width + segment[3]
    end
    return { segments = segments_of(listed), modulus = power(width) }
end

local function linked_plan(node, messages)
    if type(node) == "number" then
        return messages[node + 1]
    elseif type(node) == "string" then
        return node
    end
    local cases = {}
    for _, case in ipairs(node.cases) do
        local after = linked_plan(case[2], messages)
        for _, value in ipairs(case[1]) do
            cases[value] = after
        end
    end
    local on = node.on
    if type(on) == "table" then
        on = on.mask and id_bits(on.mask) or segments_of(on)
    end
    return { on = on, cases = cases, otherwise = linked_plan(node.otherwise, messages) }
end

-- An edition from its tables: the items themselves in place of their positions, and sets in place of lists.
function codec.edition(tables)
    local messages = tables.messages
    for _, type_ in ipairs(tables.types) do
        link_type(type_)
    end
    for _, layout in ipairs(tables.layouts) do
        link_layout(layout, tables.types)
    end
    for _, message in ipairs(messages) do
        link_message(message, tables.layouts)
        message.answer = { nodes = {}, echo = false }
    end
    for _, routes in ipairs({ tables.requests, tables.replies }) do
        for _, route in ipairs(routes) do
            link_rule(route)
            route.plan = linked_plan(route.plan, messages)
        end
    end
    for number, position in ipairs(tables.explained) do
        tables.explained[number] = messages[position + 1]
    end
    for _, answer in ipairs(tables.answers) do
        answer.reply, answer.nodes, answer.echo = messages[answer.reply + 1], answer.nodes or {}, answer.echo or false
        answer.asked, answer.reported = node_bits(answer.asked), node_bits(answer.reported)
        messages[answer.request + 1].answer = answer
    end
    return tables
end

-- The unsigned integer of some segments: the lower 32 bits and the others.
local function read(frame, segments)
    local low, high = 0, 0
    for _, segment in ipairs(segments) do
        local bits = math.floor((frame[segment[1]] or 0) / segment[2]) % segment[3] * segment[4]
        if segment[5] then
            high = high + bits
        else
            low = low + bits
        end
    end
    return low, high
end

local function read_key(frame, segments)
    local low, high = read(frame, segments)
    if high == 0 then
        return low
    end
    return string.format("%d:%d", high, low)
end

-- The raw integer of a field: a table of both halves, the key, and the nearest number, which is exact up to 53 bits.
local function raw_integer(type_, frame, segments)
    local low, high = read(frame, segments)
    local key = high == 0 and low or string.format("%d:%d", high, low)
    if type_.signed then
        if type_.width <= 32 then
            if low >= 2 ^ (type_.width - 1) then
                low, high = low + TWO_32 - math.floor(2 ^ type_.width), -1
            end
        elseif high >= 2 ^ (type_.width - 33) then
            high = high - math.floor(2 ^ (type_.width - 32))
        end
    end
    local number = type_.width <= 53 and high * TWO_32 + low or high * 4294967296.0 + low
    return { low = low, high = high, key = key, number = number }
end

-- The number of an IEEE 754 bit pattern; nil for infinity and NaN.
local function float_number(width, raw)
    local sign_bit, exponent_bits, fraction_bits, high = 2147483648, 8, 23, raw.low
    local fraction = raw.low % 2 ^ 23
    if width == 64 then
        exponent_bits, fraction_bits, high = 11, 52, raw.high
        fraction = high % 2 ^ 20 * 4294967296.0 + raw.low
    end
    local sign = high >= sign_bit and -1.0 or 1.0
    local biased = math.floor(high % sign_bit / 2 ^ (31 - exponent_bits))
    local bias = 2 ^ (exponent_bits - 1) - 1
    if biased == 2 * bias + 1 then
        return nil
    end
    if biased == 0 then
        return sign * fraction * 2 ^ (1 - bias) / 2 ^ fraction_bits
    end
    return sign * (1 + fraction / 2 ^ fraction_bits) * 2 ^ (biased - bias)
end

-- A number such as `3.5`, `-2` or `1/3` as a quotient of integers; nil for another text.
function codec.rational(text)
    local sign, whole, decimals, divisor = text:match("^%s*(-?)(%d+)%.?(%d*)/?(%d*)%s*$")
    if not whole or (divisor ~= "" and tonumber(divisor) == 0) then
        return nil
    end
    local denominator = (divisor == "" and 1 or tonumber(divisor)) * 10.0 ^ #decimals
    local numerator = tonumber(whole .. decimals) + 0.0
    return { numerator = sign == "-" and -numerator or numerator, denominator = denominator }
end

-- The value of a number. With integers up to 2^53, it is the result of one division, so it is correctly rounded.
local function scaled(type_, number, parameters)
    local linear = type_.linear
    if type_.scale_by then
        linear = linear[parameters[type_.scale_by]]
        if linear == nil then
            return nil, "missing_parameter"
        end
    end
    if not linear then
        return nil, "no_scale"
    end
    local factor, divisor = 1, linear.divisor
    if linear.times then
        local times = parameters[linear.times]
        if not times then
            return nil, "missing_parameter"
        end
        factor, divisor = times.numerator, divisor * times.denominator
    elseif linear.identity then
        return number
    end
    return (number * linear.factor + linear.addend) * factor / divisor
end

-- The value of a raw integer: a number in the unit, the name of a member, a list of names of flags; nil and a reason
-- without one.
local function value_of(type_, raw, parameters)
    if type_.enum then
        return type_.enum[raw.key]
    end
    if type_.flags then
        local names = {}
        for _, flag in ipairs(type_.flags) do
            if codec.has_flag(raw, flag.bit) then
                names[#names + 1] = flag.name
            end
        end
        return names
    end
    local number = raw.number
    if type_.float then
        number = float_number(type_.width, raw)
        if number == nil then
            return nil, "not_finite"
        end
    end
    return scaled(type_, number, parameters)
end

-- Whether a bit of a raw integer is set.
function codec.has_flag(raw, bit)
    if bit < 32 then
        return math.floor(raw.low / 2 ^ bit) % 2 == 1
    end
    return math.floor(raw.high / 2 ^ (bit - 32)) % 2 == 1
end

-- The node of an id without the bits of keys and fields; false for an id that is not of the rule, nil for a fixed id.
local function node_of_rule(rule, frame)
    if rule.extended ~= frame.extended or rule.remote ~= frame.remote then
        return false
    end
    local rest = frame[0] - read(frame, rule.filled)
    if not rule.last then
        if rest == rule.base then
            return nil
        end
        return false
    end
    local node = (rest - rule.base) / rule.step
    if node == math.floor(node) and node >= rule.first and node <= rule.last then
        return math.floor(node)
    end
    return false
end

-- The node of a frame of a message: that in its id, or else in its data; nil without one.
local function node_of(message, frame, in_id)
    if message.node then
        return (read(frame, message.node))
    end
    return in_id
end

-- The message of a frame of one direction ("requests" or "replies") and its node; nil and the reason without one.
function codec.identify(edition, direction, frame)
    for _, route in ipairs(edition[direction]) do
        local node = node_of_rule(route, frame)
        if node ~= false then
            local step = route.plan
            while type(step) == "table" and step.on do
                local subject = frame.length
                if step.on ~= "length" then
                    subject = read_key(frame, step.on)
                end
                step = step.cases[subject] or step.otherwise
            end
            if type(step) == "string" then
                return nil, step
            end
            return step, node_of(step, frame, node)
        end
    end
    return nil, "unknown_id"
end

-- The nodes that the id of a frame can mean, and whether requests and replies have the id. A node that is not in the id
-- is `false`.
function codec.nodes(edition, frame)
    local nodes, is_request, is_reply = {}, false, false
    for _, message in ipairs(edition.messages) do
        local node = node_of_rule(message, frame)
        if node ~= false then
            nodes[#nodes + 1] = node or false
            is_request = is_request or message.direction == "request"
            is_reply = is_reply or message.direction == "reply"
        end
    end
    return nodes, is_request, is_reply
end

-- Whether a frame has the id, the length and the keys of a message, and its node.
function codec.is_message(message, frame)
    local node = node_of_rule(message, frame)
    if node == false or (frame.length ~= message.length and not frame.remote) then
        return false
    end
    for _, key in ipairs(message.keys) do
        if not key.values[read_key(frame, key.segments)] then
            return false
        end
    end
    return true, node_of(message, frame, node)
end

local function is_present(field, choice)
    return not field.only or (choice ~= nil and field.only[choice])
end

-- Whether a frame has the constants of a message, under the value of the parameter on which its fields depend.
function codec.has_constants(message, frame, choice)
    for _, field in ipairs(message.layout.fields) do
        if field.constant and is_present(field, choice) then
            for _, element in ipairs(field.elements) do
                if read_key(frame, element) ~= field.fixed then
                    return false
                end
            end
        end
    end
    return true
end

-- The reserved bits of a frame as a text, and whether they are as the spec demands.
function codec.reserved_bits(message, frame)
    local values, is_regular = {}, true
    for number, bits in ipairs(message.reserved) do
        local value = math.floor((frame[bits[1]] or 0) / bits[2]) % bits[3]
        values[number] = value
        is_regular = is_regular and value == bits[4]
    end
    return table.concat(values, " "), is_regular
end

-- Whether the fields of a frame of this message have named values, and values in their ranges.
function codec.is_in_range(message, frame)
    for _, field in ipairs(message.layout.fields) do
        local type_ = field.type
        if type_.limited and not field.only and not field.fixed then
            for _, element in ipairs(field.elements) do
                local raw = raw_integer(type_, frame, element)
                local number = raw.number
                if type_.float then
                    number = float_number(type_.width, raw)
                end
                if type_.enum and not type_.enum[raw.key] then
                    return false
                elseif type_.limits and (number == nil or number < type_.limits[1] or number > type_.limits[2]) then
                    return false
                elseif type_.flags then
                    for bit = 0, type_.width - 1 do
                        if codec.has_flag(raw, bit) and not type_.named[bit] then
                            return false
                        end
                    end
                end
            end
        end
    end
    return true
end

-- The fields of a frame of a message under some parameters: a list of tables with `field`, `segments`, `index` of an
-- element of an array, `raw`, `value`, and the `reason` without a value. nil and the reason if the frame is rejected.
function codec.decode(message, frame, parameters)
    local layout = message.layout
    local choice = layout.parameter and parameters[layout.parameter]
    local is_known = not layout.parameter or (choice ~= nil and layout.values[choice])
    if not codec.has_constants(message, frame, is_known and choice or nil) then
        return nil, "wrong_constant"
    end
    if not is_known then
        return nil, "missing_parameter", layout.parameter
    end
    local decoded = {}
    for _, field in ipairs(layout.fields) do
        if not field.fixed and is_present(field, choice) then
            for index, segments in ipairs(field.elements) do
                local raw = raw_integer(field.type, frame, segments)
                local value, reason = value_of(field.type, raw, parameters)
                decoded[#decoded + 1] = {
                    field = field,
                    segments = segments,
                    index = field.indices and field.indices[index],
                    raw = raw,
                    value = value,
                    reason = reason,
                }
            end
        end
    end
    return decoded
end

local function is_from(nodes, source, modulus)
    if source == nil or #nodes == 0 then
        return true
    end
    for _, node in ipairs(nodes) do
        if node == source or (modulus and node % modulus == source % modulus) then
            return true
        end
    end
    return false
end

-- Whether a frame is the reply to a request, and the node that replies.
function codec.answers(request, request_node, request_frame, frame)
    local answer = request.answer
    local reply = answer.reply
    if not reply then
        return false
    end
    local fits, source = codec.is_message(reply, frame)
    if not fits then
        return false
    end
    local to, modulus = request_node, nil
    if answer.asked then
        to, modulus = read(request_frame, answer.asked.segments), answer.asked.modulus
    end
    local nodes = answer.nodes
    if #nodes == 0 and to ~= nil then
        nodes = { to }
    end
    if not is_from(nodes, source, modulus) then
        return false
    end
    if answer.reported then
        local shared = answer.reported.modulus
        if modulus and modulus < shared then
            shared = modulus
        end
        if not is_from(nodes, (read(frame, answer.reported.segments)), shared) then
            return false
        end
    end
    if answer.echo then
        if request_frame.length ~= frame.length then
            return false
        end
        for index = 1, frame.length do
            if request_frame[index] ~= frame[index] then
                return false
            end
        end
    end
    return true, source
end

return codec
